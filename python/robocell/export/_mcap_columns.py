"""Columns of episodes as topics of an MCAP file: JSON with a value for each component."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Episode
from robocell.export._features import Feature

STEPS = "steps"
LARGEST = 64  # numbers of a row; matrices and point clouds are no plots


@dataclass(frozen=True)
class Topic:
    """A topic of JSON messages.

    Attributes:
        name: Its name, "/" and that of the column.
        table: The table whose rows are messages.
        fields: One name for each number of a row.
        units: The unit of each; "" for none.
        frame: The frame of the numbers; "" for none.
        description: One sentence; "" for none.
        values: The names of 0, 1, ... of an integer column.
        feature: What it is, where it is no column of the episode.
    """

    name: str
    table: str
    fields: tuple[str, ...]
    units: tuple[str, ...]
    frame: str = ""
    description: str = ""
    values: tuple[str, ...] = ()
    feature: Feature | None = None

    @property
    def schema(self) -> dict[str, Any]:
        """The JSON schema of a message."""
        fields: dict[str, Any] = {}
        for name, unit in zip(self.fields, self.units, strict=True):
            fields[name] = {"type": ["number", "boolean", "null"]}
            if unit:
                fields[name]["description"] = unit
        if self.values:
            fields["name"] = {"type": "string"}
        whole = {"title": self.name.lstrip("/"), "type": "object", "properties": fields}
        return whole | ({"description": self.description} if self.description else {})

    @property
    def metadata(self) -> dict[str, str]:
        """What a viewer shows of the topic: unit and frame."""
        units = ", ".join(dict.fromkeys(self.units))
        return {key: text for key, text in (("unit", units), ("frame", self.frame)) if text}

    def messages(self, episode: Episode) -> Iterator[tuple[int, str, bytes]]:
        """Yields time, name and content of each row."""
        times = times_of(episode, self.table)
        if self.feature is not None:
            rows = self.feature.read(episode)
        else:
            column = episode[self.name[1:]]
            rows = column.reshape(len(column), -1)
        for time, row in zip(times, rows.tolist(), strict=True):
            content = dict(zip(self.fields, map(_number, row), strict=True))
            if self.values:
                [index] = row
                content["name"] = self.values[index] if 0 <= index < len(self.values) else ""
            yield time, self.name, json.dumps(content, allow_nan=False).encode()


def json_topics(episode: Episode, features: Sequence[Feature]) -> list[Topic]:
    """Returns the topics of an episode: its columns, and the features of the mapping.

    Raises:
        ArgumentError: A feature has the name of a column.
    """
    topics = [
        _topic_of(episode, name)
        for name in episode.columns
        if _is_plot(episode, name) and name.rpartition("/")[2] != "time"
    ]
    taken = {topic.name for topic in topics}
    for feature in features:
        if (name := f"/{feature.name}") in taken:
            raise ArgumentError(
                f"episode '{episode.folder}' has a column '{feature.name}', whose topic is written "
                "anyway. Choose another name for the feature"
            )
        topics.append(Topic(name, STEPS, feature.names, feature.units, feature=feature))
    return topics


def times_of(episode: Episode, table: str = STEPS) -> list[int]:
    """Returns the time of each row in nanoseconds."""
    name = "time" if table == STEPS else f"{table}/time"
    if name not in episode:
        raise ArgumentError(
            f"episode '{episode.folder}' has no column '{name}', which the times of its log need"
        )
    seconds: NDArray[np.float64] = episode[name]
    return [round(time * 1e9) for time in seconds.tolist()]


def _is_plot(episode: Episode, name: str) -> bool:
    """Whether a column has few numbers in each row of a table that has times."""
    column = episode.column(name)
    if not column.table or np.dtype(column.dtype).kind not in "fiub":
        return False
    if column.table != STEPS and f"{column.table}/time" not in episode:
        return False
    return len(column.row_shape) < 2 and int(np.prod(column.row_shape)) <= LARGEST


def _topic_of(episode: Episode, name: str) -> Topic:
    column = episode.column(name)
    size = int(np.prod(column.row_shape))
    names = list(column.names)
    if len(names) != size or len(set(names)) != size:
        names = ["value"] if size == 1 else [f"value_{i}" for i in range(size)]
    units = [unit.strip() for unit in column.units.split(",")] if column.units else [""]
    if len(units) == 2 and size in (6, 7):
        units = [units[0]] * 3 + [units[1]] * (size - 3)
    if len(units) != size:
        units = units * size if len(units) == 1 else [column.units] * size
    values = tuple(column.values) if size == 1 else ()
    return Topic(
        f"/{name}",
        column.table,
        tuple(names),
        tuple(units),
        column.frame,
        column.description,
        values,
    )


def _number(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
