"""What is printed where PyKDL is missing: a command for this system, which names real places."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from robocell import _pykdl

HERE = f"{sys.version_info.major}.{sys.version_info.minor}"


@pytest.fixture
def no_system_module(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A system without the package, with apt and a Python of this version."""
    monkeypatch.setattr(_pykdl, "SYSTEM_MODULES", tmp_path)
    monkeypatch.setattr(_pykdl.shutil, "which", lambda command: f"/usr/bin/{command}")
    monkeypatch.setattr(_pykdl, "system_version", lambda: HERE)
    return tmp_path


def test_a_module_that_the_system_has_is_linked(no_system_module: Path):
    file = _pykdl.module_file()
    file.touch()
    site = sysconfig.get_path("platlib")
    assert _pykdl.remedy().endswith(f": ln -s {file} {site}/")


def test_a_missing_package_is_installed_or_unpacked_without_root(no_system_module: Path):
    text = _pykdl.remedy()
    assert "sudo apt-get install python3-pykdl" in text
    assert "Without root: cd /tmp && apt-get download python3-pykdl && dpkg-deb -x " in text


def test_without_root_the_library_comes_along_where_the_system_has_none(
    no_system_module: Path, monkeypatch
):
    libraries = no_system_module / "lib"
    monkeypatch.setattr(_pykdl, "SYSTEM_LIBRARIES", libraries)
    alone = _pykdl.remedy()
    assert "apt-get download python3-pykdl liborocos-kdl1.5 && dpkg-deb -x " in alone
    assert "pykdl.pth" in alone
    (libraries / "x86_64-linux-gnu").mkdir(parents=True)
    (libraries / "x86_64-linux-gnu" / "liborocos-kdl.so.1.5").touch()
    assert "liborocos" not in _pykdl.remedy()
    assert "pykdl.pth" not in _pykdl.remedy()


def test_the_remedy_names_the_python_version_of_the_package(no_system_module, monkeypatch):
    monkeypatch.setattr(_pykdl, "system_version", lambda: "3.9")
    assert _pykdl.remedy() == (
        f"The package python3-pykdl is for the system's Python 3.9, and this is Python {HERE}. "
        "Create the environment with /usr/bin/python3 -m venv and install robocell there"
    )


def test_other_systems_build_pykdl_from_source(no_system_module, monkeypatch):
    monkeypatch.setattr(_pykdl.shutil, "which", lambda command: None)
    assert sysconfig.get_path("platlib") in _pykdl.remedy()
    assert "orocos_kinematics_dynamics" in _pykdl.remedy()


def test_the_link_makes_it_importable_in_a_clean_environment(tmp_path: Path):
    if not _pykdl.module_file().exists() or _pykdl.system_version() != HERE:
        pytest.skip("the system has no PyKDL for this Python")
    venv = tmp_path / "venv"
    make = [_pykdl.SYSTEM_PYTHON, "-m", "venv", "--without-pip", venv]
    subprocess.run(make, check=True)
    python = venv / "bin" / "python"
    env = {**os.environ, "PYTHONPATH": str(Path(_pykdl.__file__).parent)}
    asked = [python, "-c", "import _pykdl; print(_pykdl.remedy())"]
    text = subprocess.run(asked, env=env, check=True, capture_output=True, text=True).stdout
    alone = [python, "-c", "import PyKDL; PyKDL.Frame()"]
    assert subprocess.run(alone, capture_output=True, check=False).returncode
    command = text.strip().rpartition(": ")[2]
    assert command.startswith(f"ln -s {_pykdl.module_file()} {venv}")
    subprocess.run(command, shell=True, check=True)
    subprocess.run(alone, check=True)
