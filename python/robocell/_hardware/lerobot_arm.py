"""An arm with LeRobot's interface of a Robot as an `ArmPort`.

    # follower.yaml
    class: lerobot.robots.so101_follower:SO101Follower   # or one of your own
    options: {port: /dev/ttyACM0, id: my_arm, use_degrees: true}
    joints:   # robot joint = scale * motor + offset
      shoulder_pan.pos: {joint: joint1, scale: 0.01745, offset: 0}
    gripper: {from: gripper.pos, closed: 0, open: 100}

The class has `connect()`, `get_observation()` -> {name: number}, `send_action({name: number})` and
`disconnect()`. Its bus is slow, so a thread of the arm's own reads and writes it.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import (
    ArgumentError,
    ArmCommand,
    ArmLimits,
    ArmMeasurement,
    ArmPort,
    IoError,
    Robot,
    SpecError,
)
from robocell._lerobot_classes import full_name, made_by_name
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import place_of
from robocell._suggestions import did_you_mean
from robocell._teleop.devices import options_of
from robocell._teleop.leader import FIELDS, GripperMap, JointMap

LEROBOT = "lerobot.robots"
VELOCITY, ACCELERATION = 1.0, 4.0  # rad/s and rad/s^2 (or m) of an arm that names no limits
SMOOTH_S = 0.05  # time constant of the measured velocities
JOIN_S = 2.0
LETS_GO = "disable_torque_on_disconnect"  # an option of LeRobot's arms, on by default


def limits_of(robot: Robot) -> ArmLimits:
    """Returns the limits of a robot's arm, with moderate speeds."""
    lower, upper = np.asarray(robot.joint_limits, dtype=float).T
    count = len(lower)
    return ArmLimits(
        lower=lower,
        upper=upper,
        velocity=[VELOCITY] * count,
        acceleration=[ACCELERATION] * count,
        force=[math.inf] * count,
    )


class LeRobotArm(ArmPort):
    """An arm with LeRobot's interface of a Robot.

    Args:
        arm: The LeRobot Robot; it is connected here, and disconnected by `close`.
        joint_names: Names of the joints, in order.
        limits: Their limits.
        joints: Which motor is which joint; empty for all motors in their order, in degrees.
        gripper: Which motor is the gripper; without `joints`, the one called gripper, 0 to 100.

    Raises:
        ArgumentError: The arm lacks a motor or has no motor for a joint.
        IoError: It cannot be connected, or does not answer.
    """

    def __init__(
        self,
        arm: Any,
        joint_names: Sequence[str],
        limits: ArmLimits,
        joints: Mapping[str, JointMap] | None = None,
        gripper: GripperMap | None = None,
    ) -> None:
        super().__init__()
        self.name = f"LeRobot {type(arm).__name__}"
        self.joint_names, self.limits = list(joint_names), limits
        self._arm, self._gripper = arm, gripper
        self._lock = threading.Lock()
        self._ends = threading.Event()
        self._error: BaseException | None = None
        self._measured: ArmMeasurement | None = None
        self._last: ArmMeasurement | None = None
        self._action: dict[str, float] | None = None
        try:
            arm.connect()
            first = self._observe()
        except RAISED as error:
            self._disconnect()
            raise_interrupt(error)
            raise IoError(f"{self.name} cannot be connected: {place_of(error)}") from error
        try:
            self._motors = self._motors_of(first, dict(joints or {}))
        except ArgumentError:
            self._disconnect()
            raise
        self._thread = threading.Thread(target=self._serve, name=self.name, daemon=True)
        self._thread.start()

    @classmethod
    def of_file(cls, file: Path, robot: Robot) -> LeRobotArm:
        """Returns the arm that a file describes, for a robot. Raises SpecError."""
        content = options_of(file)
        if unknown := sorted(set(content) - FIELDS):
            raise SpecError(
                f"{file}: no field '{unknown[0]}'; there are {', '.join(sorted(FIELDS))}."
                f"{did_you_mean(unknown[0], sorted(FIELDS))}"
            )
        if not isinstance(content.get("class"), str):
            raise SpecError(f"{file}: `class` names the arm's class, as module:Class")
        try:
            joints = {
                name: JointMap(str(fields["joint"]), **_numbers(fields, {"joint"}))
                for name, fields in content.get("joints", {}).items()
            }
            given = content.get("gripper")
            gripper = given and GripperMap(given["from"], **_numbers(given, {"from"}))
        except (TypeError, ValueError, KeyError, AttributeError) as error:
            raise SpecError(
                f"{file}: a joint is {{joint: NAME, scale: NUMBER, offset: NUMBER}}, the gripper "
                f"{{from: NAME, closed: NUMBER, open: NUMBER}}: {error}"
            ) from error
        motors: dict[str, str] = {}
        for name, each in joints.items():
            if not each.scale:
                raise SpecError(f"{file}: the scale of '{name}' is {each.scale}; 0 moves no motor")
            if (other := motors.setdefault(each.joint, name)) != name:
                raise SpecError(f"{file}: '{other}' and '{name}' are both joint '{each.joint}'")
        if gripper and gripper.open == gripper.closed:
            raise SpecError(f"{file}: `open` and `closed` of the gripper are the same")
        options = content.get("options") or {}
        made = made_by_name(content["class"], options, in_degrees=not joints)
        _keep_torque(made, options)
        return cls(made, joint_names_of(robot), limits_of(robot), joints, gripper)

    @classmethod
    def of_name(cls, name: str, robot: Robot, config: Path | None = None) -> LeRobotArm:
        """Returns a LeRobot Robot by the name of its class, with the options in a file.

        Raises SpecError.
        """
        options = options_of(config)
        made = made_by_name(
            full_name(name, LEROBOT, "send_action", "arm"), options, in_degrees=True
        )
        _keep_torque(made, options)
        return cls(made, joint_names_of(robot), limits_of(robot))

    def read(self) -> ArmMeasurement | None:
        """Returns the newest measurement; None without a new one. Raises IoError."""
        with self._lock:
            self._raise_error()
            measured, self._measured = self._measured, None
            return measured

    def send(self, command: ArmCommand) -> None:
        """Commands the joints at the next turn of the bus."""
        action = {
            key: (value - each.offset) / each.scale
            for (key, each), value in zip(self._motors.items(), command.pos, strict=True)
        }
        if self._gripper is not None and command.opening is not None:
            closed, opened = self._gripper.closed, self._gripper.open
            action[self._gripper.name] = closed + command.opening * (opened - closed)
        with self._lock:
            self._raise_error()
            self._action = action

    def hold(self) -> None:
        """Commands the joints to where they were measured."""
        with self._lock:
            if self._last is not None:
                last = self._last.pos
                self._action = {
                    key: (value - each.offset) / each.scale
                    for (key, each), value in zip(self._motors.items(), last, strict=True)
                }

    def close(self) -> None:
        """Ends the thread and disconnects the arm. May be repeated."""
        if self._ends.is_set():
            return
        time.sleep(2 * SMOOTH_S)  # a hold that was sent last still reaches the motors
        self._ends.set()
        self._thread.join(JOIN_S)
        self._disconnect()

    def _disconnect(self) -> None:
        try:
            self._arm.disconnect()
        except RAISED as error:
            raise_interrupt(error)  # others: it may be unplugged

    def _raise_error(self) -> None:
        if self._error is not None:
            raise IoError(f"{self.name}: {place_of(self._error)}") from self._error

    def _serve(self) -> None:
        """Reads and writes the bus until the end; the thread of the arm."""
        vel: NDArray[np.float64] = np.zeros(len(self._motors))
        last: ArmMeasurement | None = None
        try:
            while not self._ends.is_set():
                at = time.monotonic()
                numbers = self._observe()
                pos = np.array(
                    [each.scale * numbers[key] + each.offset for key, each in self._motors.items()]
                )
                if last is not None and at > last.time:
                    seconds = at - last.time
                    vel = vel + ((pos - last.pos) / seconds - vel) * seconds / (seconds + SMOOTH_S)
                opening = None
                if self._gripper is not None:
                    opening = self._gripper.opening(numbers[self._gripper.name])
                last = ArmMeasurement(time=at, pos=pos, vel=vel, opening=opening)
                with self._lock:
                    self._measured = self._last = last
                    action, self._action = self._action, None
                if action is not None:
                    self._arm.send_action(action)
                # A bus that answers at once must not take the processor.
                time.sleep(max(0.0, 0.001 - (time.monotonic() - at)))
        except BaseException as error:
            with self._lock:
                self._error = error

    def _observe(self) -> dict[str, float]:
        """Returns the numbers that the arm observes; images are left out."""
        numbers = {}
        for key, value in self._arm.get_observation().items():
            if np.ndim(value) == 0 and not isinstance(value, str):
                numbers[str(key)] = float(value)
        return numbers

    def _motors_of(
        self, numbers: Mapping[str, float], joints: Mapping[str, JointMap]
    ) -> dict[str, JointMap]:
        """Returns the motors in the order of the joints."""
        keys = [key for key in numbers if key.endswith(".pos")] or list(numbers)
        if not joints:
            arm = [key for key in keys if "gripper" not in key]
            hand = [key for key in keys if "gripper" in key]
            if hand and self._gripper is None:
                self._gripper = GripperMap(hand[0], 0, 100)
            if len(arm) != len(self.joint_names):
                raise ArgumentError(
                    f"{self.name} has the motors {', '.join(arm)}; the robot's arm has the joints "
                    f"{', '.join(self.joint_names)}. Map them with `joints` in a file"
                )
            return {
                key: JointMap(joint, math.radians(1))
                for key, joint in zip(arm, self.joint_names, strict=True)
            }
        by_joint = {each.joint: (key, each) for key, each in joints.items()}
        wanted = [*joints, *([self._gripper.name] if self._gripper else [])]
        if missing := [key for key in wanted if key not in numbers]:
            raise ArgumentError(
                f"{self.name} has no motor '{missing[0]}'.{did_you_mean(missing[0], keys)} Its "
                f"motors: {', '.join(keys)}"
            )
        if lacking := [joint for joint in self.joint_names if joint not in by_joint]:
            raise ArgumentError(
                f"{self.name}: no motor is joint '{lacking[0]}'; `joints` has a motor for each of "
                f"{', '.join(self.joint_names)}"
            )
        return dict(by_joint[joint] for joint in self.joint_names)


def _numbers(fields: Mapping[str, Any], others: set[str]) -> dict[str, float]:
    """Returns the numbers of a map. Raises ValueError for others, and those not finite."""
    numbers = {name: float(value) for name, value in fields.items() if name not in others}
    if wrong := [name for name, value in numbers.items() if not math.isfinite(value)]:
        raise ValueError(f"`{wrong[0]}` is {numbers[wrong[0]]}")
    return numbers


def _keep_torque(made: Any, options: Mapping[str, Any]) -> None:
    """Lets a LeRobot arm hold where it is after the program, unless its options say otherwise."""
    config = getattr(made, "config", None)
    if LETS_GO not in options and hasattr(config, LETS_GO):
        setattr(config, LETS_GO, False)


def joint_names_of(robot: Robot) -> list[str]:
    """Returns the names of the arm's joints in the robot's own model: without the prefix."""
    return [name.removeprefix(robot.prefix) for name in robot.joint_names]
