"""Where the build and C++ users' projects find MuJoCo: cmake/RobocellMujoco.cmake."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

MODULE = Path(__file__).resolve().parents[2] / "cmake" / "RobocellMujoco.cmake"
PACKAGE = Path(mujoco.__file__).parent
LIBRARY = f"libmujoco.so.{mujoco.__version__}"

PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(finds LANGUAGES NONE)
{before}
include("{module}")
robocell_find_mujoco({version} {places})
message(STATUS "dir=[${{MUJOCO_DIR}}] problem=[${{MUJOCO_PROBLEM}}]")
if(TARGET mujoco::mujoco)
  get_target_property(include mujoco::mujoco INTERFACE_INCLUDE_DIRECTORIES)
  message(STATUS "include=[${{include}}]")
endif()
"""

# A package as MuJoCo's install has it, for find_package.
CONFIG = """
add_library(mujoco::mujoco SHARED IMPORTED)
set_target_properties(mujoco::mujoco PROPERTIES IMPORTED_CONFIGURATIONS RELEASE
  IMPORTED_LOCATION_RELEASE "{library}" INTERFACE_INCLUDE_DIRECTORIES "{include}")
"""
CONFIG_VERSION = """
set(PACKAGE_VERSION {version})
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
  set(PACKAGE_VERSION_EXACT TRUE)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
"""


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    """MuJoCo as its release archive is laid out: include and lib."""
    root = tmp_path / "mujoco-archive"
    (root / "lib").mkdir(parents=True)
    (root / "lib" / LIBRARY).symlink_to(PACKAGE / LIBRARY)
    (root / "include").symlink_to(PACKAGE / "include")
    return root


def installed(tmp_path: Path, version: str = mujoco.__version__) -> Path:
    """A prefix whose find_package(mujoco) has that version."""
    prefix = tmp_path / f"prefix-{version}"
    folder = prefix / "lib" / "cmake" / "mujoco"
    folder.mkdir(parents=True)
    library = prefix / "lib" / LIBRARY
    library.symlink_to(PACKAGE / LIBRARY)
    text = CONFIG.format(library=library, include=PACKAGE / "include")
    (folder / "mujocoConfig.cmake").write_text(text)
    (folder / "mujocoConfigVersion.cmake").write_text(CONFIG_VERSION.format(version=version))
    return prefix


def find(
    tmp_path: Path,
    *options: str,
    before: str = "",
    places: str = "",
    version: str = mujoco.__version__,
    env: dict[str, str] | None = None,
    python: str = sys.executable,
) -> str:
    """Configures a project that looks for MuJoCo; what it says."""
    source = tmp_path / "source"
    source.mkdir(exist_ok=True)
    text = PROJECT.format(before=before, module=MODULE, version=version, places=places)
    (source / "CMakeLists.txt").write_text(text)
    if python:
        options = (f"-DPython_EXECUTABLE={python}", *options)
    command = ["cmake", "-S", str(source), "-B", str(tmp_path / "build"), *options]
    environment = {name: value for name, value in os.environ.items() if name != "MUJOCO_ROOT"}
    environment |= env or {}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_python_package_is_the_last_resort(tmp_path):
    said = find(tmp_path)
    assert f"dir=[{PACKAGE}] problem=[]" in said
    assert f"include=[{PACKAGE}/include]" in said


def test_without_a_project_python_the_first_on_the_path_is_used(tmp_path):
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    assert f"dir=[{PACKAGE}]" in find(tmp_path, env={"PATH": path}, python="")


def test_an_install_takes_precedence_over_the_python_package(tmp_path):
    prefix = installed(tmp_path)
    said = find(tmp_path, f"-DCMAKE_PREFIX_PATH={prefix}")
    assert f"dir=[{prefix}/lib] problem=[]" in said


def test_an_install_of_another_version_is_skipped(tmp_path):
    prefix = installed(tmp_path, version="3.2.0")
    said = find(tmp_path, f"-DCMAKE_PREFIX_PATH={prefix}", python="/nowhere/python")
    assert "dir=[]" in said
    assert f"MuJoCo {mujoco.__version__} not found" in said


def test_mujoco_root_takes_precedence(tmp_path, archive):
    prefix = installed(tmp_path)
    said = find(
        tmp_path,
        f"-DMUJOCO_ROOT={archive}",
        f"-DCMAKE_PREFIX_PATH={prefix}",
        places=str(PACKAGE),
    )
    assert f"dir=[{archive}/lib] problem=[]" in said
    assert f"include=[{archive}/include]" in said


def test_mujoco_root_can_be_an_environment_variable_or_the_package_folder(tmp_path, archive):
    said = find(tmp_path, env={"MUJOCO_ROOT": str(archive)})
    assert f"dir=[{archive}/lib]" in said
    other = tmp_path / "other"
    other.mkdir()
    assert f"dir=[{PACKAGE}]" in find(other, f"-DMUJOCO_ROOT={PACKAGE}")


def test_a_wrong_mujoco_root_is_an_error_without_fallback(tmp_path):
    said = find(tmp_path, f"-DMUJOCO_ROOT={tmp_path}")
    assert "dir=[]" in said
    assert f"MUJOCO_ROOT is {tmp_path}, which holds no MuJoCo {mujoco.__version__}" in said
    assert "unset MUJOCO_ROOT" in said


def test_places_of_the_caller_take_precedence_over_find_package(tmp_path, archive):
    prefix = installed(tmp_path)
    said = find(tmp_path, f"-DCMAKE_PREFIX_PATH={prefix}", places=f"/nowhere {archive}")
    assert f"dir=[{archive}/lib]" in said


def test_an_existing_target_is_used_unchanged(tmp_path, archive):
    own = (
        "add_library(mujoco::mujoco SHARED IMPORTED)\n"
        "set_target_properties(mujoco::mujoco PROPERTIES IMPORTED_LOCATION /own/libmujoco.so"
        " INTERFACE_INCLUDE_DIRECTORIES /own/include)"
    )
    said = find(tmp_path, f"-DMUJOCO_ROOT={archive}", before=own)
    assert "dir=[/own] problem=[]" in said
    assert "include=[/own/include]" in said


def test_a_missing_mujoco_error_lists_the_searched_places_and_the_fix(tmp_path):
    said = find(tmp_path, version="9.9.9", places="/nowhere")
    assert "MuJoCo 9.9.9 not found" in said
    assert f"/nowhere, find_package(mujoco), {PACKAGE}" in said
    assert "Set MUJOCO_ROOT to its folder" in said
    assert "pip install mujoco==9.9.9" in said
