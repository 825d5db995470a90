"""find_package(robocell) works from an install, the layout of the wheel and the build folder."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import mujoco
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


@pytest.mark.proof
def test_a_user_builds_against_an_install(build_folder, tmp_path):
    prefix = tmp_path / "prefix"
    run("cmake", "--install", build_folder, "--prefix", prefix)
    version, models, rest = build_consumer(prefix / "lib/cmake/robocell", tmp_path / "build")
    assert version == "0.1.0"
    assert Path(models) == prefix / "share/robocell/models"
    assert (Path(models) / "equipment/cabinet/cabinet.xml").exists()
    cells = Path(models).parent / "examples" / "envs"
    for cell in (ROOT / "examples" / "envs").glob("*.yaml"):
        robocell.EnvConfig.load(cells / cell.name)  # with all that it names
    assert float(rest) == pytest.approx(0, abs=1e-15)
    assert not (prefix / "include/robocell/testing").exists()


INCLUDE = re.compile(r'^#include "(robocell/[^"]+)"', re.MULTILINE)


def test_public_headers_are_installed_with_their_includes(build_folder, tmp_path):
    run("cmake", "--install", build_folder, "--prefix", tmp_path)
    include = tmp_path / "include"
    installed = {file.relative_to(include).as_posix() for file in include.rglob("*.h")}
    assert {"robocell/robocell.h", "robocell/kinematics/kdl_bridge.h"} <= installed
    for header in sorted(installed):
        text = (include / header).read_text()
        assert not re.search(r"^namespace robocell::internal\b", text, re.MULTILINE), header
        missing = set(INCLUDE.findall(text)) - installed
        assert not missing, (header, missing)
    private = {"kinematics/lane_kernel.h", "scene/pool.h", "data/hdf5.h", "render/soft_renderer.h"}
    assert not {f"robocell/{name}" for name in private} & installed
    # Headers that no public header needs are not installed.
    reached, waiting = set(), ["robocell/robocell.h", "robocell/kinematics/kdl_bridge.h"]
    while waiting:
        header = waiting.pop()
        if header not in reached:
            reached.add(header)
            waiting += INCLUDE.findall((include / header).read_text())
    assert installed == reached


def test_the_library_exports_the_namespace_robocell_without_internals(build_folder):
    symbols = run("nm", "-D", "--defined-only", build_folder / "librobocell.so").splitlines()
    names = [line.split()[-1] for line in symbols]
    assert len(names) > 1000
    ours = re.compile(r"_Z(T[ISVTWHC]|Th[^_]*_|T[vc].*_|GV?Z?|Z|GR)?N[KOR]*8robocell(?!8internal)")
    assert [name for name in names if not ours.match(name)] == []
    hidden = run("nm", "-C", "--defined-only", build_folder / "librobocell.so")
    assert " t robocell::internal::SolveLanes" in hidden  # it is there, for the library alone


@pytest.mark.proof
def test_a_user_builds_against_the_build_folder(build_folder, tmp_path):
    version, models, _ = build_consumer(build_folder, tmp_path / "build")
    assert (version, Path(models)) == ("0.1.0", ROOT / "models")


# The wheel itself takes pip and a network (test_wheel.py, `make check-wheel`). Here its files are
# put where it has them, around the library that is built already.
@pytest.mark.proof
def test_a_user_builds_against_the_layout_of_the_wheel(build_folder, tmp_path):
    layout, package = tmp_path / "layout", tmp_path / "site-packages" / "robocell"
    off = [f"-DROBOCELL_{part}=OFF" for part in ("TESTS", "EXAMPLES", "PYTHON")]
    options = [
        "-DSKBUILD=ON",
        "-DCMAKE_BUILD_TYPE=Release",
        f"-DPython_EXECUTABLE={sys.executable}",
    ]
    run("cmake", "-G", "Ninja", "-S", ROOT, "-B", layout, *options, *off)
    for built in (
        "librobocell.so.0.1.0",
        "robocell_warm_start.so",
        "robocell_drawing_service",
    ):
        shutil.copy(build_folder / built, layout)
    run("cmake", "--install", layout, "--prefix", package)
    (package.parent / "mujoco").symlink_to(Path(mujoco.__file__).parent)
    version, models, _ = build_consumer(package / "lib/cmake/robocell", tmp_path / "build")
    assert (version, Path(models)) == ("0.1.0", package / "models")
    assert not (package / "librobocell.so").exists()  # a wheel knows no links


def test_python_knows_where_the_cmake_files_are(build_folder):
    assert Path(robocell.cmake_dir()) == build_folder
