"""Action modes and their reference."""

from __future__ import annotations

import robocell
from robocell.envs import RelativeTo

__all__ = ["ControlMode", "RelativeTo"]


class ControlMode:
    """robocell's control modes; one of them is written in another way."""

    JOINTS = robocell.envs.ControlMode.JOINTS
    CARTESIAN_TRPY = robocell.envs.ControlMode.CARTESIAN_TRPY
    CARTESIAN_TQuat = robocell.envs.ControlMode.CARTESIAN_TQUAT
