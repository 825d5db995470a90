"""SimEnvCreatorConfig: an environment's configuration with the names of RCS, and what makes it."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

import robocell as rc
from robocell.compat.rcs._fields import NamedFields
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.envs.base import ControlMode, RelativeTo
from robocell.compat.rcs.envs.cameras import placed_cameras
from robocell.compat.rcs.envs.tasks import BaseTaskConfig
from robocell.compat.rcs.registries import SCENE_PATHS
from robocell.compat.rcs.sim import SimCameraConfig, SimConfig, SimGripperConfig, SimRobotConfig
from robocell.envs import CameraAdderConfig, WrapperConfig

if TYPE_CHECKING:
    from robocell.gym import GymEnv

__all__ = [
    "CameraAdderConfig",
    "ControlMode",
    "RelativeTo",
    "SimEnvCreator",
    "SimEnvCreatorConfig",
    "WrapperConfig",
]

Path = str | os.PathLike[str]
Placed = tuple[Path, rc.Pose]


def _without_images(
    camera: str, added: rc.envs.CameraAdderConfig, streams: Mapping[str, SimCameraConfig]
) -> str | None:
    """What is wrong when no entry of camera_cfgs takes images of a camera that was added.

    A model is there for its housing too.
    """
    if added.xml_path or any(stream.identifier == camera for stream in streams.values()):
        return None
    if camera in streams:
        return (
            f"camera_adds.{camera}: camera_cfgs.{camera} takes images of the camera "
            f"'{streams[camera].identifier}', its identifier; the name of this one is expected "
            f"there: identifier='{camera}'"
        )
    return (
        f"camera_adds.{camera}: no entry of camera_cfgs takes images of this camera; name it in "
        f"camera_cfgs ({{'{camera}': SimCameraConfig(identifier='{camera}')}}), or leave it out. "
        f"camera_cfgs has {', '.join(streams) or 'none'}"
    )


@dataclass(kw_only=True)
class SimEnvCreatorConfig(NamedFields):
    """A cell of one or several robots; all but the first three have defaults.

    ``_original_cfg`` is None: RCS keeps there what was given before it prefixes names in place,
    and robocell prefixes nothing in place.
    """

    robot_cfgs: Mapping[str, SimRobotConfig]
    sim_cfg: SimConfig
    control_mode: rc.ControlMode
    task_cfg: BaseTaskConfig | None = None
    scene: Path = SCENE_PATHS["empty_world"]
    gripper_cfgs: Mapping[str, SimGripperConfig] | None = None
    camera_cfgs: Mapping[str, SimCameraConfig] | None = None
    max_relative_movement: float | tuple[float, float] | None = None
    relative_to: rc.RelativeTo = RelativeTo.LAST_STEP
    robot_to_shared_base_frame: Mapping[str, rc.Pose] | None = None
    add_gravcomp: bool = False
    wrapper_cfg: rc.envs.WrapperConfig = field(default_factory=WrapperConfig)
    headless: bool = False
    shared_base_frame_to_root_frame: rc.Pose = field(default_factory=Pose)
    root_frame_to_world: rc.Pose = field(default_factory=Pose)
    alternative_combined_robot_mjcf: Path | None = None
    world_frame_objects: Mapping[str, Placed] | None = None
    root_frame_objects: Mapping[str, Placed] | None = None
    robot_frame_objects: Mapping[str, Mapping[str, Placed]] | None = None
    camera_adds: Mapping[str, rc.envs.CameraAdderConfig] | None = None
    gripper_offsets: Mapping[str, rc.Pose] | None = None
    _original_cfg: None = field(default=None, repr=False)

    def _check_names(self) -> None:
        """Finds wrong names that robocell would report with fields of its own configuration."""
        if self._original_cfg is not None:
            raise rc.ArgumentError(
                "_original_cfg: robocell prefixes nothing in place; give that configuration itself "
                "in the place of this one, and leave the field at None"
            )
        for robot in self.gripper_cfgs or {}:
            if robot not in self.robot_cfgs:
                raise rc.NotFoundError(
                    f"gripper_cfgs.{robot}: no robot '{robot}'. Known robots: "
                    f"{', '.join(self.robot_cfgs)}"
                )
        for robot, each in (self.robot_frame_objects or {}).items():
            if not isinstance(each, Mapping):
                raise rc.ArgumentError(
                    f"robot_frame_objects.{robot}: objects follow the wrist of a robot and are "
                    f"expected under its name, {{robot: {{'{robot}': (model, Pose)}}}}. Known "
                    f"robots: {', '.join(self.robot_cfgs)}"
                )
        streams = self.camera_cfgs or {}
        wrong = [_without_images(n, each, streams) for n, each in (self.camera_adds or {}).items()]
        if any(wrong):
            raise rc.ArgumentError("\n".join(text for text in wrong if text))

    def _step_limit(self) -> Any:
        """One number is metres with Cartesian actions, which then turn by a quarter at most."""
        limit: Any = self.max_relative_movement
        if np.ndim(limit) == 0 and self.control_mode != ControlMode.JOINTS:
            return (limit, math.pi / 2)
        return limit

    def _placed_cameras(
        self, robots: Mapping[str, rc.RobotConfig], grippers: Mapping[str, rc.RobotConfig]
    ) -> dict[str, rc.envs.CameraAdderConfig]:
        return placed_cameras(
            self.camera_cfgs or {},
            self.camera_adds or {},
            robots=self.robot_cfgs,
            models=[self.scene, *(each.model for each in (*robots.values(), *grippers.values()))],
            root_frame_to_world=self.root_frame_to_world,
        )

    def to_env_config(self, name: str = "env") -> rc.EnvConfig:
        """The same cell as robocell's configuration; this one stays as it is.

        ArgumentError for a camera of ``camera_adds`` that ``camera_cfgs`` does not name and for
        objects of wrists that are under no robot's name, NotFoundError for the gripper of none.
        """
        self._check_names()
        robots = {robot: each.to_robot() for robot, each in self.robot_cfgs.items()}
        grippers = {robot: each.to_robot() for robot, each in (self.gripper_cfgs or {}).items()}
        fields: dict[str, Any] = {
            "name": name,
            "robots": robots,
            "grippers": grippers,
            "gripper_offsets": dict(self.gripper_offsets or {}),
            "scene": str(self.scene),
            "root_frame_to_world": self.root_frame_to_world,
            "shared_base_frame_to_root_frame": self.shared_base_frame_to_root_frame,
            "robot_to_shared_base_frame": dict(self.robot_to_shared_base_frame or {}),
            "world_frame_objects": dict(self.world_frame_objects or {}),
            "root_frame_objects": dict(self.root_frame_objects or {}),
            "robot_frame_objects": {
                robot: dict(each) for robot, each in (self.robot_frame_objects or {}).items()
            },
            "camera_adds": self._placed_cameras(robots, grippers),
            "cameras": {
                "streams": [c.to_stream(camera) for camera, c in (self.camera_cfgs or {}).items()]
            },
            "add_gravcomp": self.add_gravcomp,
            "headless": self.headless,
            "control_mode": self.control_mode,
            "relative_to": self.relative_to,
            "sim": self.sim_cfg.to_settings(),
            "wrappers": self.wrapper_cfg,
        }
        if self.alternative_combined_robot_mjcf is not None:
            fields["alternative_combined_robot_mjcf"] = str(self.alternative_combined_robot_mjcf)
        if self.max_relative_movement is not None:
            fields["max_relative_movement"] = self._step_limit()
        config = rc.EnvConfig(**fields)
        if self.task_cfg is not None:
            self.task_cfg.add_to(config)
        return config


class SimEnvCreator:
    """Makes environments; subclasses have a `config` of their own."""

    def config(self) -> SimEnvCreatorConfig:
        """What is made when nothing else is said."""
        raise NotImplementedError(f"{type(self).__name__} has no config of its own; pass cfg=")

    def create_model(self, cfg: SimEnvCreatorConfig) -> rc.SceneSpec:
        """The scene alone: to look at, to build with `rc.Scene.build`, to save."""
        return rc.envs.env_scene_spec(cfg.to_env_config(type(self).__name__))

    def create_env(self, cfg: SimEnvCreatorConfig) -> GymEnv:
        """The environment as Gymnasium's."""
        from robocell.gym import GymEnv

        return GymEnv(cfg.to_env_config(type(self).__name__))

    def __call__(self, cfg: SimEnvCreatorConfig | None = None) -> GymEnv:
        """The environment of `cfg`, or of `config()`."""
        return self.create_env(self.config() if cfg is None else cfg)
