"""Poses as 4x4 matrices, and as seven numbers: position, then quaternion wxyz."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc

__all__ = ["pos_quat_to_pose_mat", "pose_mat_to_7d", "pose_mat_to_pos_quat"]

Numbers = NDArray[np.float64]


def pose_mat_to_pos_quat(pose: ArrayLike) -> tuple[Numbers, Numbers]:
    """Returns position (3,) and quaternion wxyz (4,) of a pose (4, 4)."""
    matrix = as_pose_mat(pose)
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(matrix[:3, :3]).reshape(9))
    return matrix[:3, 3].copy(), quat


def pos_quat_to_pose_mat(pos: ArrayLike, quat: ArrayLike) -> Numbers:
    """Returns the pose (4, 4) of a position (3,) and a quaternion wxyz (4,)."""
    turned = np.empty(9)
    mujoco.mju_quat2Mat(turned, np.asarray(quat, dtype=np.float64))
    matrix = np.eye(4)
    matrix[:3, :3] = turned.reshape(3, 3)
    matrix[:3, 3] = pos
    return matrix


def pose_mat_to_7d(pose: ArrayLike) -> Numbers:
    """Returns the position and the quaternion wxyz (7,) of a pose (4, 4)."""
    return np.concatenate(pose_mat_to_pos_quat(pose))


def as_pose_mat(pose: ArrayLike, what: str = "pose") -> Numbers:
    """Returns it as numbers of shape (4, 4); other shapes raise ArgumentError."""
    matrix = np.asarray(pose, dtype=np.float64)
    if matrix.shape != (4, 4):
        raise rc.ArgumentError(f"{what}: expected a matrix of shape (4, 4), got {matrix.shape}")
    return matrix


def relative_pose(pose: ArrayLike, frame: ArrayLike) -> Numbers:
    """Returns a pose of the world (4, 4) in the axes of a frame of the world (4, 4)."""
    return inverse_pose(frame) @ as_pose_mat(pose)


def inverse_pose(pose: ArrayLike) -> Numbers:
    """Returns the inverse (4, 4) of a pose (4, 4), or of poses (B, 4, 4)."""
    matrix = np.asarray(pose, dtype=np.float64)
    turned = np.swapaxes(matrix[..., :3, :3], -1, -2)
    inverse = np.zeros_like(matrix)
    inverse[..., :3, :3] = turned
    inverse[..., :3, 3] = -np.einsum("...ij,...j->...i", turned, matrix[..., :3, 3])
    inverse[..., 3, 3] = 1
    return inverse
