"""Poses of bodies and sites in a `mujoco.MjData`."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = ["body_pose", "site_pose"]


def body_pose(data: mujoco.MjData, body_id: int) -> NDArray[np.float64]:
    """Returns the pose (4, 4) of a body's frame in the world."""
    return _pose(data.xpos[body_id], data.xmat[body_id])


def site_pose(data: mujoco.MjData, site_id: int) -> NDArray[np.float64]:
    """Returns the pose (4, 4) of a site in the world."""
    return _pose(data.site_xpos[site_id], data.site_xmat[site_id])


def _pose(pos: NDArray[np.float64], axes: NDArray[np.float64]) -> NDArray[np.float64]:
    pose = np.eye(4)
    pose[:3, :3] = axes.reshape(3, 3)
    pose[:3, 3] = pos
    return pose
