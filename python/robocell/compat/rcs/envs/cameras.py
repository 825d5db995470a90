"""Cameras that camera_cfgs names and camera_adds does not place."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from math import pi, sqrt

import mujoco

import robocell as rc
from robocell.compat.rcs._reading import Path
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.sim import CameraType, SimCameraConfig

__all__ = [
    "FREE_FOVY",
    "FREE_IN_WORLD",
    "PAGE_CAMERAS",
    "camera_of_the_page",
    "placed_cameras",
]

# Name -> (pose, whether it is in the frame of a robot's attachment site, else in the root frame).
PAGE_CAMERAS = {
    "bird_eye": (
        Pose(translation=[0.271, 0.0, 2.080], quaternion=[0.0060, -0.0060, -0.7067, 0.7074]),
        False,
    ),
    "wrist": (Pose(translation=[0.06, 0, 0.05], rpy=[pi, -0.35, pi / 2]), True),
}
# MuJoCo's free camera before anybody moved it: 2 m from the origin, looking along y and down.
FREE_IN_WORLD = Pose(translation=[0, -sqrt(2), sqrt(2)], rpy=[pi / 4, 0, 0])
FREE_FOVY = 45.0


def camera_of_the_page(name: str, robot: str) -> rc.envs.CameraAdderConfig:
    """Returns the page's camera of this name; a wrist camera follows `robot`."""
    pose, follows = PAGE_CAMERAS[name]
    camera = rc.envs.CameraAdderConfig(fovy=60.0, offset=pose)
    if follows:
        camera.robot_name = robot
    return camera


def placed_cameras(
    streams: Mapping[str, SimCameraConfig],
    adds: Mapping[str, rc.envs.CameraAdderConfig],
    *,
    robots: Iterable[str],
    models: Iterable[Path],
    root_frame_to_world: rc.Pose,
) -> dict[str, rc.envs.CameraAdderConfig]:
    """Returns the cameras of `adds` and those that `streams` needs beside them.

    A free camera is fixed in the world. The page's minimal scene takes images of ``bird_eye`` and
    ``wrist`` and places neither: without cameras of these names, they get the poses of the page's
    other snippets, with a warning.
    """
    placed, names = dict(adds), list(robots)
    files = list(models)
    for name, stream in streams.items():
        camera = stream.camera_of(name)
        if stream.type == CameraType.free:
            if camera in adds:
                raise rc.ArgumentError(
                    f"camera_adds.{camera}: camera_cfgs.{name} is a free camera, which gets this "
                    f"name; give the one of camera_adds another name, or camera_cfgs.{name} the "
                    f"type fixed and identifier='{camera}' to show it"
                )
            offset = root_frame_to_world.inverse() * FREE_IN_WORLD
            placed[camera] = rc.envs.CameraAdderConfig(fovy=FREE_FOVY, offset=offset)
            continue
        if stream.type != CameraType.fixed or camera in placed or camera not in PAGE_CAMERAS:
            continue
        follows = PAGE_CAMERAS[camera][1]
        if (follows and len(names) != 1) or any(_has_camera(file, camera) for file in files):
            continue
        placed[camera] = camera_of_the_page(camera, names[0] if follows else "")
        frame = f"the wrist of robot '{names[0]}'" if follows else "the root frame"
        warnings.warn(
            f"camera_cfgs.{name}: camera_adds has no camera '{camera}'; it is placed relative to "
            f"{frame} as EmptyWorldFR3 has it. To place it elsewhere, add '{camera}' to "
            "camera_adds",
            stacklevel=4,
        )
    return placed


def _has_camera(file: Path, camera: str) -> bool:
    """Returns whether a model has a camera of this name; problems of the model show up later."""
    try:
        spec = mujoco.MjSpec.from_file(rc.models.resolve(str(file)))
    except (rc.Error, ValueError):
        return False
    return any(each.name == camera for each in spec.cameras)
