"""What the versions of LeRobot datasets have in common: parts, videos, statistics, JSON files.

A part is written as a whole: the files of one episode in version 2.1, those of several in 3.0. What
the tables need of it is kept in the staging folder, so a killed export continues after it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol

from robocell._staging import Staging
from robocell.export._formats import Options, Written
from robocell.export._lerobot_rows import (
    OWN,
    features_of,
    image_statistics,
    numbers_of,
)
from robocell.export._mp4 import Mp4
from robocell.export._source import Camera, Item, Source
from robocell.export._statistics import Images, Statistics, Vectors
from robocell.export._videos import join, reason_to_encode, require_frames

PART = "part"


class WritesPart(Protocol):
    """Writes the files of a part, and returns what the tables need of it."""

    def __call__(self, number: int, items: Sequence[Item], before: int) -> dict[str, Any]:
        """Writes part `number`, whose first episode has `before` episodes before it."""


def write_parts(
    staging: Staging,
    parts: Iterable[Sequence[Item]],
    write: WritesPart,
    on_episode: Callable[[int], None],
    kind: str = PART,
) -> tuple[int, int]:
    """Writes the parts that are missing.

    Args:
        staging: Where.
        parts: The episodes of each part.
        write: Writes one.
        on_episode: Is called with the number of episodes that are written.
        kind: Name of these parts, where an export has several kinds.

    Returns:
        The number of parts, and of episodes that were there.
    """
    done = resumed = count = 0
    for number, items in enumerate(parts):
        if staging.state(_name(number, kind)) is None:
            staging.keep(_name(number, kind), write(number, items, done))
        else:
            resumed += len(items)
        done += len(items)
        count += 1
        on_episode(done)
    return count, resumed


def part(staging: Staging, number: int, kind: str = PART) -> dict[str, Any]:
    """Returns what the writer of a part returned."""
    kept: dict[str, Any] = staging.state(_name(number, kind))
    return kept


def _name(number: int, kind: str) -> str:
    return f"{kind}-{number}"


def write_video(
    source: Source, items: Sequence[Item], camera: Camera, path: Path, options: Options
) -> tuple[dict[str, Any], list[Statistics]]:
    """Writes the video of some episodes.

    Returns:
        What `collect` needs to know about it, and the statistics of each episode.
    """
    files = [source.video(item, camera) for item in items]
    facts = [Mp4.read(file) for file in files]
    size = source.resized(camera)
    reason = reason_to_encode(facts, options.keyframe_interval, size)
    joined = join(files, path, source.fps, bool(reason), options.keyframe_interval, size)
    require_frames(path, joined, sum(item.rows for item in items))
    each, whole = image_statistics(path, joined, [item.rows for item in items])
    return {
        "codec": joined.codec,
        "encoded": source.encoded_for(reason),
        "images": whole.images,
        "histogram": whole.histogram.tolist(),
    }, each


def collect(
    source: Source, staging: Staging, tables: Iterator[Any], count: int, resumed: int
) -> Written:
    """Returns the statistics of all parts.

    Args:
        source: What is exported.
        staging: Where the parts are.
        tables: The rows again, one episode at a time.
        count: Number of parts.
        resumed: Number of episodes that an earlier export had written.
    """
    totals = {each.name: Vectors(each.size) for each in source.resolved.features}
    totals |= {name: Vectors(1) for name in OWN}
    for table in tables:
        for name, vectors in totals.items():
            vectors.add(numbers_of(table.column(name)))
    images = {camera.feature: Images() for camera in source.cameras}
    encoded: dict[str, str] = {}
    codecs: dict[str, str] = {}
    for number in range(count):
        for name, video in part(staging, number)["videos"].items():
            images[name].merge(video["images"], video["histogram"])
            codecs[name] = video["codec"]
            if video["encoded"]:
                encoded[name] = video["encoded"]
    statistics: dict[str, Statistics] = {name: each.result() for name, each in images.items()}
    statistics |= {name: each.result() for name, each in totals.items()}
    return Written(resumed, encoded, codecs, statistics=statistics)


def common_info(source: Source, version: str, codecs: dict[str, str]) -> dict[str, Any]:
    """Returns the fields of meta/info.json that both versions have."""
    return {
        "codebase_version": version,
        "robot_type": source.robot_type,
        "total_episodes": len(source.items),
        "total_frames": source.rows,
        "total_tasks": len(source.tasks),
        "fps": source.fps,
        "splits": {"train": f"0:{len(source.items)}"},
        "features": features_of(source, codecs),
    }


def write_lines(path: Path, lines: Iterable[Any]) -> None:
    """Writes JSON values, one per line."""
    with path.open("w") as file:
        for line in lines:
            print(json.dumps(line, ensure_ascii=False), file=file)


def write_json(path: Path, content: Any) -> None:
    """Writes a JSON file, indented."""
    path.write_text(json.dumps(content, indent=4, ensure_ascii=False) + "\n")
