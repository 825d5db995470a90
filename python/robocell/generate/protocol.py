"""The messages between supervisor and worker: one JSON object per line.

From the supervisor, on the worker's standard input:
    {"do": {"id": ..., "index": ...}}   make this episode
    {"stop": true}                      end the present one quickly, then exit
    (end of file)                       the same: the supervisor has no more work, or is gone

From the worker, on what was its standard output:
    {"ready": true}                     the run is loaded; hand me an item
    {"done": {...}}                     an ItemResult; hand me the next
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
    """The other side sent something that is no message."""


@dataclass(frozen=True)
class Failure:
    """An exception, told to the other process.

    Attributes:
        kind: 'spec' when what the user wrote is wrong, 'io' for the disk and child processes.
        message: What to tell the user.
        trace: The lines of a user's own code that lead to the place in the message, which are shown
            in place of the worker's log; None when the log is to be shown.
    """

    kind: FailureKind
    message: str
    trace: str | None = None

    @classmethod
    def of(cls, error: BaseException, *, loading: bool = False) -> Failure:
        """Sorts an exception; one of a user's code comes with class, file and line.

        What is raised while a run is loaded says itself where in the run it is.
        """
        from robocell import ArgumentError, Error, NotFoundError, SpecError
        from robocell.generate.run_source import (
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
        told = in_code or not isinstance(error, Error | OSError)
        message = place_of(error) if told else text_of(error)
        return cls(kind, message, own_trace(error) if ends_with_place(message) else None)

    def error(self) -> Exception:
        """An exception to raise in its stead: SpecError, IoError or Error."""
        from robocell import Error, IoError, SpecError

        return {"spec": SpecError, "io": IoError, "other": Error}[self.kind](self.message)

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return asdict(self)

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Failure:
        """From a JSON object."""
        return cls(**values)


def encode(message: Mapping[str, Any]) -> bytes:
    """A message as a line."""
    return json.dumps(message, separators=(",", ":")).encode() + b"\n"


class LineReader:
    """Puts bytes that arrive in pieces together to messages."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[dict[str, Any]]:
        """The messages completed by `data`; ProtocolError for a line that is no JSON object."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            try:
                message = json.loads(line)
            except ValueError:
                message = None
            if not isinstance(message, dict):
                raise ProtocolError(f"not a message: {line[:200]!r}")
            yield message
