"""A folder for what is made to know what a run takes; nothing of it stays.

    with probe_folder() as folder:
        ...  # write into it

Also sweeps away what commands that were killed have left. The living hold a lock in theirs.
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
    """An empty folder but for its lock, among the system's temporary ones."""
    _sweep(Path(tempfile.gettempdir()))
    folder, lock = _make()
    with closing(lock):
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _make() -> tuple[Path, BinaryIO]:
    """Between its making and its locking a folder looks like one that was left; then another."""
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
    """False when somebody else has it; OSError on a file system without locks."""
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
