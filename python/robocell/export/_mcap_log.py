"""Writes each episode as an MCAP file: a log for people, which Foxglove and similar programs show.

Joints, poses, cameras, calibrations and events have the schemas of Foxglove, so its panels show
them without settings. Every column is a topic of its name beside, as JSON. Times are simulated.
"""

from __future__ import annotations

import heapq
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from robocell import __version__
from robocell._core import Episode
from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._episode_logs import write_logs
from robocell.export._formats import Options, Written
from robocell.export._h264 import h264
from robocell.export._images import depth_blocks
from robocell.export._mcap_columns import Topic, json_topics
from robocell.export._mp4 import packets
from robocell.export._source import Item, Source

with needed_by("robocell.export", "mcap"):
    from mcap.writer import Writer
    from mcap_protobuf.schema import register_schema

    from robocell.export._foxglove import (
        calibration,
        depth,
        events,
        joint_states,
        poses,
        transforms,
        video,
    )

Message = tuple[int, str, Any]  # nanoseconds, topic, content
CHUNK_BYTES = 1 << 20


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes episodes into a staging folder, `<id>.mcap` each.

    A killed export continues after the last complete episode.
    """
    resumed, encoded = write_logs(source, staging, "mcap", _write_episode, on_episode)
    notes = (
        "`<id>.mcap` is the log of an episode; its times are simulated and begin with 0.",
        "`/joint_states`, `/tf`, `/events`, poses and cameras have the schemas of Foxglove; every "
        "column of the episode is a topic of its name, as JSON.",
        "Topics below `/control` have the rate of the controller.",
        *(
            ["Depth is `foxglove.RawImage`, 16UC1: millimetres, 0 for no hit."]
            if source.depths
            else []
        ),
    )
    return Written(resumed, encoded, {each.feature: "h264" for each in source.cameras}, notes)


def _write_episode(source: Source, item: Item, path: Path, scratch: Path) -> dict[str, str]:
    """Writes a file, and returns why videos were encoded again."""
    episode = source.episode(item)
    reasons: dict[str, str] = {}
    streams: list[Iterator[Message]] = [
        events(episode, item),
        joint_states(episode),
        transforms(episode),
        poses(episode),
    ]
    videos = []
    for number, camera in enumerate(source.cameras):
        own = scratch.with_name(f"{number}-{scratch.name}")
        file, reason = h264(source, item, camera, own)
        if reason:
            reasons[camera.feature] = reason
        streams.append(calibration(episode, camera, source.shape_of(camera)))
        streams.append(video(episode, camera, packets(file)))
        videos.append(own)
    for camera in source.depths:
        streams.append(depth(episode, camera, depth_blocks(source, item, camera)))
    topics = json_topics(episode, source.resolved.features)
    streams += [topic.messages(episode) for topic in topics]
    with path.open("wb") as file_object:
        writer = Writer(file_object, chunk_size=CHUNK_BYTES)
        writer.start(library=f"robocell {__version__}")
        writer.add_metadata("robocell", _metadata(episode, item))
        channels = _Channels(writer, {topic.name: topic for topic in topics})
        # Files are read from one end to the other, so messages are in the order of their times.
        for time, topic, content in heapq.merge(*streams, key=lambda message: message[0]):
            channels.write(time, topic, content)
        writer.finish()
    for own in videos:
        own.unlink(missing_ok=True)
    return reasons


def _metadata(episode: Episode, item: Item) -> dict[str, str]:
    """Returns what a viewer shows beside the topics: texts."""
    known: Any = episode.metadata if isinstance(episode.metadata, dict) else {}
    own = {
        "id": item.id,
        "task": item.task,
        "robots": item.robots,
        "success": json.dumps(item.success),
        "end_reason": item.end_reason,
        "episode_json_sha256": item.digest,
    }
    return own | {
        name: json.dumps(known[name])
        for name in ("run", "seed", "scene", "episode")
        if name in known
    }


class _Channels:
    """Writes messages, and describes each topic before its first."""

    def __init__(self, writer: Any, topics: dict[str, Topic]) -> None:
        self._writer = writer
        self._topics = topics
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._sequence: dict[str, int] = {}

    def write(self, time: int, topic: str, content: Any) -> None:
        """Writes a message of Foxglove's, or bytes of JSON."""
        if topic not in self._channels:
            self._channels[topic] = self._register(topic, content)
            self._sequence[topic] = 0
        data = content if isinstance(content, bytes) else content.SerializeToString()
        self._writer.add_message(
            self._channels[topic], time, data, time, sequence=self._sequence[topic]
        )
        self._sequence[topic] += 1

    def _register(self, topic: str, content: Any) -> int:
        if isinstance(content, bytes):
            described = self._topics[topic]
            schema = self._writer.register_schema(
                described.name.lstrip("/"), "jsonschema", json.dumps(described.schema).encode()
            )
            channel: int = self._writer.register_channel(topic, "json", schema, described.metadata)
            return channel
        name = type(content).DESCRIPTOR.full_name
        if name not in self._schemas:
            self._schemas[name] = register_schema(self._writer, type(content))
        registered: int = self._writer.register_channel(topic, "protobuf", self._schemas[name])
        return registered
