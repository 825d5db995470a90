"""What happens in an episode, in words: its instruction, phases, sub-tasks and end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robocell._core import Episode
from robocell.export._mcap_columns import times_of
from robocell.export._source import Item


@dataclass(frozen=True)
class Event:
    """One event.

    Attributes:
        time: In nanoseconds.
        text: What happens.
        kind: "instruction", "phase", "subtask" or "end".
        failed: Whether it is the end of a failure.
    """

    time: int
    text: str
    kind: str
    failed: bool = False


def events_of(episode: Episode, item: Item) -> Iterator[Event]:
    """Yields the instruction, each change of a phase or sub-task, and the end."""
    times = times_of(episode)
    yield Event(times[0], item.task, "instruction")
    changes = []
    for name in ("phase", "subtask"):
        if name in episode and (values := list(episode.column(name).values)):
            indices = episode[name]
            starts = [0, *(np.flatnonzero(np.diff(indices)) + 1).tolist()]
            changes += [
                (row, f"{name}: {values[indices[row]]}", name)
                for row in starts
                if 0 <= indices[row] < len(values)
            ]
    for row, text, name in sorted(changes):
        yield Event(times[row], text, name)
    result = "succeeded" if item.success else "failed"
    yield Event(times[-1], f"{result}: {item.end_reason}", "end", failed=not item.success)
