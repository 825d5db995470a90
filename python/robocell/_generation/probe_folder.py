"""A temporary folder for the episodes of an estimate.

    with probe_folder() as folder:
        ...  # write into it

Also removes the folders of killed commands. Running processes hold a lock in theirs.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

PREFIX = "robocell-probe-"
LOCK = ".lock"


@contextmanager
def probe_folder() -> Iterator[Path]:
    """Context manager: an empty folder but for its lock, among the temporary ones."""
    _sweep(Path(tempfile.gettempdir()))
    folder, lock = _make()
    with closing(lock):
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _make() -> tuple[Path, BinaryIO]:
    """Makes and locks a folder; another one if it was removed as a leftover before its lock."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=PREFIX))
        lock = (folder / LOCK).open("xb")
        try:
            if _lock(lock) and os.path.samestat(os.stat(folder / LOCK), os.fstat(lock.fileno())):
                return folder, lock
        except FileNotFoundError:
            pass
        except OSError:  # no locks here: nobody sweeps either
            return folder, lock
        lock.close()


def _lock(file: BinaryIO) -> bool:
    """Returns False if another process has it. Raises OSError on a file system without locks."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _sweep(temporary: Path) -> None:
    """Removes folders of this user that no living command holds."""
    for folder in temporary.glob(f"{PREFIX}*"):
        with suppress(OSError):  # it went away, or is none of ours
            status = folder.lstat()
            if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid():
                continue
            with open(os.open(folder / LOCK, os.O_RDWR | os.O_NOFOLLOW), "rb") as lock:
                if _lock(lock):
                    shutil.rmtree(folder)
