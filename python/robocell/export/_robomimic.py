"""Writes robomimic datasets: one HDF5 file with a group for each demonstration.

`data/demo_i` has actions, rewards, dones, states, obs and next_obs; `mask/train` and `mask/valid`
list demonstrations. Actions are scaled to [-1, 1], as robomimic expects them, and `actions_abs`
keeps their own numbers.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell import Error
from robocell._core import ArgumentError, IoError
from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._features import Feature
from robocell.export._formats import Options, Written
from robocell.export._hdf5 import new_file
from robocell.export._images import depth_name, depth_notes
from robocell.export._source import Item, Source
from robocell.export._states import states_of
from robocell.export._statistics import Vectors

with needed_by("robocell.export", "export"):
    import h5py

NAME = "dataset.hdf5"
OBS, NEXT_OBS = "obs/", "next_obs/"
ACTIONS = "actions"
GYM = 2  # robomimic's number of an environment of Gym
VALID_SHARE = 0.1


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes a dataset into a staging folder.

    Every demonstration is a file of its own until all are there, so a killed export continues after
    the last complete one.
    """
    features = {feature.name: feature for feature in source.resolved.features}
    if ACTIONS not in features:
        raise ArgumentError("robomimic datasets have actions; features.actions has no column")
    low, high = _bounds(source, features[ACTIONS])
    resumed = 0
    for index, item in enumerate(source.items):
        file = staging.scratch(f"demo-{index}.hdf5")
        if file.exists():
            resumed += 1
        else:
            partial = staging.scratch("demo.hdf5")
            _write_demo(source, item, partial, low, high)
            staging.put(partial, file)
        on_episode(index + 1)
    without_states = _join(source, staging, low, high)
    notes = [
        f"`{NAME}`: `actions` are scaled to [-1, 1], each component by its smallest and largest "
        "number; the attributes `actions_min` and `actions_max` of `data` undo it. `actions_abs` "
        "has the numbers of the table above.",
        "Images are in `obs` only: train with `hdf5_load_next_obs` false from images.",
        *depth_notes(source, "float32", "metres"),
        "`states` are time, qpos and qvel of the simulation, from replaying the recorded controls."
        if not without_states
        else f"There are no `states`: {without_states}.",
    ]
    return Written(resumed, {}, {}, tuple(notes))


def scaled(actions: NDArray[Any], low: NDArray[Any], high: NDArray[Any]) -> NDArray[Any]:
    """Returns actions scaled from [low, high] to [-1, 1]; constant components become 0."""
    width = high - low
    share = np.divide(actions - low, width, out=np.full(actions.shape, 0.5), where=width > 0)
    return np.asarray(np.clip(2 * share - 1, -1, 1), np.float32)


def masks(demos: int) -> dict[str, list[str]]:
    """Returns the names of the demonstrations for training and for validation."""
    count = max(1, round(VALID_SHARE * demos)) if demos > 1 else 0
    chosen = set(np.random.default_rng(0).permutation(demos)[:count].tolist())
    names = [f"demo_{index}" for index in range(demos)]
    split = {
        "train": [name for index, name in enumerate(names) if index not in chosen],
        "valid": [name for index, name in enumerate(names) if index in chosen],
    }
    return {name: each for name, each in split.items() if each}


def _bounds(source: Source, actions: Feature) -> tuple[NDArray[Any], NDArray[Any]]:
    """Returns the smallest and largest number of each component of the actions."""
    whole = Vectors(actions.size)
    for item in source.items:
        whole.add(actions.read(source.episode(item)))
    found = whole.result()
    return np.array(found["min"]), np.array(found["max"])


def _write_demo(
    source: Source, item: Item, path: Path, low: NDArray[Any], high: NDArray[Any]
) -> None:
    """Writes a demonstration into a file of its own."""
    episode = source.episode(item)
    with new_file(path) as file:
        demo = file.inside("demo")
        demo.group.attrs["num_samples"] = item.rows
        demo.group.attrs["instruction"] = item.task
        demo.group.attrs["episode"] = item.id
        for feature in source.resolved.features:
            values = feature.read(episode)
            if feature.name == ACTIONS:
                demo.add("actions_abs", values)
                demo.add(ACTIONS, scaled(values, low, high))
                continue
            is_observed = feature.name.startswith(OBS)
            demo.add(feature.name, values if is_observed else _series(values))
            if is_observed:
                # No observation follows the last action; the last one stands for it.
                after = np.concatenate([values[1:], values[-1:]])
                demo.add(feature.name.replace(OBS, NEXT_OBS, 1), after)
        for camera in source.cameras:
            demo.add_images(camera.feature, source, item, camera)
        for camera in source.depths:
            demo.add_depth(depth_name(camera.feature), source, item, camera)
        try:
            states = states_of(source.recorded(item))
        except IoError:
            raise
        except Error as error:  # of this episode's scene: the dataset is of use without states
            demo.group.attrs["without_states"] = str(error)
        else:
            rows = source.rows_of(item)
            demo.add("states", states if rows is None else states[rows])


def _series(values: NDArray[Any]) -> NDArray[Any]:
    """Returns rewards and dones as robomimic has them, (rows,) numbers."""
    flat = values[:, 0] if values.shape[1] == 1 else values
    return flat.astype(np.uint8) if flat.dtype == bool else flat


def _join(source: Source, staging: Staging, low: NDArray[Any], high: NDArray[Any]) -> str:
    """Copies the demonstrations into one file; returns why one of them has no states, or ""."""
    why = ""
    with new_file(staging.path(NAME)) as file:
        data = file.inside("data").group
        data.attrs["total"] = source.rows
        data.attrs["env_args"] = json.dumps(_env_args(source), indent=4)
        data.attrs["actions_min"], data.attrs["actions_max"] = low, high
        for index in range(len(source.items)):
            with h5py.File(staging.scratch(f"demo-{index}.hdf5")) as part:
                part.copy("demo", data, name=f"demo_{index}")
                file.check()
                why = why or str(part["demo"].attrs.get("without_states", ""))
        for name, demos in masks(len(source.items)).items():
            file.add(f"mask/{name}", np.array(demos, "S"))
    return why


def _env_args(source: Source) -> dict[str, Any]:
    first = source.episode(source.items[0])
    metadata: Any = first.metadata or {}
    versions: Any = first.json
    return {
        "env_name": str(metadata.get("run", metadata.get("task", "robocell"))),
        "type": GYM,
        "env_version": str(versions.get("versions", {}).get("robocell", "")),
        "env_kwargs": {
            "task": metadata.get("task"),
            "rate": float(source.rate),
            "robots": source.robot_type,
        },
    }
