"""HDF5 files that a full disk makes an error of, and nothing worse.

The HDF5 library cannot close a file that it fails to write, and the process crashes when it ends.
So the library writes through `_Guarded`, which keeps in memory what the disk did not take, until
the library has closed the file. The error is raised after the first dataset that did not fit.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._extras import needed_by
from robocell.export._images import blocks, depth_blocks
from robocell.export._source import Camera, Item, Source

with needed_by("robocell.export", "export"):
    import h5py

# Every HDF5 library has gzip. The bytes of lzf, which is faster, differ from run to run.
COMPRESSED: dict[str, Any] = {"compression": "gzip", "compression_opts": 1}


class Writer:
    """Adds datasets to a new file, or to one of its groups.

    Attributes:
        group: The group, for attributes and copies; `check` follows what is done with it.
    """

    def __init__(self, group: Any, guarded: _Guarded) -> None:
        self.group = group
        self._guarded = guarded

    def check(self) -> None:
        """Raises the OSError of the first write that failed."""
        if self._guarded.error is not None:
            raise self._guarded.error

    def inside(self, name: str) -> Writer:
        """Makes a group, and returns its writer."""
        return Writer(self.group.create_group(name), self._guarded)

    def add(self, name: str, values: Any, *, compressed: bool = False) -> None:
        """Adds a dataset, whose groups need not exist."""
        self.group.create_dataset(name, data=values, **(COMPRESSED if compressed else {}))
        self.check()

    def add_images(self, name: str, source: Source, item: Item, camera: Camera) -> None:
        """Adds a dataset with the images of an episode, one image per chunk."""
        height, width = source.shape_of(camera)
        shape = (item.rows, height, width, 3)
        dataset = self.group.create_dataset(
            name, shape, np.uint8, chunks=(1, height, width, 3), **COMPRESSED
        )
        for row, block in blocks(source, item, camera):
            _put(dataset, row, block)
            self.check()

    def add_depth(self, name: str, source: Source, item: Item, camera: Camera) -> None:
        """Adds a dataset with the depth of an episode in metres, one image per chunk."""
        one = (camera.height, camera.width, 1)
        dataset = self.group.create_dataset(
            name, (item.rows, *one), np.float32, chunks=(1, *one), **COMPRESSED
        )
        dataset.attrs["unit"] = "m"
        for row, block in depth_blocks(source, item, camera):
            _put(dataset, row, block.astype(np.float32) / 1000)
            self.check()


@contextmanager
def new_file(path: Path) -> Iterator[Writer]:
    """Writes a new file inside the block.

    Raises:
        OSError: The file cannot be written.
    """
    with FileIO(path, "w+") as raw:
        guarded = _Guarded(raw)
        with h5py.File(guarded, "w") as file:
            writer = Writer(file, guarded)
            yield writer
        writer.check()


def _put(dataset: Any, row: int, block: NDArray[Any]) -> None:
    dataset[row : row + len(block)] = block


class _Guarded:
    """A file for h5py whose writes never fail.

    Attributes:
        error: Of the first write that failed. That one and all later ones are kept in memory.
    """

    def __init__(self, raw: FileIO) -> None:
        self.error: OSError | None = None
        self._raw = raw
        self._place = 0
        self._size = 0
        self._kept: list[tuple[int, bytes]] = []

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Moves to a place."""
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        self._place = start + offset
        return self._place

    def tell(self) -> int:
        """Returns the place."""
        return self._place

    def write(self, data: Any) -> int:
        """Writes at the place."""
        view = memoryview(data).cast("B")
        if self.error is None:
            try:
                self._write(view)
            except OSError as error:
                self.error = error
        if self.error is not None:
            self._kept.append((self._place, bytes(view)))
        self._place += len(view)
        self._size = max(self._size, self._place)
        return len(view)

    def _write(self, view: memoryview) -> None:
        self._raw.seek(self._place)
        done = 0
        while done < len(view):
            done += self._raw.write(view[done:]) or 0

    def read(self, size: int) -> bytes:
        """Reads at the place."""
        into = bytearray(size)
        self.readinto(into)
        return bytes(into)

    def readinto(self, into: Any) -> int:
        """Reads at the place, also what is kept in memory."""
        view = memoryview(into).cast("B")
        view[:] = bytes(len(view))
        self._raw.seek(self._place)
        done = 0
        while done < len(view) and (count := self._raw.readinto(view[done:])):
            done += count
        for place, data in self._kept:
            first = max(place, self._place)
            last = min(place + len(data), self._place + len(view))
            if first < last:
                view[first - self._place : last - self._place] = data[first - place : last - place]
        self._place += len(view)
        return len(view)

    def truncate(self, size: int) -> int:
        """Sets the size."""
        self._size = size
        if self.error is None:
            try:
                self._raw.truncate(size)
            except OSError as error:
                self.error = error
        return size

    def flush(self) -> None:
        """Does nothing: the folder of the export is flushed as a whole."""
