"""Brings files and folders to the disk, so that a power cut does not undo what was said to be done.

A file is on the disk when its bytes are flushed and the entry of its name in its folder, which
needs a flush of its own. `_core.atomic_write` does both for a small file.
"""

from __future__ import annotations

import errno
import itertools
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Disks and journals take what several threads flush at once in one go.
THREADS, BATCH = 8, 1024
# Some network file systems have no flush for folders: their entries need none.
NO_FLUSH = (errno.EINVAL, errno.ENOTSUP)


def flush_path(path: Path) -> None:
    """Brings a file, or the entries of a folder, to the disk. Raises OSError."""
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    except OSError as error:
        if error.errno not in NO_FLUSH or not path.is_dir():
            raise OSError(error.errno, f"cannot flush '{path}': {error.strerror}") from error
    finally:
        os.close(number)


def flush_all(paths: Iterable[Path]) -> None:
    """Brings files and folders to the disk. Raises OSError."""
    rest = iter(paths)
    some = list(itertools.islice(rest, THREADS))
    if len(some) < THREADS:
        for path in some:
            flush_path(path)
        return
    with ThreadPoolExecutor(THREADS) as threads:
        while some:  # not all at once: there may be millions
            for _ in threads.map(flush_path, some):
                pass
            some = list(itertools.islice(rest, BATCH))


def flush_folder(folder: Path, without: str = "") -> None:
    """Brings every byte below a folder to the disk, apart from a folder in it. Raises OSError."""
    flush_all(_tree(folder, without))


def _tree(folder: Path, without: str) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        if Path(place) == folder and without in folders:
            folders.remove(without)
        yield from (Path(place) / name for name in files)
        yield Path(place)


def make_folders(folder: Path) -> None:
    """Makes a folder and the missing ones above it, whose entries are flushed. Raises OSError."""
    made = []
    above = folder.absolute()
    while not above.exists():
        made.append(above)
        above = above.parent
    folder.mkdir(parents=True, exist_ok=True)
    for each in made:
        if os.access(each.parent, os.R_OK):
            flush_path(each.parent)
