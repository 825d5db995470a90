"""Can the dataset's disk take another episode?"""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from robocell import IoError, _core

Made = TypeVar("Made")

# Less than this is as good as full: an episode with videos is a few megabytes.
FREE_BYTES_NEEDED = 16 << 20
PROBE_BYTES = 64 << 10
FULL = "is full"
ADVICE = "Make room and try again."  # see base/io_error.cc


def free_bytes(folder: Path) -> int:
    """Returns the free bytes for a folder that may not exist yet."""
    return shutil.disk_usage(_nearest(folder)).free


def _nearest(folder: Path) -> Path:
    """Returns the folder itself, or its nearest existing parent."""
    absolute = folder.absolute()
    return next(path for path in (absolute, *absolute.parents) if path.exists())


def require_no_file(folder: Path, place: str = "") -> None:
    """Raises IoError if a file has the path of the folder, which may not exist yet.

    `place` begins the message.
    """
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise IoError(
                f"{place}output '{folder}': '{path}' is a file, and a dataset is a folder. Name "
                "another one (--output), or move the file away"
            )


def require_writable(folder: Path, place: str = "") -> None:
    """Raises IoError if the folder, or the nearest existing parent, is not writable.

    Tries it with an empty folder, which it removes again. `place` begins the message.
    """
    require_no_file(folder, place)
    there = _nearest(folder)
    try:
        probe, _ = _probe(there, Path.mkdir)
        with contextlib.suppress(FileNotFoundError):  # another run has tidied up
            probe.rmdir()
    except OSError as error:
        reason = error.strerror or str(error)
        if isinstance(error, FileNotFoundError):  # as /proc says, which is there
            reason = "no folder can be made there"
        raise IoError(
            f"{place}output '{folder}': cannot write into '{there}': {reason}. Name "
            "another one (--output), or make that folder writable"
        ) from error


def _probe(folder: Path, make: Callable[[Path], Made]) -> tuple[Path, Made]:
    """Returns the path of the test folder; cleaning removes it like other unfinished writes.

    A process with the same id in another container may use it, or have left one.
    """
    while True:
        path = _core.temporary_path(folder, "probe")
        with contextlib.suppress(FileExistsError):
            return path, make(path)


def with_trouble(message: str, trouble: str) -> str:
    """Returns the text of a worker's failure and `disk_trouble`, with the free space once."""
    has_advice = ADVICE in message and FULL in trouble
    return message if has_advice else f"{message}\n{trouble}"


def disk_trouble(folder: Path) -> str | None:
    """Returns why the folder is not writable, or None. Tries it with a small file."""
    try:
        free = shutil.disk_usage(folder).free
        if free < FREE_BYTES_NEEDED:
            return f"the disk of '{folder}' {FULL}: {free >> 10} kB are free"
        probe, file = _probe(folder, lambda path: path.open("xb"))
        try:
            with file:
                file.write(bytes(PROBE_BYTES))
                file.flush()
                os.fsync(file.fileno())
        finally:
            with contextlib.suppress(OSError):
                probe.unlink()
    except OSError as error:
        return f"cannot write into '{folder}': {error.strerror or error}"
    return None
