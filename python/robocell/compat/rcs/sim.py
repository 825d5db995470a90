"""Robots, grippers, cameras and the simulation, field by field."""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import PurePath
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell._suggestions import counted
from robocell.compat.rcs._fields import NamedFields
from robocell.compat.rcs._reading import Above, AtLeast, Form, Path, list_of, misfit, outside
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.registries import GRIPPER_PATHS, HOME_POSITIONS

__all__ = [
    "CameraType",
    "SimCameraConfig",
    "SimConfig",
    "SimGripperConfig",
    "SimRobotConfig",
]

TIMESTEP = rc.envs.SimSettings().timestep  # seconds
MOST_STEPS = 1_000_000  # of the engine, that a step may take
PAIR = "(lower, upper), two lists with a number for each joint"


def _read_limits(value: Any, place: str) -> NDArray[np.float64]:
    try:
        limits = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise misfit(place, PAIR, value) from None
    if limits.ndim != 2 or limits.shape[0] != 2:
        turned = limits.ndim == 2 and limits.shape[1] == 2
        hint = "; its transpose has that" if turned else ""
        raise outside(place, PAIR, f"numbers of shape {limits.shape}", hint)
    for row, column in np.argwhere(~np.isfinite(limits)):
        found = limits[row, column]
        raise outside(f"{place}[{row}][{column}]", "a finite number", found)
    return limits


def _read_geom(value: Any, place: str) -> Any:
    if not isinstance(value, str | Mapping | rc.scene.ElementRef):
        raise misfit(place, "a geom's name, or {'body': name, 'index': 0}", value)
    return value


JOINT_LIMITS = Form(PAIR, "pairs", _read_limits)
GEOM = Form("a geom's name", "geoms' names", _read_geom)
Geoms = Annotated[Sequence[Any], list_of(GEOM)]


def _fr3_joints() -> list[str]:
    return [f"fr3_joint{i}" for i in range(1, 8)]


@dataclass
class SimConfig(NamedFields):
    """Simulation settings; a negative number of convergence steps means no limit."""

    async_control: bool = False
    realtime: bool = False
    frequency: Annotated[float, Above(0)] = 30.0
    max_convergence_steps: int = 500

    def _check(self) -> None:
        steps = self.max_convergence_steps
        if steps == 0 or steps > MOST_STEPS:
            words = f"a whole number from 1 to {MOST_STEPS}, or -1 for no limit"
            raise outside(self._of("max_convergence_steps"), words, steps)

    def to_settings(self) -> rc.envs.SimSettings:
        """Converts to robocell's settings: engine steps become simulated seconds."""
        mine = self.as_read()
        steps = mine.max_convergence_steps if mine.max_convergence_steps > 0 else MOST_STEPS
        return rc.envs.SimSettings(
            async_control=mine.async_control,
            realtime=mine.realtime,
            frequency=mine.frequency,
            max_convergence_time=steps * TIMESTEP,
            on_collision="report" if mine.async_control else "stop",
        )


@dataclass
class SimRobotConfig(NamedFields):
    """An arm; by default the Menagerie's FR3. Names are those of its model, without prefix.

    ``dof``, if set, must be the number of joints. ``seconds_between_callbacks`` has no effect, and
    setting it gives a warning: robocell checks at every engine step whether an arm has arrived.
    Without gravity compensation servos may come to rest farther from their targets than
    ``joint_rotational_tolerance``; the step's reason is then ``settled``.
    """

    robot_type: str = "FR3"
    kinematic_model_path: Path = "menagerie:franka_fr3/fr3.xml"
    attachment_site: str = "attachment_site"
    tcp_offset: rc.Pose = field(default_factory=Pose)
    joints: Sequence[str] = field(default_factory=_fr3_joints)
    actuators: Sequence[str] = field(default_factory=_fr3_joints)
    base: str = "base"
    dof: int | None = None
    # (2, dof): lower, upper; those of the model unless set
    joint_limits: Annotated[ArrayLike, JOINT_LIMITS] | None = None
    q_home: Sequence[float] | None = field(default_factory=lambda: list(HOME_POSITIONS["FR3"]))
    joint_rotational_tolerance: Annotated[float, Above(0)] = math.radians(0.05)
    arm_collision_geoms: Geoms = ()
    seconds_between_callbacks: Annotated[float, AtLeast(0)] = 0.1

    def _check(self) -> None:
        joints = f"{counted(len(self.joints), 'joint')} ({', '.join(self.joints)})"
        if self.dof is not None and self.dof != len(self.joints):
            raise outside(self._of("dof"), f"None or the number of its {joints}", self.dof)
        if self.q_home is not None and len(self.q_home) != len(self.joints):
            words = f"a number for each of its {joints}"
            raise outside(self._of("q_home"), words, counted(len(self.q_home), "number"))
        self._check_limits(joints)

    def _check_limits(self, joints: str) -> None:
        if self.joint_limits is None:
            return
        place, limits = self._of("joint_limits"), np.asarray(self.joint_limits)
        if limits.shape[1] != len(self.joints):
            words = f"(lower, upper) for each of its {joints}"
            raise outside(place, words, f"numbers of shape {limits.shape}")
        for name, (lower, upper) in zip(self.joints, limits.T, strict=True):
            if lower > upper:
                turned = limits.shape == (2, 2) and (limits[:, 0] <= limits[:, 1]).all()
                hint = "; the transpose of joint_limits has that" if turned else ""
                words = f"(lower, upper): no lower limit above the upper one of joint '{name}'"
                raise outside(place, words, f"{lower:g} and {upper:g}", hint)

    def to_robot(self) -> rc.RobotConfig:
        """Converts to a robot configuration with one group, ``arm``."""
        self._warn_of_unused(
            {
                "seconds_between_callbacks": "whether the arm has arrived is looked at with every "
                "step of the engine; joint_rotational_tolerance says how near that is"
            },
        )
        mine = self.as_read()
        robot = rc.RobotConfig(
            name=mine.robot_type,
            model=str(mine.kinematic_model_path),
            root_body=mine.base,
            attachment_site=mine.attachment_site,
            tcp_offset=mine.tcp_offset,
            arrival_tolerance=mine.joint_rotational_tolerance,
            move_groups={
                "arm": {
                    "kind": "arm",
                    "joints": list(mine.joints),
                    "actuators": list(mine.actuators),
                }
            },
        )
        if mine.q_home is not None:
            robot.home = {"arm": list(mine.q_home)}
        if len(mine.arm_collision_geoms):
            robot.collision_geoms = list(mine.arm_collision_geoms)
        if mine.joint_limits is not None:
            robot.edits = [
                rc.robots.Edit(joint=name, range=[lower, upper])
                for name, (lower, upper) in zip(
                    mine.joints, np.asarray(mine.joint_limits).T.tolist(), strict=True
                )
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
    ``seconds_between_callbacks`` has no effect, and setting it gives a warning.
    """

    gripper_type: Path = "FrankaHand"
    joints: Sequence[str] = ("finger_joint1", "finger_joint2")
    actuator: str = "actuator8"
    min_actuator_width: float = 0
    max_actuator_width: float = 255
    min_joint_width: float = 0
    max_joint_width: float = 0.04
    collision_geoms: Geoms = ()
    collision_geoms_fingers: Geoms = ()
    ignored_collision_geoms: Sequence[str] = ()
    seconds_between_callbacks: Annotated[float, AtLeast(0)] = 0.05

    def _check(self) -> None:
        kind = str(self.gripper_type)
        if kind not in GRIPPER_PATHS and not kind.endswith(".xml"):
            known = ", ".join(GRIPPER_PATHS)
            raise rc.NotFoundError(
                f"{self._of('gripper_type')}: no gripper '{kind}'. Known grippers: {known}, or an "
                "MJCF file"
            )
        for of in ("actuator", "joint"):
            low, high = f"min_{of}_width", f"max_{of}_width"
            if getattr(self, low) == getattr(self, high):
                words = f"another width than {low}'s"
                raise outside(self._of(high), words, f"{getattr(self, high):g} in both")

    def to_robot(self) -> rc.RobotConfig:
        """Converts to a robot configuration with one group, ``gripper``."""
        self._warn_of_unused(_UNUSED_OF_GRIPPERS)
        mine = self.as_read()
        kind = str(mine.gripper_type)
        group: dict[str, Any] = {
            "kind": "gripper",
            "joints": list(mine.joints),
            "actuators": [mine.actuator],
            "ctrl": {"open": mine.max_actuator_width, "closed": mine.min_actuator_width},
        }
        if len(mine.collision_geoms_fingers):
            group["fingers"] = list(mine.collision_geoms_fingers)
        widths = {each.name: each.default for each in fields(mine) if "joint_width" in each.name}
        if any(getattr(mine, name) != default for name, default in widths.items()):
            group["joint_range"] = {"open": mine.max_joint_width, "closed": mine.min_joint_width}
        return rc.RobotConfig(
            name=PurePath(kind).stem,  # no name may contain the '/' of a path
            model=GRIPPER_PATHS.get(kind, kind),
            move_groups={"gripper": group},
            collision_geoms=list(mine.collision_geoms),
            ignored_collision_geoms=list(mine.ignored_collision_geoms),
        )


class CameraType(enum.Enum):
    """Kinds of cameras.

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
    """An image stream of a camera, by its name in the scene; rate 0: one frame per step."""

    identifier: str
    frame_rate: Annotated[float, AtLeast(0)] = 0
    resolution_width: Annotated[int, Above(0)] = 640
    resolution_height: Annotated[int, Above(0)] = 480
    type: CameraType = CameraType.fixed

    def to_stream(self, name: str) -> rc.render.CameraConfig:
        """Converts to an image stream of this name."""
        mine = self.as_read()
        stream = rc.render.CameraConfig(
            name=name, width=mine.resolution_width, height=mine.resolution_height
        )
        if mine.type == CameraType.tracking:
            stream.follow = mine.identifier
        elif mine.type == CameraType.default_free:
            stream.camera = "Free"
        else:
            stream.camera = mine.camera_of(name)
        if mine.frame_rate:
            stream.rate = mine.frame_rate
        return stream

    def camera_of(self, name: str) -> str:
        """Returns the scene's camera of the stream `name`; adds a free one."""
        mine = self.as_read()
        return f"{name}_free" if mine.type == CameraType.free else mine.identifier
