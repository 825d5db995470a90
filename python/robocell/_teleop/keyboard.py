"""The keys of the terminal as a device. A terminal reports no releases, so each key is a step."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import termios
import tty
from typing import Any

from robocell._teleop.device import Device, DeviceLostError, Motion

STEP_M, STEP_RAD = 0.01, 0.06  # of one key, repeats included
MOVES = {
    "w": (0, 1), "s": (0, -1), "a": (1, 1), "d": (1, -1), "r": (2, 1), "f": (2, -1),
    "j": (3, -1), "l": (3, 1), "i": (4, 1), "k": (4, -1), "u": (5, 1), "o": (5, -1),
}  # fmt: skip
COMMANDS = {
    "\r": ("record", "keep"), "\n": ("record", "keep"), "y": ("success",), "n": ("failure",),
    "c": ("resync",), "z": ("reset_origin",), "t": ("next_arm",), "\x7f": ("discard",),
    "\b": ("discard",), "q": ("quit",),
}  # fmt: skip


class Keyboard(Device):
    """Reads keys of a terminal.

    Args:
        descriptor: The terminal; default standard input.
    """

    help = (
        "keys: w s forward and back, a d left and right, r f up and down, i k pitch, j l roll, u o "
        "yaw, space gripper; enter records and keeps, y success, n failure, backspace discards, c "
        "re-sync, z reset origin, t next arm, q quits"
    )

    def __init__(self, descriptor: int | None = None) -> None:
        self._descriptor = descriptor
        self._before: Any = None
        self._closed_hand = False

    def start(self) -> None:
        """Lets the terminal hand over each key at once."""
        if self._descriptor is None:
            self._descriptor = sys.stdin.fileno()
        if not os.isatty(self._descriptor):
            raise DeviceLostError(
                "--device keyboard reads keys from a terminal, and standard input is none; use "
                "--device web"
            )
        self._before = termios.tcgetattr(self._descriptor)
        tty.setcbreak(self._descriptor)

    def read(self, seconds: float) -> Motion | None:
        """Returns the steps of the keys that were pressed."""
        moved = [0.0] * 6
        commands: list[str] = []
        opening = None
        for key in self._keys():
            if key in MOVES:
                axis, sign = MOVES[key]
                moved[axis] += sign * (STEP_M if axis < 3 else STEP_RAD)
            elif key == " ":
                self._closed_hand = not self._closed_hand
                opening = 0.0 if self._closed_hand else 1.0
            else:
                commands += COMMANDS.get(key, ())
                if key == "t":
                    self._closed_hand = False  # that of another arm
        return Motion(
            translation=(moved[0], moved[1], moved[2]),
            rotation=(moved[3], moved[4], moved[5]),
            opening=opening,
            commands=tuple(commands),
        )

    def begin(self) -> None:
        """Begins with an open hand again."""
        self._closed_hand = False

    def close(self) -> None:
        """Restores the terminal."""
        if self._before is not None and self._descriptor is not None:
            with contextlib.suppress(termios.error):
                termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._before)
            self._before = None

    def _keys(self) -> str:
        assert self._descriptor is not None
        if not select.select([self._descriptor], [], [], 0)[0]:
            return ""
        try:
            data = os.read(self._descriptor, 1024)
        except OSError as error:
            raise DeviceLostError(f"the terminal is gone: {error.strerror}") from error
        if not data:
            raise DeviceLostError("the terminal is gone")
        return data.decode("utf-8", "replace").lower()
