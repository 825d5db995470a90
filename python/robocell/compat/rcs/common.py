"""Pose, which takes quaternions as they are written: with a few digits."""

from __future__ import annotations

from typing import Any

import numpy as np

import robocell


class Pose(robocell.Pose):
    """robocell's Pose; quaternions (xyzw) are normalised, where robocell refuses them."""

    def __init__(self, *args: Any, quaternion: Any = None, **kwargs: Any) -> None:
        """Arguments of `rc.Pose`: translation, quaternion, rpy, ..."""
        if quaternion is not None:
            numbers = np.asarray(quaternion, dtype=float)
            length = float(np.linalg.norm(numbers))
            # robocell refuses numbers without a direction, or that were never meant as a rotation.
            kwargs["quaternion"] = numbers / length if abs(length - 1) < 1e-2 else numbers
        super().__init__(*args, **kwargs)
