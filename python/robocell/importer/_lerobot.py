"""Reads LeRobot datasets of the versions 2.0, 2.1 and 3.0."""

from __future__ import annotations

import json
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import ArgumentError, IoError
from robocell._extras import needed_by
from robocell.importer._recording import Clip, Column, Recording, Stills

with needed_by("robocell.importer", "export"):
    import pyarrow as pa
    import pyarrow.parquet as pq

INFO = "meta/info.json"
VERSIONS = ("v2.0", "v2.1", "v3.0")
# Counted by LeRobot itself; `time` takes the place of the timestamps.
COUNTERS = ("timestamp", "frame_index", "episode_index", "index", "task_index")
RESULTS = {"next.reward": "reward", "next.done": "terminated", "next.success": "success"}


class LeRobot:
    """A LeRobot dataset; see `recording.Origin`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._info = _json(folder / INFO)
        try:
            self.version = self._info["codebase_version"]
            self.rate: Fraction | None = Fraction(str(self._info["fps"]))
            self._features: dict[str, Any] = self._info["features"]
        except (KeyError, ValueError) as error:
            raise IoError(f"'{folder / INFO}' is damaged: {error}") from error
        if self.version not in VERSIONS:
            raise ArgumentError(
                f"'{folder}' is a LeRobot dataset of version {self.version}; versions that can be "
                f"imported: {', '.join(VERSIONS)}"
            )
        self.title = f"LeRobot {self.version}"
        self.robots = str(self._info.get("robot_type") or "")
        self._episodes = self._in_tables() if self.version == "v3.0" else self._in_lines()

    def __len__(self) -> int:
        return len(self._episodes)

    def read(self, index: int) -> Recording:
        """Reads an episode."""
        episode = self._episodes[index]
        number = int(episode["episode_index"])
        table = self._rows(episode)
        columns: dict[str, Column] = {}
        images: dict[str, Clip | Stills] = {}
        for name, feature in self._features.items():
            kind = feature["dtype"]
            if kind == "video":
                images[name] = self._clip(episode, name)
            elif kind == "image":
                images[name] = Stills(self._stills(table, name))
            elif kind != "string" and name not in COUNTERS and name in table.column_names:
                values = np.array(table[name].to_pylist(), feature["dtype"])
                columns[name] = Column(values, _names(feature))
        tasks = episode.get("tasks") or [""]
        return Recording(str(tasks[0]), len(table), columns, images, {"episode": number})

    def column_name(self, name: str) -> str | None:
        """Returns "observation/state" for observation.state."""
        return RESULTS.get(name, name.replace(".", "/"))

    def _in_lines(self) -> list[dict[str, Any]]:
        path = self.folder / "meta/episodes.jsonl"
        try:
            return [json.loads(line) for line in path.read_text().splitlines() if line.strip()]
        except (OSError, ValueError) as error:
            raise IoError(f"cannot read '{path}': {error}") from error

    def _in_tables(self) -> list[dict[str, Any]]:
        """Returns the rows of every file of meta/episodes, without their statistics."""
        rows: list[dict[str, Any]] = []
        for file in sorted((self.folder / "meta/episodes").rglob("*.parquet")):
            wanted = [name for name in pq.read_schema(file).names if not name.startswith("stats/")]
            rows += pq.read_table(file, columns=wanted).to_pylist()
        return sorted(rows, key=lambda row: int(row["episode_index"]))

    def _place(self, episode: dict[str, Any], prefix: str) -> dict[str, int]:
        number = int(episode["episode_index"])
        if self.version != "v3.0":
            return {
                "episode_chunk": number // int(self._info["chunks_size"]),
                "episode_index": number,
            }
        return {name: int(episode[f"{prefix}/{name}"]) for name in ("chunk_index", "file_index")}

    def _rows(self, episode: dict[str, Any]) -> Any:
        file = self.folder / self._info["data_path"].format(**self._place(episode, "data"))
        try:
            table = pq.read_table(file)
        except (OSError, pa.ArrowInvalid) as error:
            raise IoError(f"cannot read '{file}': {error}") from error
        return table.filter(pa.compute.equal(table["episode_index"], episode["episode_index"]))

    def _clip(self, episode: dict[str, Any], name: str) -> Clip:
        start = f"videos/{name}"
        place = self._place(episode, start)
        file = self.folder / self._info["video_path"].format(video_key=name, **place)
        assert self.rate is not None
        first = round(float(episode.get(f"{start}/from_timestamp", 0)) * float(self.rate))
        return Clip(file, first, self.rate)

    def _stills(self, table: Any, name: str) -> Iterator[bytes]:
        """Yields the files of images, which are in the table or beside it."""
        for image in table[name].to_pylist():
            yield image["bytes"] or (self.folder / image["path"]).read_bytes()


def _names(feature: dict[str, Any]) -> tuple[str, ...]:
    """Returns the names of the components: a list, or {"motors": [...]}."""
    names = feature.get("names")
    if isinstance(names, dict) and len(names) == 1:
        [names] = names.values()
    return tuple(map(str, names)) if isinstance(names, list) else ()


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise IoError(f"cannot read '{path}': {error}") from error
