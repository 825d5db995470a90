"""What an episode holds that Foxglove has a schema for: joints, frames, poses, cameras, events."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import Episode
from robocell._extras import needed_by
from robocell.export._events import events_of
from robocell.export._frames import frames_of, step_columns
from robocell.export._mcap_columns import times_of
from robocell.export._source import Camera, Item

with needed_by("robocell.export", "mcap"):
    from foxglove_schemas_protobuf import (
        CameraCalibration_pb2,
        CompressedVideo_pb2,
        FrameTransform_pb2,
        FrameTransforms_pb2,
        JointState_pb2,
        JointStates_pb2,
        Log_pb2,
        Pose_pb2,
        PoseInFrame_pb2,
        Quaternion_pb2,
        RawImage_pb2,
        Vector3_pb2,
    )
    from google.protobuf.timestamp_pb2 import Timestamp

Message = tuple[int, str, Any]  # nanoseconds, topic, content
WORLD = "world"
SECOND = 1_000_000_000


def joint_states(episode: Episode) -> Iterator[Message]:
    """Yields the positions and velocities of all joints of all robots."""
    names: list[str] = []
    positions, velocities = [], []
    for column in step_columns(episode):
        parts = column.split("/")
        if len(parts) != 4 or parts[0] != "robots" or parts[3] != "qpos":
            continue
        own = episode.column(column)
        speed = f"{column[:-4]}qvel"
        size = int(np.prod(own.row_shape))
        if len(own.names) != size or speed not in episode:
            continue  # joints with more numbers than names, such as balls
        if list(episode.column(speed).names) != list(own.names):
            continue
        names += [f"{parts[1]}/{name}" for name in own.names]
        positions.append(episode[column].reshape(-1, size))
        velocities.append(episode[speed].reshape(-1, size))
    if not names:
        return
    rows = zip(
        times_of(episode),
        np.hstack(positions).tolist(),
        np.hstack(velocities).tolist(),
        strict=True,
    )
    for time, position, velocity in rows:
        joints = [
            JointState_pb2.JointState(name=name, position=at, velocity=speed)
            for name, at, speed in zip(names, position, velocity, strict=True)
        ]
        yield (
            time,
            "/joint_states",
            JointStates_pb2.JointStates(timestamp=_stamp(time), joints=joints),
        )


def transforms(episode: Episode) -> Iterator[Message]:
    """Yields the frames of robots, TCPs, objects and cameras in the world."""
    frames = frames_of(episode)
    for row, time in enumerate(times_of(episode)):
        there = [
            FrameTransform_pb2.FrameTransform(
                timestamp=_stamp(time),
                parent_frame_id=WORLD,
                child_frame_id=frame,
                translation=_vector(poses_of[row]),
                rotation=_quaternion(poses_of[row]),
            )
            for frame, poses_of in frames.items()
            if np.isfinite(poses_of[row]).all()
        ]
        if there:
            yield time, "/tf", FrameTransforms_pb2.FrameTransforms(transforms=there)


def poses(episode: Episode) -> Iterator[Message]:
    """Yields every pose of the episode, in its frame, as `/poses/<column>`."""
    columns = [
        (f"/poses/{name}", episode.column(name).frame, episode[name])
        for name in step_columns(episode)
        if _is_pose(episode, name)
    ]
    for row, time in enumerate(times_of(episode)):
        for topic, frame, column in columns:
            if np.isfinite(column[row]).all():
                pose = Pose_pb2.Pose(
                    position=_vector(column[row]), orientation=_quaternion(column[row])
                )
                yield (
                    time,
                    topic,
                    PoseInFrame_pb2.PoseInFrame(timestamp=_stamp(time), frame_id=frame, pose=pose),
                )


def events(episode: Episode, item: Item) -> Iterator[Message]:
    """Yields the instruction, each change of a phase or sub-task, and the end, as a log."""
    for event in events_of(episode, item):
        level = Log_pb2.Log.WARNING if event.failed else Log_pb2.Log.INFO
        stamp = _stamp(event.time)
        log = Log_pb2.Log(timestamp=stamp, level=level, message=event.text, name=event.kind)
        yield event.time, "/events", log


def calibration(episode: Episode, camera: Camera, size: tuple[int, int]) -> Iterator[Message]:
    """Yields the calibration of a camera, once, for images of a height and width."""
    name = f"cameras/{camera.name}/intrinsics"
    if name not in episode or size != (camera.height, camera.width):
        return  # images with borders have another camera matrix
    matrix = np.asarray(episode[name], float)
    time = times_of(episode)[0]
    content = CameraCalibration_pb2.CameraCalibration(
        timestamp=_stamp(time),
        frame_id=f"cameras/{camera.name}",
        width=camera.width,
        height=camera.height,
        K=matrix.ravel().tolist(),
        R=np.eye(3).ravel().tolist(),
        P=np.hstack([matrix, np.zeros((3, 1))]).ravel().tolist(),
    )
    yield time, f"/{camera.feature}/calibration", content


def video(episode: Episode, camera: Camera, frames: Iterator[bytes]) -> Iterator[Message]:
    """Yields the frames of an H.264 video, a start code before each unit."""
    for time, data in zip(times_of(episode), frames, strict=True):
        content = CompressedVideo_pb2.CompressedVideo(
            timestamp=_stamp(time), frame_id=f"cameras/{camera.name}", data=data, format="h264"
        )
        yield time, f"/{camera.feature}/video", content


def depth(
    episode: Episode, camera: Camera, blocks: Iterator[tuple[int, NDArray[np.uint16]]]
) -> Iterator[Message]:
    """Yields the depth of a camera in millimetres."""
    times = times_of(episode)
    for first, block in blocks:
        for row, image in enumerate(block, first):
            content = RawImage_pb2.RawImage(
                timestamp=_stamp(times[row]),
                frame_id=f"cameras/{camera.name}",
                width=camera.width,
                height=camera.height,
                encoding="16UC1",
                step=2 * camera.width,
                data=image.astype("<u2").tobytes(),
            )
            yield times[row], f"/{camera.feature}/depth", content


def _is_pose(episode: Episode, name: str) -> bool:
    column = episode.column(name)
    return tuple(column.names) == ("x", "y", "z", "qx", "qy", "qz", "qw") and bool(column.frame)


def _stamp(time: int) -> Timestamp:
    return Timestamp(seconds=time // SECOND, nanos=time % SECOND)


def _vector(pose: NDArray[np.float64]) -> Vector3_pb2.Vector3:
    x, y, z = pose[:3].tolist()
    return Vector3_pb2.Vector3(x=x, y=y, z=z)


def _quaternion(pose: NDArray[np.float64]) -> Quaternion_pb2.Quaternion:
    x, y, z, w = pose[3:].tolist()
    return Quaternion_pb2.Quaternion(x=x, y=y, z=z, w=w)
