"""A picture of a robot at home with its frames drawn on it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from robocell import OrbitCamera, Renderer, write_png
from robocell.cli.robot_scene import RobotScene
from robocell.cli.robot_table import frames

SIZE_PX = (960, 720)
FOVY_DEG = 45.0
FILL = 0.78  # of the distance from which the sphere around the robot fits into the picture
AZIMUTH_DEG, ELEVATION_DEG = 140.0, -20.0
SHADOW_MAP_PX = 4096


def draw_robot(loaded: RobotScene, path: Path) -> None:
    """Writes a PNG with base, TCP and cameras as axes: x red, y green, z (a camera's view) blue."""
    loaded.scene.reset()
    centre, radius = _bounds(loaded)
    shown = frames(loaded)
    camera = OrbitCamera(
        lookat=centre,
        distance=FILL * radius / math.sin(math.radians(FOVY_DEG / 2)),
        azimuth=AZIMUTH_DEG,
        elevation=ELEVATION_DEG,
        fovy=FOVY_DEG,
    )
    renderer = Renderer(loaded.scene, shadows=True, multisamples=4, shadow_size=SHADOW_MAP_PX)
    images = renderer.render(
        camera,
        width=SIZE_PX[0],
        height=SIZE_PX[1],
        frames=list(shown.items()),
        frame_length=0.2 * radius,
    )
    write_png(path, images["rgb"])


def _bounds(loaded: RobotScene) -> tuple[np.ndarray, float]:
    """A sphere around the robot and its frames: centre (3,) in the world, radius, metres."""
    model, data = loaded.scene.model, loaded.scene.data
    own = model.geom_bodyid > 0
    points = [data.geom_xpos[own], *(X_WF.translation[None] for X_WF in frames(loaded).values())]
    reach = np.concatenate([model.geom_rbound[own], np.zeros(len(points) - 1)])
    places = np.concatenate(points)
    low, high = (places - reach[:, None]).min(axis=0), (places + reach[:, None]).max(axis=0)
    return (low + high) / 2, float(np.linalg.norm(high - low) / 2)
