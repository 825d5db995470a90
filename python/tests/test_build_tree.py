"""A checkout's package finds the extension in its build folder; a missing one names the command."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import robocell
from robocell import _build_tree, _core

PACKAGE = Path(robocell.__file__).parent
ROOT = PACKAGE.parents[1]
BUILD = Path(_core.__file__).parents[2]


def run(path: Path, code: str, build: str = "") -> subprocess.CompletedProcess[str]:
    env = {**os.environ, "PYTHONPATH": str(path), _build_tree.VARIABLE: build}
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=env, cwd="/", capture_output=True, text=True, check=False)


@pytest.fixture
def other_checkout(tmp_path: Path) -> Path:
    """A checkout with the sources of the package that is not built."""
    root = tmp_path / "checkout"
    shutil.copytree(PACKAGE, root / "python" / "robocell")
    (root / "python" / "bindings").mkdir()
    (root / "CMakeLists.txt").touch()
    return root


CORE = "import robocell; print(robocell._core.__file__); print(robocell.cmake_dir())"


def test_the_extension_and_its_stubs_are_in_the_build_folder():
    assert _build_tree.checkout() == ROOT
    assert _build_tree.build_folder() == BUILD
    assert BUILD.is_relative_to(ROOT / "build")
    assert (BUILD / "python/robocell/_core.pyi").exists() or (
        BUILD / "python/robocell/_core/__init__.pyi"
    ).exists()
    assert Path(robocell.cmake_dir()) == BUILD


def test_the_variable_names_another_build_folder(other_checkout):
    core, cmake = run(other_checkout / "python", CORE, build=str(BUILD)).stdout.split()
    assert (core, cmake) == (_core.__file__, str(BUILD))


def test_a_relative_build_folder_is_resolved_against_the_checkout(other_checkout):
    (other_checkout / "build").mkdir()
    (other_checkout / "build/tsan").symlink_to(BUILD)
    core, cmake = run(other_checkout / "python", CORE, build="build/tsan").stdout.split()
    assert Path(core).parents[2] == other_checkout / "build/tsan"
    assert cmake == str(other_checkout / "build/tsan")


def test_importing_an_unbuilt_checkout_explains_the_error(other_checkout):
    done = run(other_checkout / "python", "import robocell")
    assert done.returncode == 1
    assert (
        f"ImportError: robocell's extension _core is not in {other_checkout}/build/release/python/"
        "robocell. Build it with `make`, or set ROBOCELL_BUILD to another build folder."
    ) in done.stderr


def test_an_install_for_another_python_explains_the_error(tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "robocell")
    done = run(tmp_path, "import robocell", build=str(BUILD))
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert (
        f"robocell's extension _core for Python {version} is not in {tmp_path}/robocell. "
        "Install robocell again with this Python: pip install --force-reinstall robocell"
    ) in done.stderr


def test_an_extension_left_among_the_sources_is_not_used(other_checkout):
    name = Path(_core.__file__).name
    (other_checkout / "python/robocell" / name).write_bytes(b"old")
    core, _ = run(other_checkout / "python", CORE, build=str(BUILD)).stdout.split()
    assert core == _core.__file__
