"""How much memory the processes take that this one started. No test in itself."""

from __future__ import annotations

import os
from pathlib import Path

from robocell.generate.procfs import children


def descendants(pid: int) -> list[int]:
    """Children, their children, and so on."""
    return [found for child in children(pid) for found in (child, *descendants(child))]


def resident_bytes(pid: int) -> int:
    """Of one process; 0 when it is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0


def all_resident_bytes() -> int:
    """Memory of all processes that this one started."""
    return sum(map(resident_bytes, descendants(os.getpid())))
