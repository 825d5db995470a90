"""Can the dataset's disk take another episode?"""

from __future__ import annotations

import contextlib
import os
import shutil
from pathlib import Path

from robocell import IoError

# Less than this is as good as full: an episode with videos is a few megabytes.
FREE_BYTES_NEEDED = 16 << 20
PROBE_BYTES = 64 << 10


def free_bytes(folder: Path) -> int:
    """What the disk has room for, of a folder that need not exist yet."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    return shutil.disk_usage(there).free


def require_no_file(folder: Path) -> None:
    """IoError when a file stands where the folder, which need not exist yet, is to be."""
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise IoError(
                f"output '{folder}': '{path}' is a file, and a dataset is a folder. Name another "
                "one (--output), or move the file away"
            )


def disk_trouble(folder: Path) -> str | None:
    """Why nothing can be written into the folder, or None. Tries it with a small file."""
    probe = folder / f".probe.{os.getpid()}"
    try:
        free = shutil.disk_usage(folder).free
        if free < FREE_BYTES_NEEDED:
            return f"the disk of '{folder}' is full: {free >> 10} kB are free"
        with probe.open("xb") as file:
            file.write(bytes(PROBE_BYTES))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return f"cannot write into '{folder}': {error.strerror or error}"
    finally:
        with contextlib.suppress(OSError):
            probe.unlink()
    return None
