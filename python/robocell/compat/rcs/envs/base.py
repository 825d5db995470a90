"""Action modes and their reference."""

from __future__ import annotations

import robocell
from robocell import RelativeTo

__all__ = ["ControlMode", "RelativeTo"]


class ControlMode:
    """robocell's control modes; one of them is written in another way."""

    JOINTS = robocell.ControlMode.JOINTS
    CARTESIAN_TRPY = robocell.ControlMode.CARTESIAN_TRPY
    CARTESIAN_TQuat = robocell.ControlMode.CARTESIAN_TQUAT
