"""A browser as a device: keys, pads for mouse and touch, and the orientation of a phone.

One page drives at a time: the first one whose clutch is closed, until it lets go, is silent or is
closed. Others watch.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._channel import MisbehavedError
from robocell._teleop.device import COMMANDS, FRAMES, Device, Motion
from robocell._web.web_server import text_of, vector_of

FRESH_S = 0.3  # a page repeats a speed more often
FASTEST = (0.2, 1.0)  # of keys: m/s and rad/s
MOST_SAID = 100  # messages between two reads that count
LONGEST = (0.5, 3.2)  # of one message of a drag: m and rad


def checked_input(message: dict[str, Any]) -> dict[str, Any]:
    """Returns a checked `input`. Raises MisbehavedError."""
    found: dict[str, Any] = {
        name: np.clip(vector_of(message, name, 3), -most, most)
        for name, most in (
            ("linear", 1.0),
            ("angular", 1.0),
            ("drag", LONGEST[0]),
            ("turn", LONGEST[1]),
        )
    }
    opening, frame = message.get("opening"), message.get("frame", "")
    if isinstance(opening, bool) or not isinstance(opening, int | float | None):
        raise MisbehavedError("`opening` of 'input' is a number or null")
    if not isinstance(frame, str) or frame not in ("", *FRAMES):
        raise MisbehavedError("`frame` of 'input' is one of the frames")
    if not isinstance(message.get("clutch"), bool):
        raise MisbehavedError("`clutch` of 'input' is true or false")
    return found | {"opening": opening, "frame": frame, "clutch": message["clutch"]}


def checked_command(message: dict[str, Any]) -> dict[str, Any]:
    """Returns a checked `command`. Raises MisbehavedError."""
    name = text_of(message, "name")
    if name not in COMMANDS:
        raise MisbehavedError(f"there is no command '{name[:40]}'")
    return {"name": name}


def _speeds(command: Mapping[str, Any]) -> NDArray[np.float64]:
    """Returns the speeds of an `input`, of the fastest ones (6,)."""
    return np.concatenate([command["linear"], command["angular"]])


class WebDevice(Device):
    """Collects what pages send, for `read`. All calls come from the thread of the scene.

    Attributes:
        driver: Number of the page that drives; 0 for none.
    """

    help = (
        "On the page hold W S A D R F to move, I K J L U O to turn, Space for the gripper; or drag "
        "the pads"
    )

    def __init__(self) -> None:
        self.driver = 0
        self._heard = -np.inf
        self._input: Mapping[str, Any] = {}
        self._said: list[NDArray[np.float64]] = []  # speeds since the last read
        self._openings: dict[int, float | None] = {}  # the last ones of all pages
        self._ignored: float | None = None
        self._drag, self._turn = np.zeros(3), np.zeros(3)
        self._commands: list[str] = []

    def apply(self, page: int, command: Mapping[str, Any]) -> bool:
        """Takes a command of a page. Returns True if it was one of a device."""
        match command["op"]:
            case "gone":
                self._openings.pop(page, None)
                if page == self.driver:
                    self._let_go()
                return False
            case "command":
                self._commands.append(command["name"])
            case "input":
                self._take(page, command)
            case _:
                return False
        return True

    def read(self, seconds: float) -> Motion | None:
        """Returns the driver's motion; None if no page drives."""
        commands, self._commands = tuple(self._commands), []
        silent = time.monotonic() - self._heard > FRESH_S
        if silent:
            self._let_go()
            return Motion(clutch=False, commands=commands) if commands else None
        given = self._input
        # The mean, so that a key that was let go before the read counts for its time.
        speed = np.mean(self._said or [_speeds(given)], axis=0)
        linear = FASTEST[0] * seconds * speed[:3] + self._drag
        angular = FASTEST[1] * seconds * speed[3:] + self._turn
        self.begin()
        return Motion(
            translation=(float(linear[0]), float(linear[1]), float(linear[2])),
            rotation=(float(angular[0]), float(angular[1]), float(angular[2])),
            opening=None if given["opening"] == self._ignored else given["opening"],
            clutch=given["clutch"],
            commands=commands,
            frame=given["frame"],
        )

    def begin(self) -> None:
        """Forgets drags and speeds that nobody followed."""
        self._drag, self._turn = np.zeros(3), np.zeros(3)
        self._said = []

    def _take(self, page: int, command: Mapping[str, Any]) -> None:
        before = self._openings.get(page, command["opening"])
        self._openings[page] = command["opening"]
        fresh = time.monotonic() - self._heard <= FRESH_S
        if self.driver not in (0, page) and fresh and self._input.get("clutch"):
            return  # another page drives
        if self.driver != page:
            self._let_go()
            self.driver = page
        if command["clutch"] and not self._input.get("clutch"):
            self._ignored = before  # a page that begins to drive remembers another time's opening
        if command["opening"] != self._ignored:
            self._ignored = None
        self._input, self._heard = command, time.monotonic()
        if command["clutch"]:
            self._said = [*self._said[1 - MOST_SAID :], _speeds(command)]
            self._drag += command["drag"]
            self._turn += command["turn"]

    def _let_go(self) -> None:
        self.driver, self._heard, self._input = 0, -np.inf, {}
        self.begin()
