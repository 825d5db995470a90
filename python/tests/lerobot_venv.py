"""An environment with LeRobot itself, gigabytes of it, which soak tests share."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from made_once import made_once

PACKAGES = ["lerobot==0.4.4", "mujoco==4.0.0", "mujoco-menagerie"]


def lerobot_python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of the environment."""

    def make(folder: Path) -> None:
        subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
        install = [folder / "venv/bin/python", "-m", "pip", "install", "-q", *PACKAGES]
        subprocess.run(install, check=True)

    return made_once(tmp_path_factory, "lerobot", make) / "venv" / "bin" / "python"
