"""Writes each episode as a recording of Rerun: a log for people, which its viewer shows.

Columns are plots, frames are transforms in the world, cameras are streams of H.264; everything is
on the timeline `time`, which is that of the simulation.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import Episode
from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._episode_logs import write_logs
from robocell.export._events import events_of
from robocell.export._formats import Options, Written
from robocell.export._frames import frames_of
from robocell.export._h264 import h264
from robocell.export._images import depth_blocks
from robocell.export._mcap_columns import STEPS, Topic, json_topics, times_of
from robocell.export._mp4 import packets
from robocell.export._source import Camera, Item, Source

with needed_by("robocell.export", "rerun"):
    import rerun as rr

TIMELINE = "time"


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes episodes into a staging folder, `<id>.rrd` each.

    A killed export continues after the last complete episode.
    """
    resumed, encoded = write_logs(source, staging, "rrd", _write_episode, on_episode)
    notes = (
        "`<id>.rrd` is the log of an episode; the timeline `time` is that of the simulation.",
        "`/world` has the frames of robots, TCPs, objects and cameras; every column of the episode "
        "is a plot of its name.",
        "Rerun gives its files numbers of its own, so two exports differ in some bytes.",
    )
    return Written(resumed, encoded, {each.feature: "h264" for each in source.cameras}, notes)


def _write_episode(source: Source, item: Item, path: Path, scratch: Path) -> dict[str, str]:
    """Writes a file, and returns why videos were encoded again."""
    episode = source.episode(item)
    reasons: dict[str, str] = {}
    stream = rr.RecordingStream("robocell", recording_id=item.id)
    stream.save(str(path))
    stream.send_recording_name(item.id)
    stream.send_property("robocell", rr.AnyValues(**_properties(item)))
    for topic in json_topics(episode, source.resolved.features):
        _send_numbers(stream, episode, topic)
    for name, poses in frames_of(episode).items():
        there = np.isfinite(poses).all(axis=1)
        columns = rr.Transform3D.columns(translation=poses[there, :3], quaternion=poses[there, 3:])
        _send(stream, _entity("world", name), np.array(times_of(episode))[there], columns)
    for event in events_of(episode, item):
        level = rr.TextLogLevel.WARN if event.failed else rr.TextLogLevel.INFO
        stream.set_time(TIMELINE, duration=np.timedelta64(event.time, "ns"))
        stream.log("events", rr.TextLog(event.text, level=level))
    for camera in source.cameras:
        file, reason = h264(source, item, camera, scratch)
        if reason:
            reasons[camera.feature] = reason
        _send_video(stream, episode, camera, file)
        scratch.unlink(missing_ok=True)
    for camera in source.depths:
        _send_depth(stream, source, item, camera)
    stream.flush()
    stream.disconnect()
    return reasons


def _entity(*names: str) -> str:
    """Returns the path of an entity; spaces in names are part of them."""
    parts = [part for name in names for part in name.split("/")]
    path: str = rr.new_entity_path(parts)
    return path


def _send(stream: Any, entity: str, times: Any, columns: Any) -> None:
    spans = np.asarray(times, np.int64).astype("timedelta64[ns]")
    stream.send_columns(entity, [rr.TimeColumn(TIMELINE, duration=spans)], columns)


def _send_numbers(stream: Any, episode: Episode, topic: Topic) -> None:
    """Sends a column as a plot with a line for each component."""
    if topic.feature is not None:
        rows = topic.feature.read(episode)
    else:
        column = episode[topic.name[1:]]
        rows = column.reshape(len(column), -1)
    entity = _entity(topic.name[1:])
    stream.log(entity, rr.SeriesLines(names=list(topic.fields)), static=True)
    columns = rr.Scalars.columns(scalars=rows.astype(np.float64).ravel())
    times = times_of(episode, topic.table or STEPS)
    _send(stream, entity, times, columns.partition([rows.shape[1]] * len(rows)))


def _send_video(stream: Any, episode: Episode, camera: Camera, file: Path) -> None:
    entity = _entity(camera.feature)
    stream.log(entity, rr.VideoStream(codec=rr.VideoCodec.H264), static=True)
    columns = rr.VideoStream.columns(sample=list(packets(file)))
    _send(stream, entity, times_of(episode), columns)


def _send_depth(stream: Any, source: Source, item: Item, camera: Camera) -> None:
    times = times_of(source.episode(item))
    for first, block in depth_blocks(source, item, camera):
        for row, image in enumerate(block[..., 0], first):
            stream.set_time(TIMELINE, duration=np.timedelta64(times[row], "ns"))
            stream.log(_entity(f"{camera.feature}/depth"), rr.DepthImage(image, meter=1000.0))


def _properties(item: Item) -> dict[str, str]:
    return {
        "task": item.task,
        "robots": item.robots,
        "success": json.dumps(item.success),
        "end_reason": item.end_reason,
        "episode_json_sha256": item.digest,
    }
