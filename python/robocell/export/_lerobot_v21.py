"""Writes LeRobot datasets of the version 2.1, with the files that GR00T reads beside them.

Every episode has a Parquet file, and an MP4 file for each camera. A killed export continues after
the last complete episode.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._formats import Options, Written
from robocell.export._groot import HORIZON, RelativeActions, modality
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
CHUNK = 1000  # episodes in a folder
DATA_PATH = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
VIDEO_PATH = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"
OF_EPISODES = ("min", "max", "mean", "std", "count")  # version 2.1 knows no quantiles


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes a dataset into a staging folder; see `lerobot_v3.write`."""
    tasks = source.task_indices

    def write_part(number: int, items: Sequence[Item], before: int) -> dict[str, Any]:
        first = source.first_rows[before]
        return _write_episode(source, staging, options, number, first, tasks[items[0].task])

    parts = ([item] for item in source.items)
    count, resumed = write_parts(staging, parts, write_part, on_episode)
    relative = RelativeActions(source, options.action_horizon or HORIZON)
    written = collect(source, staging, _tables(staging, count, relative), count, resumed)
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
    if found := relative.result():
        write_json(staging.path("meta/relative_stats.json"), found)
    write_json(staging.path("meta/info.json"), info(source, written.codecs))
    return replace(written, notes=(*written.notes, *_notes(found, relative.horizon)))


def _notes(relative: dict[str, Any], horizon: int) -> list[str]:
    """Returns what the card says about GR00T's files."""
    notes = [
        "GR00T: `meta/modality.json` names the ranges of state and action, the cameras, and the "
        "instruction `annotation.human.task_description`."
    ]
    if relative:
        names = ", ".join(f"`{name}`" for name in relative)
        notes.append(
            f"`meta/relative_stats.json` has the statistics of {names} relative to the state, for "
            f"chunks of {horizon} actions: `delta_indices=list(range({horizon}))` of the action in "
            "GR00T's configuration."
        )
    return notes


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


def _tables(staging: Staging, count: int, relative: RelativeActions) -> Iterator[Any]:
    """Reads the rows again, one episode at a time, also for the statistics of relative actions."""
    for index in range(count):
        place = {"episode_chunk": index // CHUNK, "episode_index": index}
        table = pq.read_table(staging.path(DATA_PATH.format(**place)))
        relative.add(table)
        yield table
