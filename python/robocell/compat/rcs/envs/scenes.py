"""SimEnvCreatorConfig: an environment's configuration with the names of RCS, and its creator."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import robocell as rc
from robocell.compat.rcs._fields import NamedFields
from robocell.compat.rcs._page_names import page_names
from robocell.compat.rcs._reading import NUMBER, PATH, Form, Path, form_of, list_of, misfit
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.envs.base import ControlMode, RelativeTo
from robocell.compat.rcs.envs.cameras import placed_cameras
from robocell.compat.rcs.envs.tasks import BaseTaskConfig
from robocell.compat.rcs.registries import SCENE_PATHS
from robocell.compat.rcs.sim import (
    CameraType,
    SimCameraConfig,
    SimConfig,
    SimGripperConfig,
    SimRobotConfig,
)
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


def _read_placed(value: Any, place: str) -> Any:
    # robocell's own dictionaries also take these, and report every other value.
    if isinstance(value, rc.envs.EnvObject | Mapping):
        return value
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise misfit(place, "(model, Pose), or an rc.envs.EnvObject", value)
    model, pose = value
    return PATH.read(model, f"{place}[0]"), form_of(rc.Pose).read(pose, f"{place}[1]")


def _read_limit(value: Any, place: str) -> Any:
    is_list = isinstance(value, Sequence) or getattr(value, "shape", ()) != ()
    if is_list and not isinstance(value, str | bytes):
        return tuple(list_of(NUMBER).read(value, place))
    try:
        return NUMBER.read(value, place)
    except TypeError:
        raise misfit(place, "a number or two numbers", value) from None


PLACED = Form("(model, Pose)", "(model, Pose)", _read_placed)
STEP_LIMIT = Form("a number or two numbers", "numbers", _read_limit)
Placed = Annotated[tuple[str, rc.Pose], PLACED]


def _without_images(
    camera: str, added: rc.envs.CameraAdderConfig, streams: Mapping[str, SimCameraConfig]
) -> str | None:
    """Returns the problem if no entry of camera_cfgs takes images of an added camera.

    A camera with a model is allowed without images, for its housing.
    """
    shown = [each.identifier for each in streams.values() if each.type == CameraType.fixed]
    if added.xml_path or camera in shown:
        return None
    if camera in streams and streams[camera].type != CameraType.fixed:
        return (
            f"camera_adds.{camera}: camera_cfgs.{camera} has the type "
            f"{streams[camera].type.name}, which shows no camera of the scene; give it the type "
            f"fixed, or leave this camera out"
        )
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

    ``_original_cfg`` is None: RCS keeps the given configuration there before it prefixes names in
    place, and robocell prefixes nothing in place.
    """

    robot_cfgs: Mapping[str, SimRobotConfig]
    sim_cfg: SimConfig
    control_mode: rc.envs.ControlMode
    task_cfg: BaseTaskConfig | None = None
    scene: Path = SCENE_PATHS["empty_world"]
    gripper_cfgs: Mapping[str, SimGripperConfig] | None = None
    camera_cfgs: Mapping[str, SimCameraConfig] | None = None
    max_relative_movement: Annotated[float | Sequence[float], STEP_LIMIT] | None = None
    relative_to: rc.envs.RelativeTo = RelativeTo.LAST_STEP
    robot_to_shared_base_frame: Mapping[str, rc.Pose] | None = None
    add_gravcomp: bool = False
    wrapper_cfg: rc.envs.WrapperConfig = field(default_factory=WrapperConfig)
    headless: bool = False
    shared_base_frame_to_root_frame: rc.Pose = field(default_factory=Pose)
    root_frame_to_world: rc.Pose = field(default_factory=Pose)
    alternative_combined_robot_mjcf: Path | None = None
    world_frame_objects: Mapping[str, Placed] | None = None
    root_frame_objects: Mapping[str, Placed] | None = None
    robot_frame_objects: Mapping[str, Any] | None = None  # {robot: {id: Placed}}
    camera_adds: Mapping[str, rc.envs.CameraAdderConfig] | None = None
    gripper_offsets: Mapping[str, rc.Pose] | None = None
    _original_cfg: None = field(default=None, repr=False)

    def _check(self) -> None:
        """Finds wrong names that robocell would report with its own field names."""
        if self._original_cfg is not None:
            raise rc.ArgumentError(
                "_original_cfg: robocell prefixes nothing in place; give that configuration itself "
                "in the place of this one, and leave the field at None"
            )
        for robot in self.gripper_cfgs or {}:
            if robot not in self.robot_cfgs:
                raise rc.NotFoundError(
                    f"{self._of('gripper_cfgs')}.{robot}: no robot '{robot}'. Known robots: "
                    f"{', '.join(self.robot_cfgs)}"
                )
        self._read_wrists()
        streams = self.camera_cfgs or {}
        wrong = [_without_images(n, each, streams) for n, each in (self.camera_adds or {}).items()]
        if any(wrong):
            raise rc.ArgumentError("\n".join(text for text in wrong if text))

    def _read_wrists(self) -> None:
        place = self._of("robot_frame_objects")
        objects = {}
        for robot, each in (self.robot_frame_objects or {}).items():
            if not isinstance(each, Mapping):
                raise rc.ArgumentError(
                    f"{place}.{robot}: objects follow the wrist of a robot and are "
                    f"expected under its name, {{robot: {{'{robot}': (model, Pose)}}}}. Known "
                    f"robots: {', '.join(self.robot_cfgs)}"
                )
            objects[robot] = form_of(Mapping[str, Placed]).read(each, f"{place}.{robot}")
        self.robot_frame_objects = objects

    def _step_limit(self) -> Any:
        """Returns the step limit: a number is metres for Cartesian actions, with a quarter turn."""
        limit = self.max_relative_movement
        if isinstance(limit, float) and self.control_mode != ControlMode.JOINTS:
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
        """Converts this configuration to robocell's; this one does not change.

        Raises TypeError for a field of another type than its annotation, ArgumentError for an
        invalid value, NotFoundError for an unknown name. The messages name the field,
        ``robot_cfgs.left.joints[2]``.
        """
        mine = self.as_read("")
        robots = {robot: each.to_robot() for robot, each in mine.robot_cfgs.items()}
        grippers = {robot: each.to_robot() for robot, each in (mine.gripper_cfgs or {}).items()}
        fields: dict[str, Any] = {
            "name": name,
            "robots": robots,
            "grippers": grippers,
            "gripper_offsets": mine.gripper_offsets or {},
            "scene": mine.scene,
            "root_frame_to_world": mine.root_frame_to_world,
            "shared_base_frame_to_root_frame": mine.shared_base_frame_to_root_frame,
            "robot_to_shared_base_frame": mine.robot_to_shared_base_frame or {},
            "world_frame_objects": mine.world_frame_objects or {},
            "root_frame_objects": mine.root_frame_objects or {},
            "robot_frame_objects": mine.robot_frame_objects or {},
            "camera_adds": mine._placed_cameras(robots, grippers),
            "cameras": {
                "streams": [c.to_stream(camera) for camera, c in (mine.camera_cfgs or {}).items()]
            },
            "add_gravcomp": mine.add_gravcomp,
            "headless": mine.headless,
            "control_mode": mine.control_mode,
            "relative_to": mine.relative_to,
            "sim": mine.sim_cfg.to_settings(),
            "wrappers": mine.wrapper_cfg,
        }
        if mine.alternative_combined_robot_mjcf is not None:
            fields["alternative_combined_robot_mjcf"] = mine.alternative_combined_robot_mjcf
        if mine.max_relative_movement is not None:
            fields["max_relative_movement"] = mine._step_limit()
        config = rc.EnvConfig(**fields)
        if mine.task_cfg is not None:
            mine.task_cfg.add_to(config)
        return config


class SimEnvCreator:
    """Makes environments; subclasses have a `config` of their own."""

    def config(self) -> SimEnvCreatorConfig:
        """Returns the default configuration."""
        raise NotImplementedError(f"{type(self).__name__} has no config of its own; pass cfg=")

    def create_model(self, cfg: SimEnvCreatorConfig) -> rc.SceneSpec:
        """Returns the scene's spec: to inspect, to build with `rc.Scene.build`, to save."""
        with page_names():
            return rc.envs.env_scene_spec(self._config_of(cfg))

    def create_env(self, cfg: SimEnvCreatorConfig) -> GymEnv:
        """Creates the environment with Gymnasium's interface."""
        from robocell.gym import GymEnv

        with page_names():
            return GymEnv(self._config_of(cfg))

    def __call__(self, cfg: SimEnvCreatorConfig | None = None) -> GymEnv:
        """Creates the environment of `cfg`, or of `config()`."""
        return self.create_env(self.config() if cfg is None else cfg)

    def _config_of(self, cfg: SimEnvCreatorConfig) -> rc.EnvConfig:
        if not isinstance(cfg, SimEnvCreatorConfig):
            raise misfit("cfg", "a SimEnvCreatorConfig", cfg)
        return cfg.to_env_config(type(self).__name__)
