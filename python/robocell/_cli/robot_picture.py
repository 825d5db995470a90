"""A picture of a robot at home with its frames drawn on it."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robocell._cli.robot_scene import RobotScene
from robocell._cli.robot_table import frames
from robocell.render import OrbitCamera, Renderer, write_png

SIZE_PX = (960, 720)
FOVY_DEG = 45.0
MARGIN = 1.06  # of the distance from which everything just fits
AZIMUTH_DEG, ELEVATION_DEG = 140.0, -20.0
AXIS = 0.1  # length of the drawn axes, in diagonals of the robot
NEAR = 1.0  # frames within this many diagonals of the robot belong into the picture
SHADOW_MAP_PX = 4096

Points = NDArray[np.float64]


def draw_robot(loaded: RobotScene, path: Path) -> None:
    """Writes a PNG with base, TCP and cameras as axes: x red, y green, z (a camera's view) blue."""
    loaded.scene.reset()
    low, high = _box(robot_points(loaded))
    renderer = Renderer(loaded.scene, shadows=True, multisamples=4, shadow_size=SHADOW_MAP_PX)
    images = renderer.render(
        view_of(loaded),
        width=SIZE_PX[0],
        height=SIZE_PX[1],
        frames=list(frames(loaded).items()),
        frame_length=AXIS * float(np.linalg.norm(high - low)),
    )
    write_png(path, images["rgb"])


def view_of(loaded: RobotScene) -> OrbitCamera:
    """Sees the whole robot as it stands, with the frames on and near it."""
    points = robot_points(loaded)
    low, high = _box(points)
    size = float(np.linalg.norm(high - low))
    for X_WF in frames(loaded).values():
        at, axes = X_WF.translation, X_WF.matrix[:3, :3].T
        if np.all(at > low - NEAR * size) and np.all(at < high + NEAR * size):
            points = np.vstack([points, at, at + AXIS * size * axes])
    low, high = _box(points)
    centre = (low + high) / 2
    return OrbitCamera(
        lookat=centre,
        distance=MARGIN * _distance(points - centre),
        azimuth=AZIMUTH_DEG,
        elevation=ELEVATION_DEG,
        fovy=FOVY_DEG,
    )


def robot_points(loaded: RobotScene) -> Points:
    """(n, 3) the corners of the boxes around the robot's geoms, in the world."""
    model, data = loaded.scene.model, loaded.scene.data
    corners = np.array(list(itertools.product((-1, 1), repeat=3)))
    found = [data.xpos[1:2]]  # a robot may have no geom
    for geom in range(model.ngeom):
        if model.geom_bodyid[geom] == 0 or model.geom_rbound[geom] <= 0:
            continue  # of the world, or a plane
        centre, half = model.geom_aabb[geom][:3], model.geom_aabb[geom][3:]
        rotation = data.geom_xmat[geom].reshape(3, 3)
        found.append(data.geom_xpos[geom] + (centre + corners * half) @ rotation.T)
    return np.concatenate(found)


def _box(points: Points) -> tuple[Points, Points]:
    return points.min(axis=0), points.max(axis=0)


def _distance(points: Points) -> float:
    """Returns the camera distance that shows all points (n, 3), relative to its target."""
    azimuth, elevation = math.radians(AZIMUTH_DEG), math.radians(ELEVATION_DEG)
    forward = np.array(
        [
            math.cos(elevation) * math.cos(azimuth),
            math.cos(elevation) * math.sin(azimuth),
            math.sin(elevation),
        ]
    )
    right = np.array([math.sin(azimuth), -math.cos(azimuth), 0])
    up = np.cross(right, forward)
    tall = math.tan(math.radians(FOVY_DEG / 2))
    wide = tall * SIZE_PX[0] / SIZE_PX[1]
    needed = np.maximum(np.abs(points @ right) / wide, np.abs(points @ up) / tall)
    return float(np.max(needed - points @ forward))
