"""Reads the zarr replay buffers of Diffusion Policy and UMI."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import ArgumentError, IoError
from robocell._extras import needed_by
from robocell.importer._recording import Clip, Column, Recording, Stills

with needed_by("robocell.importer", "export"):
    import zarr

BLOCK_BYTES = 16 << 20  # of images in memory


class ReplayBuffer:
    """A replay buffer; see `recording.Origin`."""

    title = "zarr replay buffer"
    rate: Fraction | None = None
    robots = ""

    def __init__(self, place: Path) -> None:
        try:
            store = zarr.storage.ZipStore(place, mode="r") if place.suffix == ".zip" else str(place)
            root: Any = zarr.open_group(store, mode="r")
            self._data: Any = root["data"]
            self._ends: Any = root["meta/episode_ends"][:]
        except (OSError, KeyError, ValueError) as error:
            raise IoError(
                f"'{place}' is no replay buffer with data and meta/episode_ends: {error}"
            ) from error
        for name, array in self._data.arrays():
            if array.shape[0] < self._ends[-1]:
                raise IoError(
                    f"'{place}': data/{name} has {array.shape[0]} rows, the last episode ends at "
                    f"{self._ends[-1]}: it is damaged"
                )

    def __len__(self) -> int:
        return len(self._ends)

    def read(self, index: int) -> Recording:
        """Reads an episode."""
        first = int(self._ends[index - 1]) if index else 0
        last = int(self._ends[index])
        columns: dict[str, Column] = {}
        images: dict[str, Clip | Stills] = {}
        for name, array in sorted(self._data.arrays()):
            if array.dtype == np.uint8 and array.ndim == 4 and array.shape[3] == 3:
                images[name] = Stills(_blocks(array, first, last))
            elif np.dtype(array.dtype).kind in "fiub":
                columns[name] = Column(array[first:last])
        if not columns:
            raise ArgumentError("the replay buffer has no arrays of numbers")
        return Recording("", last - first, columns, images, {"episode": index})

    def column_name(self, name: str) -> str | None:
        """Returns "observation/state" for state; the action keeps its name."""
        return name if name == "action" else f"observation/{name}"


def _blocks(array: Any, first: int, last: int) -> Iterator[Any]:
    rows = max(1, BLOCK_BYTES // int(np.prod(array.shape[1:])))
    for row in range(first, last, rows):
        yield array[row : min(last, row + rows)]
