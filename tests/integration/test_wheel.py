"""The wheel: built, unpacked, imported, and built against. Minutes long: part of `make soak`."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import mujoco
import pytest
from test_packaging import ROOT, build_consumer

pytestmark = pytest.mark.soak


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site-packages folder with the wheel, and with MuJoCo beside it as a real one has."""
    out = tmp_path_factory.mktemp("wheel")
    options = ["--no-build-isolation", "--no-deps", "--wheel-dir", str(out)]
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", *options, str(ROOT)]
    subprocess.run(pip, check=True)
    site = out / "site-packages"
    with zipfile.ZipFile(next(out.glob("robocell-*.whl"))) as wheel:
        wheel.extractall(site)
    (site / "mujoco").symlink_to(Path(mujoco.__file__).parent)
    return site


def python(site: Path, code: str) -> str:
    env = {**os.environ, "PYTHONPATH": str(site)}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=env, cwd=site, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_the_package_imports_from_the_wheel_and_finds_its_models(site: Path):
    printed = python(site, "import robocell; print(robocell.__file__); print(robocell.__version__)")
    file, version = printed.splitlines()
    assert Path(file).parent == site / "robocell"
    assert version == "0.1.0"
    assert (site / "robocell/models/robots/rc7/rc7.yaml").exists()
    load = "import robocell as rc; print([*rc.EnvConfig.load(rc.models.cell_file('xarm7')).robots])"
    assert python(site, load) == "['robot']"


def test_stubs_types_and_library_are_there_once(site: Path):
    names = {path.name for path in (site / "robocell").iterdir()}
    assert {"py.typed", "librobocell.so.0.1.0"} <= names
    assert "librobocell.so" not in names
    assert "_core.pyi" in names or "_core" in names


def test_a_c_plus_plus_user_builds_against_the_wheel(site: Path, tmp_path: Path):
    folder = Path(python(site, "import robocell; print(robocell.cmake_dir())"))
    version, models, _ = build_consumer(folder, tmp_path / "build")
    assert (version, Path(models)) == ("0.1.0", site / "robocell" / "models")
