"""Writes an imported recording as an episode."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, IoError
from robocell.data import CameraStream, ColumnSpec, EpisodeWriter
from robocell.export._mp4 import Mp4
from robocell.export._videos import cut, encode
from robocell.importer._foreign_files import ADVICE
from robocell.importer._recording import Clip, Column, Stills

SIGNATURES = {b"\x89PNG": "png", b"\xff\xd8\xff": "mjpeg"}


@dataclass(frozen=True)
class Content:
    """What an episode will have.

    Attributes:
        id: Its id.
        rows: Its length.
        rate: Rows per second.
        columns: Its columns, without `time`.
        cameras: Its images by camera.
        success: Whether it succeeded.
        terminated: Whether its task ended it.
        end_reason: Why it ended.
        metadata: Its metadata.
    """

    id: str
    rows: int
    rate: Fraction
    columns: dict[str, Column]
    cameras: dict[str, Clip | Stills]
    success: bool
    terminated: bool
    end_reason: str
    metadata: dict[str, Any]


@dataclass(frozen=True)
class _Images:
    """The images of a camera, of which the size is known: a file, or blocks of pixels."""

    width: int
    height: int
    file: Path | None = None
    blocks: Iterable[NDArray[np.uint8]] = ()


def write_episode(content: Content, dataset: Path, scratch: Path) -> None:
    """Writes an episode into a dataset.

    Args:
        content: What it has.
        dataset: The folder of the dataset.
        scratch: A folder for videos on their way to the episode; it is removed.

    Raises:
        ArgumentError: A column or an image cannot be one of an episode.
        IoError: The source is damaged.
        OSError: The episode cannot be written.
    """
    columns = {"time": ColumnSpec(units="s")}
    values = {"time": np.arange(content.rows) * float(1 / content.rate)}
    for name, column in content.columns.items():
        values[name] = _storable(column.values, content, name)
        columns[name] = _declared(values[name], column.names)
    scratch.mkdir(parents=True, exist_ok=True)
    images = {name: _opened(content, name, scratch) for name in content.cameras}
    cameras = {
        name: CameraStream(each.width, each.height, content.rate) for name, each in images.items()
    }
    try:
        episode = EpisodeWriter(dataset, content.id, columns, cameras, metadata=content.metadata)
    except IoError as error:
        raise OSError(str(error)) from error
    with episode:
        try:
            episode.add_rows(values)
            for name, each in images.items():
                _add_images(episode, content, name, each)
            episode.commit(
                content.success, terminated=content.terminated, end_reason=content.end_reason
            )
        except IoError as error:
            if episode.is_open:  # the source is damaged
                raise
            raise OSError(str(error)) from error
    shutil.rmtree(scratch)


def _declared(values: NDArray[Any], names: tuple[str, ...]) -> ColumnSpec:
    size = values.shape[-1] if values.ndim > 1 else 1
    has_names = len(names) == size and len(set(names)) == size
    return ColumnSpec(str(values.dtype), values.shape[1:], names=names if has_names else ())


def _storable(values: NDArray[Any], content: Content, name: str) -> NDArray[Any]:
    """Returns numbers in one of the types of episodes; a row of one number has no axis."""
    what = f"{content.id}: column '{name}'"
    if len(values) != content.rows:
        raise IoError(
            f"{what} has {len(values)} rows instead of {content.rows}: the dataset is damaged. A "
            "mapping file leaves the column out: --mapping FILE"
        )
    if 0 in values.shape:
        raise ArgumentError(f"{what} has no numbers. A mapping file leaves it out: --mapping FILE")
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    kind = values.dtype
    if kind.kind == "b" or kind in (np.float32, np.float64, np.int32, np.int64):
        return values
    if kind.kind == "f":
        return values.astype(np.float32 if kind.itemsize < 4 else np.float64)
    if kind.kind in "iu" and kind != np.uint64:
        return values.astype(np.int64)
    raise ArgumentError(
        f"{what} has the type {kind}; columns are numbers. A mapping file leaves it out: "
        "--mapping FILE"
    )


def _opened(content: Content, camera: str, scratch: Path) -> _Images:
    """Returns the images of a camera; encoded ones as a file in `scratch`."""
    images, out = content.cameras[camera], scratch / f"{camera}.mp4"
    if isinstance(images, Clip):
        facts = Mp4.read(images.file)
        _require_even(facts.width, facts.height, content, camera)
        if images.first + content.rows > facts.frames:
            raise IoError(
                f"'{images.file}' has {facts.frames} frames; {content.id} needs the "
                f"{content.rows} from frame {images.first} on: the dataset is damaged"
            )
        made = cut(images.file, facts, images.first, content.rows, images.fps, out, content.rate)
        return _file(out, made, content, camera)
    blocks = iter(images.blocks)
    what = f"camera '{camera}' of {content.id}"
    first = next(blocks, None)
    if first is None:
        raise IoError(f"{what} has no images for {content.rows} rows: {ADVICE}")
    if isinstance(first, bytes):
        codec = next((name for start, name in SIGNATURES.items() if first.startswith(start)), None)
        if codec is None:
            raise ArgumentError(f"images of {what} are neither PNG nor JPEG files")
        source = ["-f", "image2pipe", "-c:v", codec]
        rest = (bytes(each) for each in blocks)
        made = encode(_all(first, rest), source, content.rate, out, what)
        return _file(out, made, content, camera)
    height, width = first.shape[1:3]
    _require_even(width, height, content, camera)
    return _Images(width, height, blocks=_all(first, blocks))


def _file(out: Path, made: Mp4, content: Content, camera: str) -> _Images:
    _require_one_per_row(made.frames, content, camera)
    return _Images(made.width, made.height, out)


def _add_images(episode: EpisodeWriter, content: Content, camera: str, images: _Images) -> None:
    if images.file is not None:
        episode.add_checked_video(camera, images.file)  # `cut` and `encode` decoded it
        return
    count = 0
    for block in images.blocks:
        for image in block:
            episode.add_frame(camera, image)
        count += len(block)
    _require_one_per_row(count, content, camera)


def _all(first: Any, rest: Iterator[Any]) -> Iterator[Any]:
    yield first
    yield from rest


def _require_one_per_row(frames: int, content: Content, camera: str) -> None:
    if frames != content.rows:
        raise IoError(
            f"{content.id}: camera '{camera}' has {frames} images for {content.rows} rows: "
            "the dataset is damaged. A mapping file leaves the camera out: --mapping FILE"
        )


def _require_even(width: int, height: int, content: Content, camera: str) -> None:
    if width % 2 or height % 2:
        raise ArgumentError(
            f"{content.id}: images of camera '{camera}' have {width}x{height} pixels; videos need "
            "even numbers. A mapping file leaves the camera out: --mapping FILE"
        )
