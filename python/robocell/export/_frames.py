"""The frames of an episode in the world: robots, TCPs, objects and cameras."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robocell._core import Episode, Pose
from robocell.export._mcap_columns import STEPS


def frames_of(episode: Episode) -> dict[str, NDArray[np.float64]]:
    """Returns the poses (rows, 7) of each frame by its name; x y z, qx qy qz qw."""
    frames: dict[str, NDArray[np.float64]] = {}
    for name in step_columns(episode):
        parts = name.split("/")
        if len(parts) == 3 and parts[0] == "robots" and parts[2] in ("base_pose", "tcp_pose"):
            what = "base" if parts[2] == "base_pose" else "TCP"
            frames[f"{what} of {parts[1]}"] = episode[name]
        elif parts[0] == "objects" and parts[-1] == "pose":
            frames[name.removesuffix("/pose")] = episode[name]
        elif parts[0] == "cameras" and parts[-1] == "extrinsics":
            frames[name.removesuffix("/extrinsics")] = _camera_poses(episode[name])
    return frames


def step_columns(episode: Episode) -> list[str]:
    """Returns the columns that have a row for each step."""
    return [name for name in episode.columns if episode.column(name).table == STEPS]


def _camera_poses(extrinsics: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns poses of cameras in the world of matrices from the world to the camera."""
    poses_of = np.empty((len(extrinsics), 7))
    for row, matrix in enumerate(extrinsics):
        pose = Pose(matrix).inverse()
        poses_of[row] = [*pose.translation, *pose.quaternion]
    return poses_of
