"""Writes the replay buffer of Diffusion Policy: a zarr group with all episodes one after the other.

`data/<name>` holds the rows of all episodes, `meta/episode_ends` the row after each. The buffer has
version 2 of the zarr format, which the zarr package reads in its versions 2 and 3.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robocell._extras import needed_by
from robocell._staging import Staging
from robocell.export._formats import Options, Written
from robocell.export._images import blocks, depth_blocks, depth_name, depth_notes
from robocell.export._source import Camera, Source

with needed_by("robocell.export", "export"):
    import numcodecs
    import zarr

NAME = "replay_buffer.zarr"
DESCRIPTIONS = (".zarray", ".zattrs", ".zgroup")
CHUNK_BYTES = 1 << 20  # of numbers; an image is a chunk of its own


def write(
    source: Source, staging: Staging, options: Options, on_episode: Callable[[int], None]
) -> Written:
    """Writes a replay buffer into a staging folder.

    A killed export keeps the images of complete episodes; numbers are written again.
    """
    done = write_buffer(source, staging, on_episode, staging.path(NAME))
    notes = (
        f"`{NAME}` is a replay buffer: `data/<feature>` has the rows of all episodes, "
        "`meta/episode_ends` the row after each.",
        "The task of an episode is in `meta/robocell/episodes.json`.",
        *depth_notes(source, "uint16", "millimetres"),
    )
    return Written(done, {}, {}, notes)


def write_buffer(
    source: Source,
    staging: Staging,
    on_episode: Callable[[int], None],
    place: Path,
    codec: Any = None,
    write_more: Callable[[Source, Any], None] | None = None,
) -> int:
    """Writes a replay buffer, and returns how many episodes a killed export has left of it.

    Args:
        source: What is written.
        staging: Keeps how far the images are.
        on_episode: Called with the number of episodes that are written.
        place: The folder of the buffer.
        codec: Compresses images; default: Blosc.
        write_more: Writes more arrays of numbers into the group `data`.
    """
    # A chunk of zeros is stored too: for readers a missing one is a lost file.
    with zarr.config.set({"array.write_empty_chunks": True}):
        return _write_chunks(source, staging, on_episode, place, codec, write_more)


def _write_chunks(
    source: Source,
    staging: Staging,
    on_episode: Callable[[int], None],
    place: Path,
    codec: Any,
    write_more: Callable[[Source, Any], None] | None,
) -> int:
    ends = np.cumsum([item.rows for item in source.items])
    done: int | None = staging.state("images")
    if done is None:
        shutil.rmtree(place, ignore_errors=True)
        done = 0
    names = [camera.feature for camera in source.cameras]
    _remove_remains(place, [*names, *map(depth_name, names)])
    root = zarr.open_group(str(place), mode="a", zarr_format=2)
    data, meta = root.require_group("data"), root.require_group("meta")
    _write_numbers(source, data)  # first: numbers that are refused cost no images
    if write_more is not None:
        write_more(source, data)
    images = [_image_array(data, source, camera, codec) for camera in source.cameras]
    depths = [_depth_array(data, source, camera) for camera in source.depths]
    for index, item in enumerate(source.items):
        if index < done:
            on_episode(index + 1)
            continue
        first = int(ends[index]) - item.rows
        for camera, array in zip(source.cameras, images, strict=True):
            for row, block in blocks(source, item, camera):
                array[first + row : first + row + len(block)] = block
        for camera, array in zip(source.depths, depths, strict=True):
            for row, depth in depth_blocks(source, item, camera):
                array[first + row : first + row + len(depth)] = depth
        for array in (*images, *depths):
            staging.wrote(_files_of(place, array, first, item.rows))
        staging.keep("images", index + 1)
        on_episode(index + 1)
    write_array(meta, "episode_ends", (len(ends),), np.dtype(np.int64))[:] = ends
    return done


def _remove_remains(place: Path, images: Sequence[str]) -> None:
    """Removes what a killed export left half, and arrays of numbers, which are written again.

    After a power cut, their files may be empty.
    """
    for folder, _, files in os.walk(place):
        for name in files:
            if name.endswith(".partial"):  # zarr's own temporary files
                (Path(folder) / name).unlink()
    shutil.rmtree(place / "meta", ignore_errors=True)
    data = place / "data"
    for entry in data.iterdir() if data.is_dir() else ():
        is_kept = any((data / name).is_relative_to(entry) for name in images)
        if entry.is_dir() and not is_kept:
            shutil.rmtree(entry)


def _files_of(place: Path, array: Any, first: int, rows: int) -> list[Path]:
    """Returns the files of rows of images, each a chunk, and those that describe the array."""
    folder = place / array.path
    above = [each for each in folder.parents if each.is_relative_to(place)]
    described = [each / name for each in (folder, *above) for name in DESCRIPTIONS]
    chunks = [folder / f"{row}.0.0.0" for row in range(first, first + rows)]
    return [*described, *chunks]


def _image_array(data: Any, source: Source, camera: Any, codec: Any) -> Any:
    """Returns the array of a camera's images, which a killed export may have begun."""
    if camera.feature in data:
        return data[camera.feature]
    shape = (*source.shape_of(camera), 3)
    whole = (source.rows, *shape)
    return write_array(data, camera.feature, whole, np.dtype(np.uint8), (1, *shape), codec)


def _depth_array(data: Any, source: Source, camera: Camera) -> Any:
    """Returns the array of a camera's depth, which a killed export may have begun."""
    name, shape = depth_name(camera.feature), (camera.height, camera.width, 1)
    if name in data:
        return data[name]
    array = write_array(data, name, (source.rows, *shape), np.dtype(np.uint16), (1, *shape))
    array.attrs["unit"] = "mm"
    return array


def _write_numbers(source: Source, data: Any) -> None:
    """Writes the features, one episode at a time."""
    arrays = {
        feature.name: write_array(
            data, feature.name, (source.rows, feature.size), np.dtype(feature.dtype)
        )
        for feature in source.resolved.features
    }
    row = 0
    for item in source.items:
        episode = source.episode(item)
        for feature in source.resolved.features:
            arrays[feature.name][row : row + item.rows] = feature.read(episode)
        row += item.rows


def write_array(
    group: Any,
    name: str,
    shape: tuple[int, ...],
    dtype: Any,
    chunks: tuple[int, ...] | None = None,
    codec: Any = None,
) -> Any:
    """Makes an array of a buffer, without its rows; Blosc compresses it unless `codec` is given."""
    row_bytes = int(np.prod(shape[1:])) * dtype.itemsize
    rows = max(1, min(shape[0], CHUNK_BYTES // row_bytes))
    return group.create_array(
        name,
        shape=shape,
        dtype=dtype,
        chunks=chunks or (rows, *shape[1:]),
        compressors=codec or numcodecs.Blosc("zstd", clevel=5, shuffle=numcodecs.Blosc.SHUFFLE),
        fill_value=0,
        overwrite=True,
    )
