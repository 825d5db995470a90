"""The files of episodes: on their own, or inside the shards of a packed dataset.

In a packed dataset the folder of an episode does not exist. Its path still names the episode, and
these functions find the bytes.
"""

from __future__ import annotations

import errno
import io
import os
from pathlib import Path

from robocell import _core

BUFFER = 1 << 17


class _Part(io.RawIOBase):
    """Bytes of a file as a file of their own, for reading."""

    def __init__(self, shard: Path, begin: int, size: int) -> None:
        self._file = shard.open("rb", buffering=0)
        self._begin, self._size, self._at = begin, size, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size}[whence]
        self._at = max(base + offset, 0)
        return self._at

    def readinto(self, buffer: object) -> int:
        view = memoryview(buffer).cast("B")  # type: ignore[arg-type]
        view = view[: max(self._size - self._at, 0)]
        self._file.seek(self._begin + self._at)
        count = self._file.readinto(view) or 0
        if view and not count:
            raise OSError(errno.EIO, f"'{self._file.name}' is cut short")
        self._at += count
        return count

    def close(self) -> None:
        if not self.closed:
            self._file.close()
        super().close()


def open_stored(file: Path) -> io.BufferedReader:
    """Opens a file of an episode for reading. Raises OSError like `open`."""
    part = _core.packed_part(file)
    if part is None:
        return file.open("rb")
    return io.BufferedReader(_Part(*part), BUFFER)


def read_stored(file: Path) -> bytes:
    """Returns the content of a file of an episode. Raises OSError like `open`."""
    with open_stored(file) as content:
        return content.read()


def stored_bytes(file: Path) -> int:
    """Returns the size of a file of an episode. Raises OSError without one."""
    part = _core.packed_part(file)
    return file.stat().st_size if part is None else part[2]


def is_stored(file: Path) -> bool:
    """Returns whether there is such a file of an episode."""
    return _core.packed_part(file) is not None or file.is_file()


def version_of(file: Path) -> tuple[int, ...]:
    """Returns numbers that differ when the file was written again. Raises OSError without one."""
    part = _core.packed_part(file)
    place, within = (file, ()) if part is None else (part[0], part[1:])
    state = place.stat()
    return (state.st_ino, state.st_size, state.st_mtime_ns, *within)
