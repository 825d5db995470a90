"""Shards of LeRobot datasets of version 3.0, made of files of single episodes.

Every episode is written to files of its own first, outside of the result. So a killed export loses
one episode at most, and shards are as large as the files really are: videos that are encoded again
have another size than those of the episodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export import _lerobot_v3 as v3
from robocell.export._formats import Options
from robocell.export._lerobot_parts import part, write_parts
from robocell.export._lerobot_rows import schema
from robocell.export._mp4 import Mp4
from robocell.export._source import Item, Source
from robocell.export._videos import join, reason_to_encode, require_frames

with needed_by("robocell.export", "export"):
    import pyarrow.parquet as pq

SINGLE = "single"  # the parts with one episode
MB = 1 << 20


def write_packed(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> tuple[int, int]:
    """Writes files of single episodes, and shards of them.

    Returns:
        The number of shards, and of episodes that an earlier export had written.
    """

    def scratch(name: str) -> Path:
        path = staging.scratch(f"{SINGLE}/{name}")
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def write_single(number: int, items: Sequence[Item], before: int) -> dict[str, Any]:
        return v3.write_shard(source, scratch, options, number, items, before)

    def write_shard(number: int, items: Sequence[Item], before: int) -> dict[str, Any]:
        return _pack(source, staging, scratch, number, items, before)

    singles = ([item] for item in source.items)
    _, resumed = write_parts(staging, singles, write_single, on_episode, SINGLE)
    shards = _shards(source, scratch)
    count, _ = write_parts(staging, shards, write_shard, lambda _: None)
    return count, resumed


def _shards(source: Source, scratch: Callable[[str], Path]) -> Iterator[list[Item]]:
    """Yields the episodes of each shard: as many as its files have space for."""
    shard: list[Item] = []
    sizes: dict[str, int] = {}
    for number, item in enumerate(source.items):
        own = {name: path.stat().st_size for name, path in _files(source, scratch, number).items()}
        whole = {name: sizes.get(name, 0) + size for name, size in own.items()}
        if shard and any(size > _limit(name) for name, size in whole.items()):
            yield shard
            shard, whole = [], own
        shard.append(item)
        sizes = whole
    yield shard


def _limit(name: str) -> int:
    return (v3.VIDEO_MB if name else v3.DATA_MB) * MB


def _files(source: Source, path_of: Callable[[str], Path], number: int) -> dict[str, Path]:
    """Returns the files of a part: "" is the Parquet file, the others are videos by feature."""
    place = v3.place_of(number)
    files = {"": path_of(v3.DATA_PATH.format(**place))}
    for camera in source.cameras:
        name = v3.VIDEO_PATH.format(video_key=camera.feature, **place)
        files[camera.feature] = path_of(name)
    return files


def _pack(
    source: Source,
    staging: Staging,
    scratch: Callable[[str], Path],
    number: int,
    items: Sequence[Item],
    before: int,
) -> dict[str, Any]:
    """Writes a shard; returns what the tables of episodes need, as `_lerobot_v3.write_shard`."""
    numbers = range(before, before + len(items))
    parts = [part(staging, each, SINGLE) for each in numbers]
    singles = [_files(source, scratch, each) for each in numbers]
    files = _files(source, staging.path, number)
    with pq.ParquetWriter(files[""], schema(source), compression="snappy") as writer:
        for single, item in zip(singles, items, strict=True):
            writer.write_table(pq.read_table(single[""]), row_group_size=item.rows)
    rows = [row for each in parts for row in each["rows"]]
    place = v3.place_of(number)
    for row in rows:
        row.update({f"data/{name}": index for name, index in place.items()})
    videos: dict[str, dict[str, Any]] = {}
    for camera in source.cameras:
        name = camera.feature
        own = [single[name] for single in singles]
        # Episodes that were copied from different encoders do not fit into one file.
        reason = reason_to_encode([Mp4.read(path) for path in own])
        joined = join(own, files[name], source.fps, bool(reason))
        require_frames(files[name], joined, sum(item.rows for item in items))
        facts = [each["videos"][name] for each in parts]
        encoded = next((each["encoded"] for each in facts if each["encoded"]), "")
        videos[name] = {
            "codec": joined.codec,
            "encoded": reason or encoded,
            "images": sum(each["images"] for each in facts),
            "histogram": _sum([each["histogram"] for each in facts]),
        }
        frames = 0
        for row, item in zip(rows, items, strict=True):
            start = f"videos/{name}"
            row.update({f"{start}/{key}": index for key, index in place.items()})
            row[f"{start}/from_timestamp"] = frames / source.fps
            row[f"{start}/to_timestamp"] = (frames + item.rows) / source.fps
            frames += item.rows
    return {"rows": rows, "videos": videos}


def _sum(histograms: Sequence[Sequence[Sequence[int]]]) -> list[list[int]]:
    return [
        [sum(counts) for counts in zip(*channels, strict=True)]
        for channels in zip(*histograms, strict=True)
    ]
