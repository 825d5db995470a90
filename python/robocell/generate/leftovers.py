"""What killed processes left half-written: `.<episode>.<process>.<n>.partial`.

They are invisible to every reader, and harmless; they only take room.
"""

from __future__ import annotations

import contextlib
import re
import shutil
from pathlib import Path


def sweep(dataset: Path, item_id: str | None = None, pid: int | None = None) -> list[str]:
    """Removes what was left behind and returns its names.

    Without item and process everything half-written goes: only for whoever holds the lock of the
    whole dataset. With both, what a dead worker was writing. Process numbers alone are not enough:
    other machines may write into the folder.
    """
    item = re.escape(item_id) + r"(_a\d+)?" if item_id is not None else r".+"
    process = str(pid) if pid is not None else r"\d+"
    name = re.compile(rf"\.{item}\.{process}\.\d+\.partial")
    removed = []
    with contextlib.suppress(OSError):
        for path in sorted(dataset.iterdir()):
            if name.fullmatch(path.name):
                _remove(path)
                if not path.exists():
                    removed.append(path.name)
    return removed


def _remove(path: Path) -> None:
    """A folder with all that is in it, or a file; what resists stays."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            path.unlink()
