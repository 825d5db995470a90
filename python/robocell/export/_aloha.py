"""Writes episodes as ALOHA does: an HDF5 file for each, with images as arrays.

ACT, RDT and the converters of openpi and LeRobot read `observations/qpos`, `observations/qvel`,
`observations/images/<camera>` and `action`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from robocell._core import ArgumentError
from robocell._staging import Staging
from robocell.export._formats import Options, Written
from robocell.export._hdf5 import new_file
from robocell.export._source import Item, Source

NEEDED = ("observations/qpos", "action")


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes episodes into a staging folder, `episode_0.hdf5` and so on.

    A killed export continues after the last complete episode.
    """
    names = [feature.name for feature in source.resolved.features]
    for name in NEEDED:
        if name not in names:
            raise ArgumentError(f"ALOHA episodes have '{name}'; features.{name} has no column")
    resumed = 0
    for index, item in enumerate(source.items):
        file = staging.path(f"episode_{index}.hdf5")
        if file.exists():
            resumed += 1
        else:
            partial = staging.scratch("episode.hdf5")
            _write_episode(source, item, partial)
            staging.put(partial, file)
        on_episode(index + 1)
    lengths = sorted({item.rows for item in source.items})
    notes = [
        "`/observations/qpos`, `/observations/qvel`, `/observations/images/<camera>` and `/action` "
        "are those of ALOHA; the attribute `instruction` is the task."
    ]
    if len(lengths) > 1:
        notes.append(
            f"Episodes have {lengths[0]} to {lengths[-1]} rows. The first version of ACT reads "
            "episodes of one length only."
        )
    return Written(resumed, {}, {}, tuple(notes))


def _write_episode(source: Source, item: Item, path: Path) -> None:
    episode = source.episode(item)
    with new_file(path) as file:
        file.group.attrs["sim"] = True
        file.group.attrs["compress"] = False
        file.group.attrs["instruction"] = item.task
        file.group.attrs["rate"] = float(source.rate)
        for feature in source.resolved.features:
            file.add(feature.name, feature.read(episode))
        for camera in source.cameras:
            file.add_images(camera.feature, source, item, camera)
