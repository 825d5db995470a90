"""A recorded session as a device: it says again what a device said, action by action."""

from __future__ import annotations

from pathlib import Path

from robocell._core import ArgumentError
from robocell._teleop.device import Device, Motion
from robocell._teleop.operator import OperatorOptions
from robocell._teleop.session import load_session


class RecordedDevice(Device):
    """Repeats a session. With the same run the episode is the same: the one with its id.

    Attributes:
        session: Content of the file: its robot and the options of following.
    """

    help = "a recorded session"

    def __init__(self, file: Path) -> None:
        self.session = load_session(file)
        self._motions: list[Motion | None] = self.session["motions"]
        if not self._motions:
            raise ArgumentError(f"'{file}' has no motion")
        self._next = 0

    def options(self) -> OperatorOptions:
        """Returns the options of the session, without what only a person needs."""
        return OperatorOptions(
            robot=self.session["robot"],
            follow=self.session["follow"],
            ends_at_success=self.session["ends_at_success"],
            asks=False,
            waits=False,
            real_time=False,
            episode=self.session["episode"],
            max_steps=self.session["max_steps"],
            seed=self.session["seed"],
        )

    def read(self, seconds: float) -> Motion | None:
        """Returns the next motion; at the end it quits."""
        if self._next == len(self._motions):
            return Motion(clutch=False, commands=("quit",))
        self._next += 1
        return self._motions[self._next - 1]
