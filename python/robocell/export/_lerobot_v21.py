"""Writes LeRobot datasets of the version 2.1, with the files that GR00T reads beside them.

Every episode has a Parquet file, and an MP4 file for each camera. A killed export continues after
the last complete episode.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._features import Feature
from robocell.export._formats import Options, Written
from robocell.export._lerobot_parts import (
    collect,
    common_info,
    part,
    write_json,
    write_lines,
    write_parts,
    write_video,
)
from robocell.export._lerobot_rows import columns_of, statistics_of, table_of
from robocell.export._source import Item, Source

with needed_by("robocell.export", "export"):
    import pyarrow.parquet as pq

VERSION = "v2.1"
STATE, ACTION = "observation.state", "action"  # GR00T reads these two
CHUNK = 1000  # episodes in a folder
DATA_PATH = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
VIDEO_PATH = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"
OF_EPISODES = ("min", "max", "mean", "std", "count")  # version 2.1 knows no quantiles


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes a dataset into a staging folder; see `lerobot_v3.write`."""
    tasks = {task: index for index, task in enumerate(source.tasks)}

    def write_part(number: int, items: Sequence[Item], before: int) -> dict[str, Any]:
        first = sum(item.rows for item in source.items[:before])
        return _write_episode(source, staging, options, number, first, tasks[items[0].task])

    parts = ([item] for item in source.items)
    count, resumed = write_parts(staging, parts, write_part, on_episode)
    written = collect(source, staging, _tables(staging, count), count, resumed)
    write_lines(
        staging.path("meta/tasks.jsonl"),
        ({"task_index": index, "task": task} for task, index in tasks.items()),
    )
    write_lines(
        staging.path("meta/episodes.jsonl"),
        (
            {"episode_index": index, "tasks": [item.task], "length": item.rows}
            for index, item in enumerate(source.items)
        ),
    )
    write_lines(
        staging.path("meta/episodes_stats.jsonl"),
        (
            {
                "episode_index": index,
                "stats": {
                    name: {key: each[key] for key in OF_EPISODES}
                    for name, each in part(staging, index)["statistics"].items()
                },
            }
            for index in range(len(source.items))
        ),
    )
    write_json(staging.path("meta/stats.json"), written.statistics)
    write_json(staging.path("meta/modality.json"), modality(source))
    write_json(staging.path("meta/info.json"), info(source, written.codecs))
    return written


def info(source: Source, codecs: dict[str, str]) -> dict[str, Any]:
    """Returns the content of meta/info.json."""
    episodes = len(source.items)
    return common_info(source, VERSION, codecs) | {
        "total_videos": episodes * len(source.cameras),
        "total_chunks": -(-episodes // CHUNK),
        "chunks_size": CHUNK,
        "data_path": DATA_PATH,
        "video_path": VIDEO_PATH if source.cameras else None,
    }


def modality(source: Source) -> dict[str, Any]:
    """Returns the content of GR00T's meta/modality.json.

    The ranges of state and action follow each other and cover the whole vectors.
    """
    features = {feature.name: feature for feature in source.resolved.features}
    several = len(source.resolved.robots) > 1
    return {
        "state": _ranges(features.get(STATE), several),
        "action": _ranges(features.get(ACTION), several),
        "video": {
            camera.feature.removeprefix("observation.images."): {"original_key": camera.feature}
            for camera in source.cameras
        },
        "annotation": {"human.task_description": {"original_key": "task_index"}},
    }


def _ranges(feature: Feature | None, several_robots: bool) -> dict[str, dict[str, int]]:
    """Returns the range of each column in a feature, under a short name."""
    ranges: dict[str, dict[str, int]] = {}
    if feature is None:
        return ranges
    for index, source in enumerate(feature.sources):
        name = _short(source, several_robots)
        if name in ranges and feature.sources[index - 1] != source:
            name = source.replace("/", "_")  # two columns with the same short name
        if name in ranges:
            ranges[name]["end"] = index + 1
        else:
            ranges[name] = {"start": index, "end": index + 1}
    return ranges


def _short(column: str, several_robots: bool) -> str:
    """Returns "arm" for robots/rc7/arm/qpos and robots/rc7/action/arm, "gripper" for an opening."""
    parts = column.split("/")
    name = parts[-1]
    if name == "opening":
        name = "gripper"
    elif name == "qpos" and len(parts) > 2:
        name = parts[-2]
    return f"{parts[1]}_{name}" if several_robots and parts[0] == "robots" else name


def _write_episode(
    source: Source, staging: Staging, options: Options, index: int, first: int, task: int
) -> dict[str, Any]:
    """Writes the files of an episode, and returns what the tables of episodes need."""
    item = source.items[index]
    columns = columns_of(source, item, index, first, task)
    place = {"episode_chunk": index // CHUNK, "episode_index": index}
    path = staging.path(DATA_PATH.format(**place))
    pq.write_table(table_of(source, columns), path, compression="snappy")
    statistics = {name: statistics_of(values) for name, values in columns.items()}
    videos = {}
    for camera in source.cameras:
        path = staging.path(VIDEO_PATH.format(video_key=camera.feature, **place))
        videos[camera.feature], each = write_video(source, [item], camera, path, options)
        [statistics[camera.feature]] = each
    return {"statistics": statistics, "videos": videos}


def _tables(staging: Staging, count: int) -> Iterator[Any]:
    """Reads the rows again, one episode at a time."""
    for index in range(count):
        place = {"episode_chunk": index // CHUNK, "episode_index": index}
        yield pq.read_table(staging.path(DATA_PATH.format(**place)))
