"""Configurations of cameras. All cameras of a system have one resolution."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

import pydantic

import robocell as rc
from robocell.compat.molmo_spaces._elements import look_up
from robocell.compat.molmo_spaces.configs.abstract_config import Config

__all__ = [
    "AllCameraTypes",
    "CameraConfig",
    "CameraSystemConfig",
    "FixedExocentricCameraConfig",
    "FrankaDroidCameraSystem",
    "MjcfCameraConfig",
    "RandomizedExocentricCameraConfig",
    "RobotMountedCameraConfig",
]

Range: TypeAlias = tuple[float, float]
Triple: TypeAlias = tuple[float, float, float]


class CameraConfig(Config):
    """A camera.

    Attributes:
        name: Name of its images in observations and files.
        fov: Vertical field of view, degrees.
        record_depth: Record depth too.
        is_warped: The lens distorts. It has no effect, as in the original's simulation.
        skip_erosion: Without effect.
        visibility_constraints: Smallest share of the image that shows something when an episode
            begins: {"__task_objects__": 0.001}. Keys are bodies, "__task_objects__" (the first
            object of the task) and "__gripper__".
    """

    name: str
    fov: float | None = None
    record_depth: bool = False
    is_warped: bool = False
    skip_erosion: bool = False
    visibility_constraints: dict[str, float] | None = None


class MjcfCameraConfig(CameraConfig):
    """A camera of the robot's model or of the scene.

    Attributes:
        mjcf_name: Name of the camera in its model.
        robot_namespace: Prefix of the robot's names; None for a camera of the scene.
        pos_noise_range: Change of the position along the axes of the camera, m: smallest and
            largest, as two numbers or two triples.
        orientation_noise_degrees: Largest rotation about any axis, degrees.
        fov_noise_degrees: Smallest and largest change of the field of view, degrees.
    """

    mjcf_name: str
    robot_namespace: str | None = None
    pos_noise_range: Range | tuple[Triple, Triple] | None = None
    orientation_noise_degrees: float | Triple | None = None
    fov_noise_degrees: Range | None = None


class RobotMountedCameraConfig(CameraConfig):
    """A camera on a body of the robot.

    Attributes:
        reference_body_names: Names of bodies; the first that there is carries the camera.
        camera_offset: Position in the frame of the body, m.
        lookat_offset: Point in the frame of the body that the camera looks at, m.
        up_axis: Axis of the body that is up in the image: "x", "y" or "z".
        camera_quaternion: Rotation wxyz in the frame of the body, instead of `lookat_offset`.
        pos_noise_range: Smallest and largest change along each axis of the camera, m.
        lookat_noise_range: Smallest and largest change of the point along each axis, m.
        orientation_noise_degrees: Largest rotation about any axis, degrees.
    """

    reference_body_names: list[str]
    camera_offset: list[float] = [0.10, 0.0, -0.15]
    lookat_offset: list[float] = [0.0, 0.0, 0.08]
    up_axis: str = "z"
    camera_quaternion: list[float] | None = None
    pos_noise_range: Range | None = None
    lookat_noise_range: Range | None = None
    orientation_noise_degrees: float | None = None


class FixedExocentricCameraConfig(CameraConfig):
    """A camera that stands in the world.

    Attributes:
        pos: Position, m.
        forward: Direction that it looks in.
        up: Direction that is up in the image.
        pos_noise_range: Smallest and largest change along the axes of the camera, m.
        orientation_noise_degrees: Largest rotation about any axis, degrees.
    """

    pos: list[float]
    forward: list[float]
    up: list[float]
    pos_noise_range: Range | tuple[Triple, Triple] | None = None
    orientation_noise_degrees: float | Triple | None = None


class RandomizedExocentricCameraConfig(CameraConfig):
    """A camera that looks at the workspace from a place that each episode draws.

    Attributes:
        distance_range: Horizontal distance from the middle of the object and the TCP, m.
        height_range: Height above it, m.
        azimuth_range: Direction seen from it, rad about the vertical; 0 is away from the robot's
            base.
        fov_range: Vertical field of view, degrees.
        lookat_noise_range: Smallest and largest change of the point along each axis, m; symmetric.
        max_placement_attempts: How many places are tried for a start.
        allow_relaxed_constraints: Without effect: a start is refused if no place fits.
    """

    distance_range: Range
    height_range: Range
    azimuth_range: Range
    fov_range: Range | None = None
    lookat_noise_range: Range | None = None
    max_placement_attempts: int = 100
    allow_relaxed_constraints: bool = False


AllCameraTypes: TypeAlias = (
    MjcfCameraConfig
    | RobotMountedCameraConfig
    | FixedExocentricCameraConfig
    | RandomizedExocentricCameraConfig
)
"""Any configuration of a camera."""


class CameraSystemConfig(Config):
    """The cameras of an experiment.

    Attributes:
        img_resolution: Width and height of all images, pixels. Any size is right.
        cameras: The cameras.
    """

    img_resolution: tuple[
        Annotated[int, pydantic.Field(gt=0)], Annotated[int, pydantic.Field(gt=0)]
    ] = (624, 352)
    cameras: list[AllCameraTypes] = []

    def model_post_init(self, context: Any) -> None:
        """Raises ArgumentError for two cameras of one name."""
        super().model_post_init(context)
        names = [camera.name for camera in self.cameras]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise rc.ArgumentError(
                f"{type(self).__name__}.cameras: two cameras are called '{twice[0]}'; each needs "
                "a name of its own"
            )

    def add_camera(self, camera: AllCameraTypes) -> None:
        """Adds a camera. Raises ArgumentError for a name that there is already."""
        self.cameras = [*self.cameras, camera]
        self.model_post_init(None)

    def get_camera_by_name(self, name: str) -> AllCameraTypes:
        """Returns a camera. Raises NotFoundError that lists the names."""
        named = {camera.name: camera for camera in self.cameras}
        return look_up(named, name, f"{type(self).__name__}: camera")


WITHOUT_EFFECT = ("is_warped", "skip_erosion")


class FrankaDroidCameraSystem(CameraSystemConfig):
    """A camera at the wrist of the FR3 and one beside its base, as on robots of DROID."""

    cameras: list[AllCameraTypes] = [
        RobotMountedCameraConfig(
            name="wrist_camera",
            reference_body_names=["gripper/base"],
            camera_offset=[0.0, 0.07, 0.02],
            lookat_offset=[0.0, 0.0, 0.16],
            up_axis="y",
            fov=56.74,
        ),
        RobotMountedCameraConfig(
            name="exo_camera_1",
            reference_body_names=["fr3_link0"],
            camera_offset=[0.1, 0.57, 0.66],
            lookat_offset=[0.5, 0.0, 0.1],
            fov=71.0,
        ),
    ]
