"""Pose, which takes quaternions as they are written: with a few digits."""

from __future__ import annotations

from typing import Any

import numpy as np

import robocell

__all__ = [
    "Pose",
]


class Pose(robocell.Pose):
    """robocell's Pose; quaternions (xyzw) are normalised, where robocell refuses them."""

    def __init__(self, *args: Any, quaternion: Any = None, **kwargs: Any) -> None:
        """Arguments of `rc.Pose`: translation, quaternion, rpy, ..."""
        if quaternion is not None:
            kwargs["quaternion"] = _normalised(quaternion)
        super().__init__(*args, **kwargs)


def _normalised(quaternion: Any) -> Any:
    """Returns it with length 1, or as it is when robocell is to refuse it."""
    try:
        numbers = np.asarray(quaternion, dtype=float)
    except (TypeError, ValueError):
        return quaternion
    length = float(np.linalg.norm(numbers))
    return numbers / length if abs(length - 1) < 1e-2 else numbers
