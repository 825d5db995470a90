"""Writes LeRobot datasets of the version 3.0.

Episodes go into shards: a Parquet file with one row group per episode, and one MP4 file per camera.
A shard is closed before the next begins, and a killed export continues after the last closed one.
`lerobot_pack` makes shards of such files of single episodes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._formats import Options, Written
from robocell.export._lerobot_parts import (
    collect,
    common_info,
    part,
    write_json,
    write_parts,
    write_video,
)
from robocell.export._lerobot_rows import OWN, columns_of, schema, statistics_of, table_of
from robocell.export._source import Item, Source

with needed_by("robocell.export", "export"):
    import pyarrow as pa
    import pyarrow.parquet as pq

VERSION = "v3.0"
CHUNK = 1000  # files in a folder
SUBTASK = "subtask_index"  # the feature whose names LeRobot reads
DATA_MB, VIDEO_MB = 100, 200  # a file does not grow beyond, unless one episode is larger
ROW_BYTES = 4  # of a number in a data file, at most nearly
DATA_PATH = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEO_PATH = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
EPISODES_PATH = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes a dataset into a staging folder.

    Args:
        source: What is exported.
        staging: Where.
        options: How.
        on_episode: Is called with the number of episodes that are written.
    """

    def write_part(number: int, items: Sequence[Item], before: int) -> dict[str, Any]:
        return write_shard(source, staging.path, options, number, items, before)

    if options.pack:
        from robocell.export._lerobot_pack import write_packed

        count, resumed = write_packed(source, staging, options, on_episode)
    else:
        count, resumed = write_parts(staging, shards(source), write_part, on_episode)
    written = collect(source, staging, _tables(staging, count), count, resumed)
    _write_names(staging.path("meta/tasks.parquet"), "task", source.tasks)
    for feature in source.resolved.features:
        if feature.name == SUBTASK and feature.values:
            _write_names(staging.path("meta/subtasks.parquet"), "subtask", feature.values)
    _write_episodes(staging, count)
    write_json(staging.path("meta/stats.json"), written.statistics)
    write_json(staging.path("meta/info.json"), info(source, written.codecs))
    return written


def shards(source: Source) -> Iterator[list[Item]]:
    """Yields the episodes of each pair of data and video files."""
    numbers = sum(feature.size for feature in source.resolved.features) + len(OWN)
    shard: list[Item] = []
    video = data = 0
    for item in source.items:
        own = item.rows * numbers * ROW_BYTES
        if shard and (video + item.video_bytes > VIDEO_MB << 20 or data + own > DATA_MB << 20):
            yield shard
            shard, video, data = [], 0, 0
        shard.append(item)
        video, data = video + item.video_bytes, data + own
    yield shard


def info(source: Source, codecs: dict[str, str]) -> dict[str, Any]:
    """Returns the content of meta/info.json."""
    return common_info(source, VERSION, codecs) | {
        "chunks_size": CHUNK,
        "data_files_size_in_mb": DATA_MB,
        "video_files_size_in_mb": VIDEO_MB,
        "data_path": DATA_PATH,
        "video_path": VIDEO_PATH if source.cameras else None,
    }


def place_of(number: int) -> dict[str, int]:
    """Returns the indices of a file of a shard."""
    return {"chunk_index": number // CHUNK, "file_index": number % CHUNK}


def write_shard(
    source: Source,
    path_of: Callable[[str], Path],
    options: Options,
    number: int,
    items: Sequence[Item],
    before: int,
) -> dict[str, Any]:
    """Writes the files of a shard, and returns what the tables of episodes need.

    Args:
        source: What is exported.
        path_of: Returns the path of a file of the dataset.
        options: How.
        number: Number of the shard.
        items: Its episodes.
        before: Number of episodes before them.
    """
    place = place_of(number)
    rows: list[dict[str, Any]] = []
    at = source.first_rows[before]
    with pq.ParquetWriter(
        path_of(DATA_PATH.format(**place)), schema(source), compression="snappy"
    ) as writer:
        for index, item in enumerate(items, before):
            columns = columns_of(source, item, index, at, source.task_indices[item.task])
            writer.write_table(table_of(source, columns), row_group_size=item.rows)
            rows.append(
                {
                    "episode_index": index,
                    "tasks": [item.task],
                    "length": item.rows,
                    "data/chunk_index": place["chunk_index"],
                    "data/file_index": place["file_index"],
                    "dataset_from_index": at,
                    "dataset_to_index": at + item.rows,
                    "statistics": {name: statistics_of(value) for name, value in columns.items()},
                }
            )
            at += item.rows
    videos = {}
    for camera in source.cameras:
        path = path_of(VIDEO_PATH.format(video_key=camera.feature, **place))
        videos[camera.feature], each = write_video(source, items, camera, path, options)
        frames = 0
        for row, item, statistics in zip(rows, items, each, strict=True):
            start = f"videos/{camera.feature}"
            row[f"{start}/chunk_index"] = place["chunk_index"]
            row[f"{start}/file_index"] = place["file_index"]
            row[f"{start}/from_timestamp"] = frames / source.fps
            row[f"{start}/to_timestamp"] = (frames + item.rows) / source.fps
            row["statistics"][camera.feature] = statistics
            frames += item.rows
    return {"rows": rows, "videos": videos}


def _tables(staging: Staging, count: int) -> Iterator[Any]:
    """Reads the rows again, one episode at a time."""
    for number in range(count):
        with pq.ParquetFile(staging.path(DATA_PATH.format(**place_of(number)))) as file:
            for group in range(file.num_row_groups):
                yield file.read_row_group(group)


def _write_episodes(staging: Staging, count: int) -> None:
    """Writes meta/episodes, one row per episode and one row group per shard."""
    place = {"chunk_index": 0, "file_index": 0}
    writer: Any = None
    try:
        for number in range(count):
            rows = part(staging, number)["rows"]
            table = pa.Table.from_pylist([_episode_row(row, place) for row in rows])
            if writer is None:
                path = staging.path(EPISODES_PATH.format(**place))
                writer = pq.ParquetWriter(path, table.schema, compression="snappy")
            writer.write_table(table.cast(writer.schema))
    finally:
        if writer is not None:
            writer.close()


def _episode_row(row: dict[str, Any], place: dict[str, int]) -> dict[str, Any]:
    statistics = row.pop("statistics")
    flat = {
        f"stats/{feature}/{name}": value
        for feature, each in statistics.items()
        for name, value in each.items()
    }
    own = {f"meta/episodes/{name}": index for name, index in place.items()}
    return row | flat | own


def _write_names(path: Path, what: str, names: Sequence[str]) -> None:
    """Writes names as a table that pandas reads with them as its index, as LeRobot expects."""

    def column(name: str, kind: str, numpy_kind: str) -> dict[str, Any]:
        return {
            "name": name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": numpy_kind,
            "metadata": None,
        }

    described = {
        "index_columns": [what],
        "column_indexes": [
            {
                "name": None,
                "field_name": None,
                "pandas_type": "unicode",
                "numpy_type": "object",
                "metadata": {"encoding": "UTF-8"},
            }
        ],
        "columns": [
            column(f"{what}_index", "int64", "int64"),
            column(what, "unicode", "object"),
        ],
        "attributes": {},
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": "2.0.0",
    }
    numbers = pa.array(range(len(names)), pa.int64())
    table = pa.table({f"{what}_index": numbers, what: list(names)})
    pq.write_table(table.replace_schema_metadata({"pandas": json.dumps(described)}), path)
