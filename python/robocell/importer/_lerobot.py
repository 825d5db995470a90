"""Reads LeRobot datasets of the versions 2.0, 2.1 and 3.0."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, IoError
from robocell._extras import needed_by
from robocell.importer._entries import Entries, is_text, rate_of
from robocell.importer._foreign_files import (
    ADVICE,
    confined,
    filled,
    fingerprint,
    parsed,
    parsed_lines,
    reading,
)
from robocell.importer._recording import Clip, Column, Recording, Stills
from robocell.importer._table_columns import numbers_of

with needed_by("robocell.importer", "export"):
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

INFO = "meta/info.json"
VERSIONS = ("v2.0", "v2.1", "v3.0")
NUMBER, COUNTER = "episode_index", "frame_index"
# Counted by LeRobot itself; `time` takes the place of the timestamps.
COUNTERS = ("timestamp", COUNTER, NUMBER, "index", "task_index")
RESULTS = {"next.reward": "reward", "next.done": "terminated", "next.success": "success"}


class LeRobot:
    """A LeRobot dataset; see `recording.Origin`."""

    gaps = ""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.fingerprint = fingerprint(folder)
        self._info = info = Entries(parsed(confined(folder, INFO, f"'{folder}'")), self._at(INFO))
        self.version = info.text("codebase_version")
        if self.version not in VERSIONS:
            raise ArgumentError(
                f"'{folder}' is a LeRobot dataset of version {self.version}; versions that can be "
                f"imported: {', '.join(VERSIONS)}"
            )
        self._is_v3 = self.version == "v3.0"
        self._fps = rate_of(info.content.get("fps"), f"{info.place}: 'fps'")
        self.rate: Fraction | None = self._fps
        features = info.table("features")
        self._features = {name: features.table(name) for name in features.content}
        self.title = f"LeRobot {self.version}"
        self.robots = info.text("robot_type", "")
        self._episodes = self._in_tables() if self._is_v3 else self._in_lines()
        self._require_all()

    def __len__(self) -> int:
        return len(self._episodes)

    def read(self, index: int) -> Recording:
        """Reads an episode."""
        episode = self._episodes[index]
        table, place = self._rows(episode)
        columns: dict[str, Callable[[], Column]] = {}
        images: dict[str, Clip | Stills] = {}
        for name, feature in self._features.items():
            kind = feature.text("dtype")
            if kind == "video":
                images[name] = self._clip(episode, name)
            elif kind == "image":
                images[name] = Stills(self._stills(table, name, place))
            elif kind != "string" and name not in COUNTERS:
                columns[name] = partial(_column, table, name, feature, place)
        tasks = episode.texts("tasks") or [""]
        metadata = {"episode": episode.whole(NUMBER)}
        return Recording(tasks[0], len(table), columns, images, metadata)

    def column_name(self, name: str) -> str | None:
        """Returns "observation/state" for observation.state."""
        return RESULTS.get(name, name.replace(".", "/"))

    def _at(self, relative: str) -> str:
        return f"'{self.folder / relative}'"

    def _in_lines(self) -> list[Entries]:
        path = confined(self.folder, "meta/episodes.jsonl", f"'{self.folder}'")
        lines = enumerate(parsed_lines(path), 1)
        return [Entries(line, f"'{path}' episode {number}") for number, line in lines]

    def _in_tables(self) -> list[Entries]:
        """Returns the rows of every file of meta/episodes, without their statistics."""
        episodes: list[Entries] = []
        for file in sorted((self.folder / "meta/episodes").rglob("*.parquet")):
            with reading(file):
                names = pq.read_schema(file).names
                wanted = [name for name in names if not name.startswith("stats/")]
                rows = pq.read_table(file, columns=wanted, partitioning=None).to_pylist()
            episodes += [Entries(row, f"'{file}' row {at}") for at, row in enumerate(rows)]
        return sorted(episodes, key=lambda episode: episode.whole(NUMBER))

    def _require_all(self) -> None:
        """Raises IoError if an episode is listed twice, or not as many as there are."""
        seen: set[int] = set()
        for episode in self._episodes:
            number = episode.whole(NUMBER)
            if number in seen:
                raise IoError(f"{episode.place}: episode {number} is listed twice: {ADVICE}")
            seen.add(number)
        total = "total_episodes"
        if total in self._info and self._info.whole(total) != len(seen):
            raise self._info.wrong(total, f"{len(seen)}, as many as are listed")

    def _file(self, template: str, episode: Entries, place: str, key: str | None = None) -> Path:
        """Returns a file of an episode; `place` begins its numbers in version 3.0."""
        values: dict[str, int | str] = {} if key is None else {"video_key": key}
        if self._is_v3:
            for name in ("chunk_index", "file_index"):
                values[name] = episode.whole(f"{place}/{name}")
        else:
            number = episode.whole(NUMBER)
            values["episode_chunk"] = number // self._info.whole("chunks_size", least=1)
            values[NUMBER] = number
        what = f"{self._info.place}: '{template}'"
        return confined(self.folder, filled(self._info.text(template), values, what), what)

    def _rows(self, episode: Entries) -> tuple[Any, str]:
        """Returns the rows of an episode, and where they are."""
        file = self._file("data_path", episode, "data")
        number = episode.whole(NUMBER)
        place = f"'{file}' episode {number}"
        with reading(file):
            names = set(pq.read_schema(file).names)
            wanted = [NUMBER, *sorted(names & {*self._features, COUNTER} - {NUMBER})]
            is_own = pc.field(NUMBER) == number
            table = pq.read_table(file, columns=wanted, filters=is_own, partitioning=None)
        if "length" in episode and episode.whole("length") != len(table):
            raise episode.wrong("length", f"{len(table)}, the rows of {place}")
        if COUNTER in names and table[COUNTER].to_pylist() != list(range(len(table))):
            raise IoError(
                f"{place}: '{COUNTER}' does not count the rows from 0 on, so they may not be those "
                f"of the images: {ADVICE}"
            )
        return table, place

    def _clip(self, episode: Entries, name: str) -> Clip:
        start = f"videos/{name}"
        file = self._file("video_path", episode, start, name)
        first = round(episode.number(f"{start}/from_timestamp", 0) * float(self._fps))
        return Clip(file, first, self._fps)

    def _stills(self, table: Any, name: str, place: str) -> Iterator[bytes]:
        """Yields the files of images, which are in the table or beside it."""
        _require_column(table, name, place)
        for row, scalar in enumerate(table[name]):
            what = f"{place}: '{name}' row {row}"
            with reading(what):
                image = scalar.as_py()
            yield self._still(image if isinstance(image, dict) else {}, what)

    def _still(self, image: dict[str, Any], what: str) -> bytes:
        content, path = image.get("bytes"), image.get("path")
        if isinstance(content, bytes) and content:
            return content
        if not isinstance(path, str) or not is_text(path):
            raise IoError(f"{what} has neither bytes nor the path of an image: {ADVICE}")
        file = confined(self.folder, path, what)
        with reading(file):
            return file.read_bytes()


def _column(table: Any, name: str, feature: Entries, place: str) -> Column:
    _require_column(table, name, place)
    values = numbers_of(table[name], feature, f"{place}: '{name}'")
    return Column(values, _names(feature))


def _require_column(table: Any, name: str, place: str) -> None:
    if name not in table.column_names:
        raise IoError(
            f"{place} has no column '{name}', which {INFO} lists: {ADVICE}. A mapping file leaves "
            "it out: --mapping FILE"
        )


def _names(feature: Entries) -> tuple[str, ...]:
    """Returns the names of the components: a list, or {"motors": [...]}."""
    names = feature.content.get("names")
    if isinstance(names, dict) and len(names) == 1:
        [names] = names.values()
    return tuple(names) if isinstance(names, list) and all(map(is_text, names)) else ()
