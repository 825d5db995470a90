"""Writes the dataset of UMI: a replay buffer in one zip, with images in JPEG XL.

The buffer is written as a folder of the staging first, so that a killed export continues; the zip
stores its files as they are.
"""

from __future__ import annotations

import os
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import ArgumentError
from robocell._staging import Staging
from robocell.export._formats import Options, Written
from robocell.export._jpegxl import JpegXl
from robocell.export._replay_buffer import write_array, write_buffer
from robocell.export._source import Source

NAME = "dataset.zarr.zip"
EPOCH = (1980, 1, 1, 0, 0, 0)  # same datasets, same bytes
POSITION, ROTATION = "eef_pos", "eef_rot_axis_angle"


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes the zip into a staging folder.

    A killed export keeps the images of complete episodes; numbers are written again.
    """
    folder = staging.scratch("replay_buffer.zarr")
    done = write_buffer(source, staging, on_episode, folder, JpegXl(), _write_ends_of_demos)
    partial = staging.scratch(NAME)
    _zip(folder, partial)
    staging.put(partial, staging.path(NAME))
    cameras = ", ".join(f"`{each.feature}` is {each.name}" for each in source.cameras) or "none"
    notes = (
        f"`{NAME}` is a replay buffer of UMI: `data/<name>` has the rows of all episodes, "
        "`meta/episode_ends` the row after each. Images are JPEG XL without loss.",
        f"Cameras: {cameras}.",
        "Poses are those of the TCP in the world, which all robots share. `robot<n>_gripper_width` "
        "is the opening, not a width in metres.",
        "There is no `action`: UMI's reader takes the poses of later rows.",
    )
    return Written(done, {}, {}, notes)


def _write_ends_of_demos(source: Source, data: Any) -> None:
    """Writes the first and the last pose of its episode beside each row."""
    names = {feature.name: feature for feature in source.resolved.features}
    for name in [each for each in names if each.endswith(f"_{POSITION}")]:
        robot = name.removesuffix(f"_{POSITION}")
        if (rotation := f"{robot}_{ROTATION}") not in names:
            raise ArgumentError(f"UMI's format has '{rotation}' beside '{name}'")
        arrays = [
            write_array(data, f"{robot}_demo_{end}_pose", (source.rows, 6), np.dtype(np.float32))
            for end in ("start", "end")
        ]
        row = 0
        for item in source.items:
            episode = source.episode(item)
            poses = np.hstack([names[name].read(episode), names[rotation].read(episode)])
            for array, pose in zip(arrays, (poses[0], poses[-1]), strict=True):
                array[row : row + item.rows] = np.tile(pose, (item.rows, 1))
            row += item.rows


def _zip(folder: Path, out: Path) -> None:
    """Stores the files of a folder, those of its top first, in the order of their names."""
    with zipfile.ZipFile(out, "w", zipfile.ZIP_STORED) as archive:
        for place, folders, files in os.walk(folder):
            folders.sort()
            for name in sorted(files):
                file = Path(place) / name
                entry = zipfile.ZipInfo(file.relative_to(folder).as_posix(), EPOCH)
                with file.open("rb") as content, archive.open(entry, "w", force_zip64=True) as to:
                    shutil.copyfileobj(content, to)
