"""Arrays of HDF5 and zarr files: which are images or numbers, and how they are read in bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, IoError
from robocell.importer._foreign_files import ADVICE, reading

BLOCK_BYTES = 16 << 20  # of images in memory
LARGEST_COLUMN = 2 << 30  # bytes of a column of one episode
LARGEST_SIDE = 8192  # pixels


def is_pixels(array: Any) -> bool:
    """Whether an array has images, (n, height, width, 3)."""
    return array.dtype == np.uint8 and array.ndim == 4 and array.shape[3] == 3


def is_numbers(array: Any) -> bool:
    """Whether an array has numbers, with a row for each step."""
    return array.ndim > 0 and np.dtype(array.dtype).kind in "fiub"


def numbers(array: Any, first: int, last: int, place: str) -> NDArray[Any]:
    """Returns rows of an array.

    Raises:
        IoError: They cannot be read, or are more than one episode can have.
    """
    _require_size(array, (last - first, *array.shape[1:]), place)
    with reading(place):
        return np.asarray(array[first:last])


def pixels(array: Any, first: int, last: int, place: str) -> Iterator[NDArray[np.uint8]]:
    """Yields images in blocks of a few megabytes."""
    height, width = map(int, array.shape[1:3])
    if not (0 < height <= LARGEST_SIDE and 0 < width <= LARGEST_SIDE):
        raise ArgumentError(
            f"{place} has images of {width}x{height} pixels; at most {LARGEST_SIDE} on a side. A "
            "mapping file leaves the camera out: --mapping FILE"
        )
    rows = max(1, BLOCK_BYTES // (height * width * 3))
    _require_size(array, (min(rows, last - first), height, width, 3), place)
    for row in range(first, last, rows):
        with reading(place):
            block = np.asarray(array[row : min(last, row + rows)])
        yield block


def _require_size(array: Any, shape: tuple[int, ...], place: str) -> None:
    """Raises IoError if what is read at once, or a chunk of it, is empty or too large."""
    for each in (shape, getattr(array, "chunks", None)):
        if each is None:
            continue
        size = math.prod(map(int, each)) * np.dtype(array.dtype).itemsize
        if not 0 < size <= LARGEST_COLUMN:
            raise IoError(
                f"{place} has the shape {tuple(map(int, each))} in an episode; expected 1 byte to "
                f"{LARGEST_COLUMN >> 30} GiB: {ADVICE}. A mapping file leaves it out: "
                "--mapping FILE"
            )
