"""Reads robomimic's HDF5 file, and the HDF5 files of ALOHA, ACT and RoboTwin."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import ArgumentError, IoError
from robocell._extras import needed_by
from robocell.importer._recording import Clip, Column, Recording, Stills

with needed_by("robocell.importer", "export"):
    import h5py

BLOCK_BYTES = 16 << 20  # of images in memory


class Robomimic:
    """A robomimic dataset; see `recording.Origin`."""

    title = "robomimic HDF5"

    def __init__(self, file: Path) -> None:
        self.file = file
        self._content = _open(file)
        data = self._content["data"]
        self._demos = sorted((name for name in data if name.startswith("demo")), key=_number)
        settings = _settings(data.attrs.get("env_args", "{}"), file)
        self._environment = str(settings.get("env_name", ""))
        arguments = settings.get("env_kwargs") or {}
        hertz = arguments.get("control_freq", arguments.get("rate"))
        self.rate = Fraction(hertz).limit_denominator(100_000) if hertz else None
        robots = arguments.get("robots") or ""
        self.robots = robots if isinstance(robots, str) else ", ".join(map(str, robots))

    def __len__(self) -> int:
        return len(self._demos)

    def read(self, index: int) -> Recording:
        """Reads a demonstration."""
        name = self._demos[index]
        demo = self._content["data"][name]
        columns, images = _arrays(demo, skipped=("next_obs",))
        metadata = {"episode": name, "environment": self._environment}
        text = demo.attrs.get("instruction", "")
        return Recording(_text(text), len(demo["actions"]), columns, images, metadata)

    def column_name(self, name: str) -> str | None:
        """Returns "observation/object" for obs/object."""
        known = {"actions": "action", "rewards": "reward", "dones": "terminated"}
        if name.startswith("obs/"):
            return f"observation/{name[4:]}"
        return known.get(name, name)


class Aloha:
    """A folder of ALOHA's episodes; see `recording.Origin`."""

    title = "ALOHA HDF5"
    robots = ""

    def __init__(self, folder: Path) -> None:
        self._files = sorted(folder.glob("episode_*.hdf5"), key=lambda file: _number(file.stem))
        with _open(self._files[0]) as first:
            hertz = first.attrs.get("rate")
        self.rate = Fraction(float(hertz)).limit_denominator(100_000) if hertz else None

    def __len__(self) -> int:
        return len(self._files)

    def read(self, index: int) -> Recording:
        """Reads an episode."""
        file = self._files[index]
        content = _open(file)
        columns, images = _arrays(content, skipped=("compress_len",))
        rows = len(content["action"])
        text = _text(content.attrs.get("instruction", ""))
        return Recording(text, rows, columns, images, {"episode": file.stem})

    def column_name(self, name: str) -> str | None:
        """Returns "observation/qpos" for observations/qpos."""
        return name.replace("observations/", "observation/", 1)


def is_robomimic(file: Path) -> bool:
    """Whether an HDF5 file has demonstrations of robomimic."""
    with _open(file) as content:
        return "data" in content and any(name.startswith("demo") for name in content["data"])


def is_aloha(file: Path) -> bool:
    """Whether an HDF5 file is an episode of ALOHA."""
    with _open(file) as content:
        return "action" in content and "observations" in content


def _arrays(
    group: Any, skipped: tuple[str, ...]
) -> tuple[dict[str, Column], dict[str, Clip | Stills]]:
    """Returns the columns and the images below a group, by their paths."""
    columns: dict[str, Column] = {}
    images: dict[str, Clip | Stills] = {}

    def look(name: str, array: Any) -> None:
        if not isinstance(array, h5py.Dataset) or name.split("/")[0] in skipped:
            return
        if array.dtype == np.uint8 and array.ndim == 4 and array.shape[3] == 3:
            images[name] = Stills(_blocks(array))
        elif "images/" in name and array.ndim in (1, 2):
            images[name] = Stills(_files(array))
        elif array.ndim and np.dtype(array.dtype).kind in "fiub":
            columns[name] = Column(array[()])

    group.visititems(look)
    return columns, images


def _blocks(array: Any) -> Iterator[Any]:
    rows = max(1, BLOCK_BYTES // int(np.prod(array.shape[1:])))
    for first in range(0, len(array), rows):
        yield array[first : first + rows]


def _files(array: Any) -> Iterator[bytes]:
    """Yields JPEG or PNG files, which ALOHA pads with zeros to one length."""
    for row in range(len(array)):
        yield bytes(np.asarray(array[row]).view(np.uint8)).rstrip(b"\0")


def _open(file: Path) -> Any:
    try:
        return h5py.File(file)
    except OSError as error:
        raise IoError(f"cannot read '{file}': {error}") from error


def _settings(text: Any, file: Path) -> dict[str, Any]:
    try:
        found = json.loads(_text(text))
    except ValueError as error:
        raise ArgumentError(f"'{file}': the attribute env_args is no JSON: {error}") from error
    return found if isinstance(found, dict) else {}


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def _number(name: str) -> tuple[int, str]:
    """Returns a key by which demo_2 comes before demo_10."""
    digits = re.search(r"(\d+)$", name)
    return (int(digits[1]) if digits else -1, name)
