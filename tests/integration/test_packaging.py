"""A C++ user's find_package(robocell) works from an install and from the build folder."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

import robocell

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "release"
CONSUMER = Path(__file__).parent / "consumer"


def run(*command: object) -> str:
    words = [str(word) for word in command]
    env = {**os.environ, "CMAKE_BUILD_PARALLEL_LEVEL": "2"}
    result = subprocess.run(words, capture_output=True, text=True, env=env, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def build_consumer(package: Path, folder: Path) -> list[str]:
    """Configure, build and run the consumer; what it printed, in words."""
    run("cmake", "-G", "Ninja", "-S", CONSUMER, "-B", folder, f"-Drobocell_DIR={package}")
    run("cmake", "--build", folder)
    return run(folder / "consumer").split()


@pytest.fixture(scope="module")
def build_folder() -> Path:
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")
    return BUILD


def test_a_user_builds_against_an_install(build_folder, tmp_path):
    prefix = tmp_path / "prefix"
    run("cmake", "--install", build_folder, "--prefix", prefix)
    version, models, rest = build_consumer(prefix / "lib/cmake/robocell", tmp_path / "build")
    assert version == "0.1.0"
    assert Path(models) == prefix / "share/robocell/models"
    assert float(rest) == pytest.approx(0, abs=1e-15)
    assert not (prefix / "include/robocell/testing").exists()


def test_a_user_builds_against_the_build_folder(build_folder, tmp_path):
    version, models, _ = build_consumer(build_folder, tmp_path / "build")
    assert (version, Path(models)) == ("0.1.0", ROOT / "models")


def test_python_knows_where_the_cmake_files_are(build_folder):

    assert Path(robocell.cmake_dir()) == build_folder
