"""Robots, grippers, cameras and the simulation, field by field."""

from __future__ import annotations

import enum
import math
import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import PurePath
from typing import Any

import robocell as rc
from robocell.compat.rcs._fields import NamedFields
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.registries import GRIPPER_PATHS, HOME_POSITIONS

TIMESTEP = rc.envs.SimSettings().timestep  # seconds
UNLIMITED = 1e6 * TIMESTEP  # s; the most that a step may take


def _warn_of_unused(config: Any, instead: Mapping[str, str]) -> None:
    """For each of these fields that is not at its default: that it does nothing, and what does.

    A warning of one text comes once, as Python shows warnings.
    """
    for each in fields(config):
        if each.name not in instead:
            continue
        value = getattr(config, each.name)
        if (tuple(value) if isinstance(each.default, tuple) else value) != each.default:
            warnings.warn(
                f"{type(config).__name__}.{each.name} does nothing: {instead[each.name]}",
                stacklevel=2,
            )


def _fr3_joints() -> list[str]:
    return [f"fr3_joint{i}" for i in range(1, 8)]


@dataclass
class SimConfig(NamedFields):
    """How the simulation runs; a number of convergence steps below 0 is none."""

    async_control: bool = False
    realtime: bool = False
    frequency: float = 30.0
    max_convergence_steps: int = 500

    def to_settings(self) -> rc.envs.SimSettings:
        """As robocell's: steps of the engine become simulated seconds."""
        steps = self.max_convergence_steps
        return rc.envs.SimSettings(
            async_control=self.async_control,
            realtime=self.realtime,
            frequency=self.frequency,
            max_convergence_time=UNLIMITED if steps < 0 else steps * TIMESTEP,
            on_collision="report" if self.async_control else "stop",
        )


@dataclass
class SimRobotConfig(NamedFields):
    """An arm; by default the Menagerie's FR3. Names are those of its model, without prefix.

    ``dof``, when it is set, must be the number of joints. ``seconds_between_callbacks`` does
    nothing, and a warning says so when it is set: robocell looks at every step of the engine
    whether an arm has arrived. Without gravity compensation servos may come to rest farther from
    their targets than ``joint_rotational_tolerance``; the step's reason is then ``settled``.
    """

    robot_type: str = "FR3"
    kinematic_model_path: str | os.PathLike[str] = "menagerie:franka_fr3/fr3.xml"
    attachment_site: str = "attachment_site"
    tcp_offset: rc.Pose = field(default_factory=Pose)
    joints: Sequence[str] = field(default_factory=_fr3_joints)
    actuators: Sequence[str] = field(default_factory=_fr3_joints)
    base: str = "base"
    dof: int | None = None
    joint_limits: Any = None  # (2, dof): lower, upper; those of the model unless set
    q_home: Sequence[float] | None = field(default_factory=lambda: list(HOME_POSITIONS["FR3"]))
    joint_rotational_tolerance: float = math.radians(0.05)
    arm_collision_geoms: Sequence[str] = ()
    seconds_between_callbacks: float = 0.1

    def to_robot(self) -> rc.RobotConfig:
        """As a robot's configuration with one group, ``arm``."""
        _warn_of_unused(
            self,
            {
                "seconds_between_callbacks": "whether the arm has arrived is looked at with every "
                "step of the engine; joint_rotational_tolerance says how near that is"
            },
        )
        if self.dof is not None and self.dof != len(self.joints):
            raise rc.ArgumentError(
                f"robot {self.robot_type}: dof is {self.dof}, but joints has {len(self.joints)} "
                "names"
            )
        robot = rc.RobotConfig(
            name=str(self.robot_type),
            model=str(self.kinematic_model_path),
            root_body=self.base,
            attachment_site=self.attachment_site,
            tcp_offset=self.tcp_offset,
            arrival_tolerance=self.joint_rotational_tolerance,
            move_groups={
                "arm": {
                    "kind": "arm",
                    "joints": list(self.joints),
                    "actuators": list(self.actuators),
                }
            },
        )
        if self.q_home is not None:
            robot.home = {"arm": [float(q) for q in self.q_home]}
        if len(self.arm_collision_geoms):
            robot.collision_geoms = list(self.arm_collision_geoms)
        if self.joint_limits is not None:
            lower, upper = self.joint_limits
            robot.edits = [
                rc.robots.Edit(joint=name, range=[float(low), float(high)])
                for name, low, high in zip(self.joints, lower, upper, strict=True)
            ]
        return robot


_UNUSED_OF_GRIPPERS = {
    "seconds_between_callbacks": "whether the fingers stand still is looked at with every step of "
    "the engine",
}


@dataclass
class SimGripperConfig(NamedFields):
    """A gripper of GRIPPER_PATHS, or ``gripper_type`` is a model's path; by default Franka's hand.

    The opening is read from the first joint between ``min_joint_width`` (closed) and
    ``max_joint_width`` (open) when one of them is set, else from the distance between the fingers.
    A contact of ``collision_geoms`` is a collision, which ends a step as one of the arm does, but
    for contacts between the fingers and with ``ignored_collision_geoms`` (full names of the scene).
    ``seconds_between_callbacks`` does nothing, and a warning says so when it is set.
    """

    gripper_type: str = "FrankaHand"
    joints: Sequence[str] = ("finger_joint1", "finger_joint2")
    actuator: str = "actuator8"
    min_actuator_width: float = 0
    max_actuator_width: float = 255
    min_joint_width: float = 0
    max_joint_width: float = 0.04
    collision_geoms: Sequence[str] = ()
    collision_geoms_fingers: Sequence[str] = ()
    ignored_collision_geoms: Sequence[str] = ()
    seconds_between_callbacks: float = 0.05

    def to_robot(self) -> rc.RobotConfig:
        """As a robot's configuration with one group, ``gripper``."""
        _warn_of_unused(self, _UNUSED_OF_GRIPPERS)
        kind = str(self.gripper_type)
        if kind not in GRIPPER_PATHS and not kind.endswith(".xml"):
            known = ", ".join(GRIPPER_PATHS)
            raise rc.NotFoundError(f"no gripper '{kind}'. Known grippers: {known}, or an MJCF file")
        group: dict[str, Any] = {
            "kind": "gripper",
            "joints": list(self.joints),
            "actuators": [self.actuator],
            "ctrl": {"open": self.max_actuator_width, "closed": self.min_actuator_width},
        }
        if len(self.collision_geoms_fingers):
            group["fingers"] = list(self.collision_geoms_fingers)
        widths = {each.name: each.default for each in fields(self) if "joint_width" in each.name}
        if any(getattr(self, name) != default for name, default in widths.items()):
            group["joint_range"] = {"open": self.max_joint_width, "closed": self.min_joint_width}
        return rc.RobotConfig(
            name=PurePath(kind).stem,  # no name may contain the '/' of a path
            model=GRIPPER_PATHS.get(kind, kind),
            move_groups={"gripper": group},
            collision_geoms=list(self.collision_geoms),
            ignored_collision_geoms=list(self.ignored_collision_geoms),
        )


class CameraType(enum.Enum):
    """Which kind of camera.

    ``fixed``: the camera of the scene that ``identifier`` names. ``tracking``: a view of the body
    that it names, from 2 m away. ``free``: MuJoCo's free camera as it begins, 2 m from the world's
    origin. ``default_free``: the whole scene, as MuJoCo's viewer shows it first.
    """

    free = "free"
    tracking = "tracking"
    fixed = "fixed"
    default_free = "default_free"


@dataclass
class SimCameraConfig(NamedFields):
    """What is taken of a camera, by its name in the scene; rate 0: a frame with every step."""

    identifier: str
    frame_rate: float = 0
    resolution_width: int = 640
    resolution_height: int = 480
    type: CameraType = CameraType.fixed

    def to_stream(self, name: str) -> rc.render.CameraConfig:
        """As an image stream of this name."""
        stream = rc.render.CameraConfig(
            name=name, width=self.resolution_width, height=self.resolution_height
        )
        if self.type == CameraType.tracking:
            stream.follow = self.identifier
        elif self.type == CameraType.default_free:
            stream.camera = "Free"
        else:
            stream.camera = self.camera_of(name)
        if self.frame_rate:
            stream.rate = float(self.frame_rate)
        return stream

    def camera_of(self, name: str) -> str:
        """The scene's camera that the stream `name` shows; a free one is added for it."""
        return f"{name}_free" if self.type == CameraType.free else self.identifier
