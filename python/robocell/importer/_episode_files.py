"""Writes one imported recording as an episode: steps.h5, videos, episode.json."""

from __future__ import annotations

import hashlib
import json
import os
import socket
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell import __version__
from robocell._core import ArgumentError, IoError, sign_json
from robocell.export._hdf5 import Writer, new_file
from robocell.export._mp4 import Mp4
from robocell.export._videos import cut, encode
from robocell.importer._foreign_files import ADVICE
from robocell.importer._recording import Clip, Column, Stills

STEPS, DESCRIPTION = "steps.h5", "episode.json"
NO_HASH = "0" * 64
CHUNK_ROWS = 64
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


def write_episode(content: Content, folder: Path) -> None:
    """Writes an episode into an empty folder.

    Raises:
        ArgumentError: A column or an image cannot be one of an episode.
        OSError: The disk is full.
    """
    started = _now()
    cameras = {}
    for name, images in content.cameras.items():
        file = folder / f"{name}.mp4"
        facts = _write_video(images, file, content, name)
        if facts.frames != content.rows:
            raise IoError(
                f"{content.id}: camera '{name}' has {facts.frames} images for {content.rows} rows: "
                "the dataset is damaged. A mapping file leaves the camera out: --mapping FILE"
            )
        cameras[name] = {
            "file": file.name,
            "table": "steps",
            "frames": facts.frames,
            "width": facts.width,
            "height": facts.height,
            "fps": [content.rate.numerator, content.rate.denominator],
        }
    _write_steps(content, cameras, folder / STEPS)
    files = {
        file.name: {"bytes": file.stat().st_size, "sha256": _sha256(file)}
        for file in sorted(folder.iterdir())
    }
    description = {
        "format": "robocell-episode",
        "format_version": 1,
        "id": content.id,
        "success": content.success,
        "terminated": content.terminated,
        "truncated": False,
        "end_reason": content.end_reason,
        "warnings": [],
        "results": {},
        "tables": {"steps": {"rows": content.rows}},
        "cameras": cameras,
        "metadata": content.metadata,
        "versions": {"robocell": __version__},
        "models": {},
        "files": files,
        "run": {
            "host": socket.gethostname(),
            "process": os.getpid(),
            "started": started,
            "finished": _now(),
            "json_sha256": NO_HASH,
        },
    }
    text = json.dumps(description, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    (folder / DESCRIPTION).write_text(sign_json(text))


def _write_steps(content: Content, cameras: dict[str, Any], path: Path) -> None:
    with new_file(path) as file:
        file.group.attrs["format"] = "robocell-episode"
        file.group.attrs["format_version"] = 1
        file.group.attrs["rows"] = content.rows
        times = (np.arange(content.rows) * float(1 / content.rate)).astype(np.float64)
        _add(file, "time", Column(times), content, units="s")
        for name, column in content.columns.items():
            _add(file, name, column, content)
        for name, camera in cameras.items():
            attributes = file.inside(f"cameras/{name}").group.attrs
            attributes["video"], attributes["table"] = camera["file"], "steps"
            attributes["width"], attributes["height"] = camera["width"], camera["height"]
            attributes["fps_num"], attributes["fps_den"] = camera["fps"]
        file.check()


def _add(file: Writer, name: str, column: Column, content: Content, units: str = "") -> None:
    values = _storable(column.values, f"{content.id}: column '{name}'")
    if len(values) != content.rows:
        raise IoError(
            f"{content.id}: column '{name}' has {len(values)} rows instead of {content.rows}: the "
            "dataset is damaged. A mapping file leaves the column out: --mapping FILE"
        )
    file.add(name, values)
    attributes = file.group[name].attrs
    attributes["table"] = "steps"
    if units:
        attributes["units"] = units
    size = values.shape[-1] if values.ndim > 1 else 1
    if len(column.names) == size and len(set(column.names)) == size:
        import h5py

        attributes.create("names", list(column.names), dtype=h5py.string_dtype())


def _storable(values: NDArray[Any], what: str) -> NDArray[Any]:
    """Returns numbers in one of the types of episodes; a row of one number has no axis."""
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


def _write_video(images: Clip | Stills, out: Path, content: Content, camera: str) -> Mp4:
    if isinstance(images, Clip):
        facts = Mp4.read(images.file)
        _require_even(facts.width, facts.height, content, camera)
        if images.first + content.rows > facts.frames:
            raise IoError(
                f"'{images.file}' has {facts.frames} frames; {content.id} needs the "
                f"{content.rows} from frame {images.first} on: the dataset is damaged"
            )
        return cut(images.file, facts, images.first, content.rows, images.fps, out, content.rate)
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
        return encode(_all(first, rest), source, content.rate, out, what)
    height, width = first.shape[1:3]
    _require_even(width, height, content, camera)
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
    rest = (np.ascontiguousarray(block).tobytes() for block in blocks)
    return encode(_all(first.tobytes(), rest), source, content.rate, out, what)


def _all(first: bytes, rest: Iterator[bytes]) -> Iterator[bytes]:
    yield first
    yield from rest


def _require_even(width: int, height: int, content: Content, camera: str) -> None:
    if width % 2 or height % 2:
        raise ArgumentError(
            f"{content.id}: images of camera '{camera}' have {width}x{height} pixels; videos need "
            "even numbers. A mapping file leaves the camera out: --mapping FILE"
        )


def _sha256(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
