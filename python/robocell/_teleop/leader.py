"""A leader arm: joints that a person moves, and that the robot's joints follow.

    # leader.yaml
    class: lerobot.teleoperators.so101_leader:SO101Leader   # or one of your own
    options: {port: /dev/ttyACM0, id: my_leader, use_degrees: true}
    joints:
      shoulder_pan.pos: {joint: joint1, scale: 0.01745, offset: 0}  # robot = scale * it + offset
    gripper: {from: gripper.pos, closed: 0, open: 100}

The class has LeRobot's interface: `connect()`, `get_action()` -> {name: number}, `disconnect()`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robocell._core import SpecError
from robocell._lerobot_classes import full_name, made_by_name
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import place_of
from robocell._teleop.device import Device, DeviceLostError, Motion
from robocell._teleop.devices import options_of

LEROBOT = "lerobot.teleoperators"
FIELDS = {"class", "options", "joints", "gripper"}


@dataclass(frozen=True)
class JointMap:
    """A joint of the robot, from a number of the leader.

    Attributes:
        joint: Name of the robot's joint, or its place from 0.
        scale: rad or m of the robot for one unit of the leader.
        offset: rad or m of the robot where the leader has 0.
    """

    joint: str
    scale: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class GripperMap:
    """The opening, from a number of the leader.

    Attributes:
        name: Name of the number.
        closed: Its value where the gripper is closed.
        open: Its value where it is open.
    """

    name: str
    closed: float
    open: float

    def opening(self, value: float) -> float:
        """Returns the opening from 0 to 1."""
        return min(max((value - self.closed) / (self.open - self.closed), 0.0), 1.0)


class Leader(Device):
    """Reads a leader arm with LeRobot's interface of a Teleoperator.

    Args:
        teleoperator: The leader.
        joints: Which joint follows which number; empty for all numbers in the order of the
            leader, in degrees.
        gripper: Which number is the opening.
    """

    help = "leader arm: the robot follows it"

    def __init__(
        self,
        teleoperator: Any,
        joints: Mapping[str, JointMap] | None = None,
        gripper: GripperMap | None = None,
    ) -> None:
        self._leader = teleoperator
        self._joints, self._gripper = dict(joints or {}), gripper
        self._connected = False

    @classmethod
    def of_file(cls, file: Path) -> Leader:
        """Returns the leader that a file describes. Raises SpecError."""
        content = options_of(file)
        if unknown := sorted(set(content) - FIELDS):
            raise SpecError(
                f"{file}: no field '{unknown[0]}'; there are {', '.join(sorted(FIELDS))}"
            )
        if not isinstance(content.get("class"), str):
            raise SpecError(f"{file}: `class` names the leader's class, as module:Class")
        try:
            joints = {
                name: JointMap(**{**fields, "joint": str(fields["joint"])})
                for name, fields in content.get("joints", {}).items()
            }
            given = content.get("gripper")
            gripper = given and GripperMap(given["from"], given["closed"], given["open"])
        except (TypeError, KeyError, AttributeError) as error:
            raise SpecError(
                f"{file}: a joint is {{joint: NAME, scale: NUMBER, offset: NUMBER}}, the gripper "
                f"{{from: NAME, closed: NUMBER, open: NUMBER}}: {error}"
            ) from error
        if gripper and gripper.open == gripper.closed:
            raise SpecError(f"{file}: `open` and `closed` of the gripper are the same")
        made = made_by_name(content["class"], content.get("options") or {}, in_degrees=not joints)
        return cls(made, joints, gripper)

    @classmethod
    def of_lerobot(cls, name: str, config: Path | None) -> Leader:
        """Returns a LeRobot Teleoperator, with the options in a file. Raises SpecError.

        `name` is module:Class, or LeRobot's own name of a class or of its folder, such as
        SO101Leader or so101_leader.
        """
        name = full_name(name, LEROBOT, "get_action", "device")
        return cls(made_by_name(name, options_of(config), in_degrees=True))

    def start(self) -> None:
        """Connects the leader."""
        self._call("connect")
        self._connected = True

    def read(self, seconds: float) -> Motion | None:
        """Returns the leader's joints."""
        action = self._call("get_action")
        if not isinstance(action, Mapping):
            raise DeviceLostError(f"the leader returned {action!r}, not a map of numbers")
        numbers = {}
        for name, value in action.items():
            try:
                numbers[str(name)] = float(value)
            except (TypeError, ValueError) as error:
                raise DeviceLostError(f"the leader's '{name}' is no number: {value!r}") from error
        if not all(map(math.isfinite, numbers.values())):
            return None
        opening = None
        if self._gripper is not None:
            opening = self._gripper.opening(self._number(numbers, self._gripper.name))
        joints = {
            each.joint: each.scale * self._number(numbers, name) + each.offset
            for name, each in self._joints.items()
        }
        if not self._joints:
            arm = [name for name in numbers if "gripper" not in name]
            joints = {str(i): math.radians(numbers[name]) for i, name in enumerate(arm)}
            hand = [value for name, value in numbers.items() if "gripper" in name]
            opening = min(max(hand[0] / 100, 0.0), 1.0) if hand else opening
        return Motion(joints=joints, opening=opening)

    def close(self) -> None:
        """Disconnects the leader."""
        if self._connected:
            self._connected = False
            try:
                self._leader.disconnect()
            except RAISED as error:
                raise_interrupt(error)  # the leader may be unplugged

    def _number(self, numbers: Mapping[str, float], name: str) -> float:
        if name not in numbers:
            raise DeviceLostError(
                f"the leader has no '{name}'; it has {', '.join(sorted(numbers))}"
            )
        return numbers[name]

    def _call(self, method: str) -> Any:
        try:
            return getattr(self._leader, method)()
        except RAISED as error:
            raise_interrupt(error)
            kind = type(self._leader).__name__
            raise DeviceLostError(f"{kind}.{method}(): {place_of(error)}") from error
