"""Writes datasets as MolmoSpaces does: HDF5 trajectories in a folder for each house, with videos.

Row i of a trajectory holds state i and the action that led to it. So a trajectory has two rows more
than the episode: its first action is a dummy, its last one says that it is done, and its last two
states repeat the last one of the episode. Readers drop these.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Episode
from robocell._staging import Staging
from robocell.export._features import Feature
from robocell.export._formats import Options, Written
from robocell.export._hdf5 import new_file
from robocell.export._mp4 import Mp4
from robocell.export._source import Camera, Item, Source
from robocell.export._videos import join, require_frames

SPLIT = "train"
TEXT_BYTES = 2000  # of a JSON text, at least
NAME_BYTES = 100  # of the name of a video
EXTRA_ROWS = 2
# These stand beside the state that they led to.
RESULTS = ("rewards", "success", "terminated", "truncated")
TO_GL = np.diag([1.0, -1.0, -1.0, 1.0])  # OpenCV's axes of a camera to OpenGL's


@dataclass(frozen=True)
class Place:
    """Where a trajectory is.

    Attributes:
        house: Number of the scene.
        batch: "batch_1_of_8".
    """

    house: int
    batch: str

    @property
    def folder(self) -> str:
        """Folder of the house."""
        return f"house_{self.house}"

    @property
    def trajectories(self) -> str:
        """File of the trajectory."""
        return f"{self.folder}/trajectories_{self.batch}.h5"

    def video(self, camera: str) -> str:
        """Returns the name of a camera's video, in the folder of the house."""
        return f"episode_{0:08d}_{camera}_{self.batch}.mp4"


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes a dataset into a staging folder.

    Every trajectory has a file of its own; a killed export continues after the last complete one.
    """
    if len(source.resolved.robots) > 1:
        raise ArgumentError(
            f"MolmoSpaces trajectories hold one robot; these have {source.robot_type}"
        )
    for camera in source.cameras:
        if len(Place(0, "batch_1_of_1").video(camera.feature)) > NAME_BYTES - 20:
            raise ArgumentError(f"the name of camera '{camera.feature}' is too long")
    places = places_of(source)
    resumed = 0
    for index, (item, place) in enumerate(zip(source.items, places, strict=True)):
        file = staging.path(f"{SPLIT}/{place.trajectories}")
        if file.exists():
            resumed += 1
        else:
            for camera in source.cameras:
                video = staging.path(f"{SPLIT}/{place.folder}/{place.video(camera.feature)}")
                _write_video(source, item, camera, video)
            partial = staging.scratch("trajectory.h5")
            _write_trajectory(source, item, place, partial)
            staging.put(partial, file)
        on_episode(index + 1)
    index_of: dict[str, dict[str, dict[str, int]]] = {}
    for item, place in zip(source.items, places, strict=True):
        own = index_of.setdefault(place.folder, {})
        own[place.trajectories] = {"traj_0": item.rows + EXTRA_ROWS}
    path = staging.path(f"{SPLIT}/valid_trajectory_index.json")
    path.write_text(json.dumps(index_of, indent=1) + "\n")
    codecs = {
        camera.feature: Mp4.read(
            staging.path(f"{SPLIT}/{places[0].folder}/{places[0].video(camera.feature)}")
        ).codec
        for camera in source.cameras
    }
    encoded = {camera.feature: "the last frame is repeated" for camera in source.cameras}
    notes = (
        "Row i + 1 of `actions`, `rewards`, `success`, `terminated` and `truncated` belongs to "
        "state i. The first action is a dummy, the last one `{}`; the last two states repeat the "
        "one before.",
        "JSON texts are padded with zeros. Poses are x, y, z, then w, x, y, z of the quaternion.",
        "A house is a scene of the run.",
    )
    return Written(resumed, encoded, codecs, notes)


def places_of(source: Source) -> list[Place]:
    """Returns the place of every episode."""
    houses = []
    for item in source.items:
        metadata: Any = source.episode(item).metadata or {}
        scene = metadata.get("scene", 0)
        houses.append(scene if isinstance(scene, int) and scene >= 0 else 0)
    whole, begun = Counter(houses), Counter[int]()
    places = []
    for house in houses:
        begun[house] += 1
        places.append(Place(house, f"batch_{begun[house]}_of_{whole[house]}"))
    return places


def _write_video(source: Source, item: Item, camera: Camera, path: Path) -> None:
    """Writes a video with a frame for every row of the trajectory."""
    file = source.video(item, camera)
    size = source.resized(camera)
    joined = join([file], path, source.fps, True, None, size, repeats=EXTRA_ROWS)
    require_frames(path, joined, item.rows + EXTRA_ROWS)


def _write_trajectory(source: Source, item: Item, place: Place, path: Path) -> None:
    episode = source.episode(item)
    with new_file(path) as file:
        trajectory = file.inside("traj_0")
        texts: dict[str, dict[str, NDArray[Any]]] = {}
        for feature in source.resolved.features:
            dataset, _, group = feature.name.rpartition("/")
            if dataset.startswith(("actions/", "obs/agent/")):
                texts.setdefault(dataset, {})[group] = feature.read(episode)
            else:
                trajectory.add(feature.name, _series(feature, episode), compressed=True)
        for name, of_groups in texts.items():
            trajectory.add(
                name, _json_rows(of_groups, name.startswith("actions/")), compressed=True
            )
        fail = np.zeros(item.rows + EXTRA_ROWS, bool)
        fail[-EXTRA_ROWS:] = not item.success
        trajectory.add("fail", fail, compressed=True)
        for camera in source.cameras:
            video = place.video(camera.feature).encode().ljust(NAME_BYTES, b"\0")
            trajectory.add(
                f"obs/sensor_data/{camera.feature}", np.frombuffer(video, np.uint8), compressed=True
            )
            for parameter, values in _parameters(episode, camera).items():
                trajectory.add(
                    f"obs/sensor_param/{camera.feature}/{parameter}", values, compressed=True
                )
        trajectory.add("obs_scene", json.dumps(_scene(source, item)))


def _series(feature: Feature, episode: Episode) -> NDArray[Any]:
    """Returns a feature with the extra rows: results beside the state that they led to."""
    values = feature.read(episode)
    if feature.name in RESULTS:
        flat = values[:, 0]
        last = np.zeros(1, flat.dtype) if feature.name == "rewards" else flat[-1:]
        return np.concatenate([np.zeros(1, flat.dtype), flat, last])
    return _longer(values)


def _longer(values: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([values, *[values[-1:]] * EXTRA_ROWS])


def _json_rows(of_groups: dict[str, NDArray[Any]], is_action: bool) -> NDArray[np.uint8]:
    """Returns a JSON text for each row, as bytes with zeros behind."""
    rows = len(next(iter(of_groups.values())))
    texts = [
        json.dumps({group: values[row].tolist() for group, values in of_groups.items()})
        for row in range(rows)
    ]
    texts = [texts[0], *texts, "{}"] if is_action else [*texts, *[texts[-1]] * EXTRA_ROWS]
    return _padded(texts)


def _padded(texts: Sequence[str]) -> NDArray[np.uint8]:
    encoded = [text.encode() for text in texts]
    width = max(TEXT_BYTES, *map(len, encoded))
    return np.frombuffer(b"".join(text.ljust(width, b"\0") for text in encoded), np.uint8).reshape(
        len(texts), width
    )


def _parameters(episode: Episode, camera: Camera) -> dict[str, NDArray[Any]]:
    """Returns the parameters of a camera in every row; none where they were not recorded."""
    name = f"cameras/{camera.name}/extrinsics"
    if name not in episode:
        return {}
    to_camera = _longer(episode[name])
    intrinsics = episode[f"cameras/{camera.name}/intrinsics"]
    return {
        "cam2world_gl": np.asarray(np.linalg.inv(to_camera) @ TO_GL, np.float32),
        "extrinsic_cv": np.asarray(to_camera[:, :3], np.float32),
        "intrinsic_cv": np.broadcast_to(intrinsics, (len(to_camera), 3, 3)).astype(np.float32),
    }


def _scene(source: Source, item: Item) -> dict[str, Any]:
    metadata: Any = source.episode(item).metadata or {}
    return {
        "task_type": metadata.get("task", ""),
        "task_description": item.task,
        "policy_dt_ms": 1000 / float(source.rate),
        "object_name": metadata.get("target_object", ""),
        "text": item.task,
        "episode": item.id,
    }
