"""Cameras that each start places anew: those beside the robot, and noise on all of them.

A run's cameras are on the robot or in the scene. One beside the robot is attached to its base,
which stands still in an episode, and gets the pose in the base that puts it where it belongs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell.compat.molmo_spaces.configs.camera_configs import (
    FixedExocentricCameraConfig,
    MjcfCameraConfig,
    RandomizedExocentricCameraConfig,
    RobotMountedCameraConfig,
)
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose
from robocell.compat.molmo_spaces.utils.pose import (
    inverse_pose,
    pos_quat_to_pose_mat,
    pose_mat_to_pos_quat,
)

Numbers = NDArray[np.float64]


class StartCameras:
    """The cameras of an experiment in the scenes of its starts."""

    def __init__(self, cameras: Sequence[Any]) -> None:
        """Takes the configurations of the cameras."""
        self._cameras = [camera for camera in cameras if _is_placed(camera)]
        self._as_compiled: dict[str, tuple[Numbers, float]] = {}
        self._scene: rc.Scene | None = None

    @property
    def tries(self) -> int:
        """How many places are worth trying: 1 where none is drawn around the workspace."""
        return max(
            (
                camera.max_placement_attempts
                for camera in self._cameras
                if isinstance(camera, RandomizedExocentricCameraConfig)
            ),
            default=1,
        )

    @property
    def may_be_hidden(self) -> bool:
        """True if a camera takes its last place where the object is visible from none."""
        return any(getattr(each, "allow_relaxed_constraints", False) for each in self._cameras)

    def place(self, scene: rc.Scene, robot: rc.Robot, target: Numbers, rng: rc.tasks.Rng) -> None:
        """Draws the poses of the cameras.

        Args:
            scene: The scene, with the base and the object (3,) `target` in their places.
            robot: The robot.
            target: Position of the object in the world, m.
            rng: The random numbers.
        """
        if self._scene is None or self._scene != scene:
            self._scene, self._as_compiled = scene, {}
        model, data = scene.model, scene.data
        middle = (target + robot.tcp_in_world.translation) / 2
        for camera in self._cameras:
            name = _name_in(camera, robot.prefix)
            number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, name)
            local, fovy = self._as_compiled.setdefault(
                name,
                (
                    pos_quat_to_pose_mat(model.cam_pos[number], model.cam_quat[number]),
                    float(model.cam_fovy[number]),
                ),
            )
            if isinstance(camera, FixedExocentricCameraConfig | RandomizedExocentricCameraConfig):
                in_world, fovy = _beside(camera, middle, fovy, rng)
                parent = body_pose(data, model.cam_bodyid[number])
                local = inverse_pose(parent) @ in_world
            local = local @ _noise(camera, rng)
            model.cam_pos[number], model.cam_quat[number] = pose_mat_to_pos_quat(local)
            change = getattr(camera, "fov_noise_degrees", None)
            model.cam_fovy[number] = fovy + (rng.uniform(*change) if change else 0)
        if self._cameras:
            scene.forward()


def looking(eye: Any, point: Any, up: Any, where: str = "camera") -> Numbers:
    """Returns the pose (4, 4) of a camera at `eye` that looks at `point`, along its -z axis.

    Its y axis, up in the image, is nearest to the direction `up`. Raises ArgumentError where the
    camera looks along it.
    """
    eye = np.asarray(eye, dtype=np.float64)
    back = eye - np.asarray(point, dtype=np.float64)
    right = np.cross(np.asarray(up, dtype=np.float64), back)
    if np.linalg.norm(right) < 1e-9:
        raise rc.ArgumentError(
            f"{where}: it looks along the direction that is up, {list(up)}, so that nothing is up "
            "in the image; choose another one"
        )
    z, x = back / np.linalg.norm(back), right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = eye
    return pose


def _is_placed(camera: Any) -> bool:
    if isinstance(camera, FixedExocentricCameraConfig | RandomizedExocentricCameraConfig):
        return True
    return any("noise" in name and getattr(camera, name) for name in type(camera).model_fields)


def _name_in(camera: Any, prefix: str) -> str:
    if isinstance(camera, MjcfCameraConfig):
        return camera.mjcf_name if camera.robot_namespace is None else prefix + camera.mjcf_name
    return prefix + str(camera.name)


def _beside(camera: Any, middle: Numbers, fovy: float, rng: rc.tasks.Rng) -> tuple[Numbers, float]:
    where = f"camera '{camera.name}'"
    if isinstance(camera, FixedExocentricCameraConfig):
        pos = np.asarray(camera.pos, dtype=np.float64)
        return looking(pos, pos + np.asarray(camera.forward), camera.up, where), fovy
    distance, height, azimuth = (
        rng.uniform(*bounds)
        for bounds in (camera.distance_range, camera.height_range, camera.azimuth_range)
    )
    away = np.array([distance * np.cos(azimuth), distance * np.sin(azimuth), height])
    eye, point = middle + away, middle + _drawn(camera.lookat_noise_range, rng)
    fovy = rng.uniform(*camera.fov_range) if camera.fov_range else fovy
    return looking(eye, point, [0, 0, 1], where), fovy


def _noise(camera: Any, rng: rc.tasks.Rng) -> Numbers:
    """Returns a change (4, 4) of the pose in the axes of the camera."""
    change = np.eye(4)
    change[:3, 3] = _drawn(getattr(camera, "pos_noise_range", None), rng)
    if isinstance(camera, RobotMountedCameraConfig):
        change[:3, 3] += _drawn(camera.lookat_noise_range, rng) * [1, 1, 0]
    most = getattr(camera, "orientation_noise_degrees", None)
    if most:
        angles = np.radians(np.broadcast_to(most, 3)) * [rng.uniform(-1, 1) for _ in range(3)]
        change[:3, :3] = rc.Pose(translation=[0, 0, 0], rpy=angles).rotation
    return change


def _drawn(bounds: Any, rng: rc.tasks.Rng) -> Numbers:
    """Draws three numbers within (smallest, largest), each a number or a triple."""
    if not bounds:
        return np.zeros(3)
    low, high = (np.broadcast_to(bound, 3) for bound in bounds)
    return np.array([rng.uniform(a, b) for a, b in zip(low, high, strict=True)])
