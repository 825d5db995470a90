"""The messages between supervisor and worker: one JSON object per line.

From the supervisor, on the worker's standard input:
    {"do": {"id": ..., "index": ...}}   make this episode
    {"stop": true}                      end the present one quickly, then exit
    (end of file)                       the same: the supervisor has no more work, or is gone

From the worker, on what was its standard output:
    {"ready": true}                     the run is loaded; hand me an item
    {"done": {...}}                     an ItemRecord; hand me the next
    {"failed": {...}}                   a Failure: the item in hand raised; the worker exits
    {"refused": {...}}                  a Failure: the run cannot be loaded; the worker exits
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

FailureKind = Literal["spec", "io", "other"]


class ProtocolError(Exception):
    """The other process sent an invalid message."""


@dataclass(frozen=True)
class Failure:
    """An exception, sent to the other process.

    Attributes:
        kind: 'spec' for an error in the user's files, 'io' for the disk and child processes.
        message: Text for the user.
        trace: Traceback lines in a user's own code, shown instead of the worker's log; None shows
            the log.
    """

    kind: FailureKind
    message: str
    trace: str | None = None

    @classmethod
    def of(cls, error: BaseException, *, loading: bool = False) -> Failure:
        """Sorts an exception; one of a user's code comes with class, file and line.

        Errors while a run is loaded already name the place in the run.
        """
        from robocell import ArgumentError, Error, NotFoundError, SpecError
        from robocell._raised import (
            ends_with_place,
            is_of_users,
            own_trace,
            place_of,
            text_of,
        )

        kind: FailureKind = "io" if isinstance(error, OSError) else "other"
        if isinstance(error, (SpecError, NotFoundError, ArgumentError)):
            kind = "spec"
        # Whatever its class: robocell raises in a user's code too.
        in_code = kind != "io" and not loading and is_of_users(error)
        with_place = in_code or not isinstance(error, Error | OSError)
        message = place_of(error) if with_place else text_of(error)
        return cls(kind, message, own_trace(error) if ends_with_place(message) else None)

    def error(self) -> Exception:
        """Returns the exception to raise here: SpecError, IoError or Error."""
        from robocell import Error, IoError, SpecError

        return {"spec": SpecError, "io": IoError, "other": Error}[self.kind](self.message)

    def to_json(self) -> dict[str, Any]:
        """Returns a JSON object."""
        return asdict(self)

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Failure:
        """Reads a JSON object."""
        return cls(**values)


def encode(message: Mapping[str, Any]) -> bytes:
    """Returns a message as a line."""
    return json.dumps(message, separators=(",", ":")).encode() + b"\n"


class LineReader:
    """Puts bytes that arrive in pieces together to messages."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[dict[str, Any]]:
        """Returns the messages completed by `data`. Raises ProtocolError for an invalid line."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            try:
                message = json.loads(line)
            except ValueError:
                message = None
            if not isinstance(message, dict):
                raise ProtocolError(f"not a message: {line[:200]!r}")
            yield message
