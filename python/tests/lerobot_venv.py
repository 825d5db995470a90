"""An environment with LeRobot itself, gigabytes of it, which soak tests share."""

from __future__ import annotations

from pathlib import Path

from reader_venvs import reader_python

PACKAGES = ["lerobot==0.4.4", "mujoco==4.0.0", "mujoco-menagerie"]


def lerobot_python() -> Path:
    """The interpreter of the environment."""
    return reader_python("lerobot", PACKAGES)
