"""Between the thread that owns a scene and the threads of pages: the newest frame, and commands.

A page asks for the next frame, so one that reads slowly gets fewer of them and holds up nobody.
Commands wait in a queue of limited length until the owner takes them.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Mapping
from typing import Any

from robocell._channel import MisbehavedError
from robocell._web.web_server import Reply

MOST_WAITING = 1000  # commands
FIRST_S = 20.0  # for the first shapes of a scene
PATIENCE_S = 0.5  # after which a page without a new frame gets an empty one
GONE_S = 2.0  # without a request, a page counts no longer


class FrameHub:
    """Hands frames to pages and their commands to the owner. Every method may be called anywhere.

    Attributes:
        dropped: Commands that nobody took in time.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._frame, self._number = b"", 0
        self._geometry = b""
        self._commands: deque[tuple[int, dict[str, Any]]] = deque()
        self._pages: dict[int, float] = {}
        self._next_page = 0
        self.dropped = 0

    def publish(self, frame: bytes) -> None:
        """Gives all pages a new frame."""
        with self._changed:
            self._frame = frame
            self._number += 1
            self._changed.notify_all()

    def publish_geometry(self, geometry: bytes) -> None:
        """Replaces the shapes that pages draw."""
        with self._changed:
            self._geometry = geometry
            self._changed.notify_all()

    def geometry(self) -> Reply | None:
        """Returns the shapes, and waits for the first ones; None if they do not come."""
        with self._changed:
            self._changed.wait_for(lambda: self._geometry, FIRST_S)
            return Reply(self._geometry) if self._geometry else None

    def wait(self, page: int, seen: int) -> tuple[int, bytes]:
        """Returns the number and the bytes of a frame after `seen`; no bytes if there is none."""
        end = time.monotonic() + PATIENCE_S
        with self._changed:
            self._pages[page] = time.monotonic()
            while self._number == seen:
                left = end - time.monotonic()
                if left <= 0:
                    return seen, b""
                self._changed.wait(left)
            return self._number, self._frame

    def post(self, page: int, command: dict[str, Any]) -> None:
        """Hands a command to the owner; the oldest ones are dropped if nobody takes them."""
        with self._changed:
            if len(self._commands) >= MOST_WAITING:
                self._commands.popleft()
                self.dropped += 1
            self._commands.append((page, command))
            self._changed.notify_all()

    def take(self) -> list[tuple[int, dict[str, Any]]]:
        """Returns the waiting commands with the numbers of their pages, in order."""
        with self._changed:
            taken = list(self._commands)
            self._commands.clear()
            return taken

    def rest(self, seconds: float) -> None:
        """Waits so long, or until there is a command."""
        with self._changed:
            if not self._commands:
                self._changed.wait(max(seconds, 0.0))

    def open_page(self) -> int:
        """Returns the number of a new page."""
        with self._changed:
            self._next_page += 1
            self._pages[self._next_page] = time.monotonic()
            self._changed.notify_all()
            return self._next_page

    def close_page(self, page: int) -> None:
        """Forgets a page, and tells the owner by the command `gone`."""
        with self._changed:
            self._pages.pop(page, None)
        self.post(page, {"op": "gone"})

    @property
    def watched(self) -> bool:
        """True while a page asks for frames."""
        now = time.monotonic()
        with self._changed:
            return any(now - asked < GONE_S for asked in self._pages.values())


class HubVisit:
    """A page that gets frames and sends commands.

    Args:
        hub: Where frames come from.
        checks: For each `op` a function that returns the checked command, or raises
            MisbehavedError.
    """

    def __init__(self, hub: FrameHub, checks: Mapping[str, Any]) -> None:
        self._hub, self._checks = hub, checks
        self._page = hub.open_page()
        self._seen = 0

    def answer(self, message: dict[str, Any]) -> bytes | None:
        """Returns the next frame for `next`; other messages are commands for the owner."""
        operation = message["op"]
        if operation == "next":
            self._seen, frame = self._hub.wait(self._page, self._seen)
            return frame
        check = self._checks.get(operation)
        if check is None:
            raise MisbehavedError(f"there is no operation '{operation[:40]}'")
        self._hub.post(self._page, {"op": operation, **check(message)})
        return None

    def end(self) -> None:
        """The page has gone."""
        self._hub.close_page(self._page)
