"""What a device says, and the interface of devices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from robocell._core import ArgumentError, Error

COMMANDS = {
    "record": "begin an episode, after the countdown",
    "success": "end the episode; the task decides whether it is a success",
    "failure": "end the episode as a failure",
    "resync": "let the arm's command begin at its measured pose again",
    "reset_origin": "make the device's present pose its zero",
    "next_arm": "let the device move the next arm; the others hold",
    "keep": "store the episode that has ended",
    "discard": "drop the episode that has ended, or the present one, and begin again",
    "quit": "end the program; an ended episode is kept, one that is recorded is dropped",
}
FRAMES = ("base", "world", "tool", "camera")


class DeviceLostError(Error):
    """A device was unplugged, or its driver failed."""


@dataclass(frozen=True)
class Motion:
    """What a device says about the time since it was last read.

    Attributes:
        translation: Displacement of the TCP, m, in the axes of `frame`: x forward, y left, z up.
        rotation: Its rotation as a rotation vector, rad, in the same axes.
        opening: Target of the gripper, 0 closed to 1 open; None leaves it.
        joints: Joint positions that a leader arm has, by the names of the robot's joints or by
            their places from 0, rad or m. Then the displacement does not count.
        clutch: False while the arm shall not follow.
        commands: Commands that were given, of `COMMANDS`.
        frame: Whose axes the displacement has: "base" of the robot, "world", "tool" or "camera";
            "" for those of the session.
        arms: Motions of several arms, by the arms' names such as "left" or "torso/left". Then only
            the commands of this Motion count, and an arm without one holds.
    """

    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    opening: float | None = None
    joints: Mapping[str, float] = field(default_factory=dict)
    clutch: bool = True
    commands: tuple[str, ...] = ()
    frame: str = ""
    arms: Mapping[str, Motion] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Raises ArgumentError for numbers that are not finite, unknown commands and frames."""
        if not isinstance(self.joints, Mapping) or not isinstance(self.clutch, bool):
            raise ArgumentError("`joints` of a Motion is a map of numbers, `clutch` True or False")
        opening = () if self.opening is None else (self.opening,)
        numbers = (*self.translation, *self.rotation, *opening, *self.joints.values())
        if len(self.translation) != 3 or len(self.rotation) != 3:
            raise ArgumentError("a Motion has three numbers of translation and of rotation")
        if not all(math.isfinite(number) for number in numbers):
            raise ArgumentError(f"a Motion has numbers that are not finite: {self}")
        if unknown := [name for name in self.commands if name not in COMMANDS]:
            raise ArgumentError(f"no command '{unknown[0]}'; there are {', '.join(COMMANDS)}")
        if self.frame not in ("", *FRAMES):
            raise ArgumentError(f"no frame '{self.frame}'; there are {', '.join(FRAMES)}")
        if not isinstance(self.arms, Mapping) or not all(
            isinstance(name, str) and isinstance(each, Motion) and not each.arms
            for name, each in self.arms.items()
        ):
            raise ArgumentError("`arms` of a Motion is a map of names to Motions of one arm each")

    def as_json(self) -> dict[str, Any]:
        """Returns the fields that differ from those of a device at rest."""
        rest = asdict(Motion())
        fields = asdict(self)
        found = {name: value for name, value in fields.items() if value != rest[name]}
        if self.arms:
            found["arms"] = {name: each.as_json() for name, each in self.arms.items()}
        return found

    @classmethod
    def of_json(cls, fields: Mapping[str, Any]) -> Motion:
        """Returns what `as_json` returned. Raises ArgumentError for anything else."""
        if not isinstance(fields, Mapping):
            raise ArgumentError(f"{fields!r} is no Motion: it is a map of fields")
        known = set(cls.__dataclass_fields__)
        if unknown := sorted(set(fields) - known):
            raise ArgumentError(
                f"a Motion has no '{unknown[0]}'; it has {', '.join(sorted(known))}"
            )
        values: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in fields.items()
        }
        if isinstance(arms := values.get("arms"), Mapping):
            values["arms"] = {name: cls.of_json(each) for name, each in arms.items()}
        try:
            return cls(**values)
        except TypeError as error:
            raise ArgumentError(f"{dict(fields)} is no Motion: {error}") from error


class Device:
    """A device that a person moves. Subclasses define `read`.

    A session calls `start`, `begin` for each episode, `read` once for each action, and `close` at
    the end. It reads the device between episodes, too.

    Attributes:
        help: What the device's keys and buttons do, for people; lines of text.
        arms: Names of the arms that it moves; none if it moves the chosen one.
    """

    help = ""
    arms: tuple[str, ...] = ()

    def start(self) -> None:
        """Opens the device. Raises DeviceLostError if there is none."""

    def read(self, seconds: float) -> Motion | None:
        """Returns the motion since the last call, without waiting; None if the device is silent.

        While a device is silent the arm holds.

        Args:
            seconds: Duration of the action. A device that has a speed returns the displacement in
                this time.

        Raises:
            DeviceLostError: The device is gone; the session ends.
        """
        raise NotImplementedError

    def begin(self) -> None:
        """Forgets what was said before: an episode begins, with an open gripper."""

    def reset_origin(self) -> None:
        """Makes the present pose of the device its zero."""

    def close(self) -> None:
        """Releases the device; may be repeated."""
