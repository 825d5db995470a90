"""How much memory the processes take that this one started. No test in itself."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from robocell._generation.procfs import children


def descendants(pid: int) -> list[int]:
    """Children, their children, and so on."""
    return [found for child in children(pid) for found in (child, *descendants(child))]


def resident_bytes(pid: int) -> int:
    """Of one process; 0 when it is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0


def resident_bytes_from_now() -> Callable[[], int]:
    """Returns a function that counts the memory of the processes started from now on.

    Earlier tests of this process may have left some that go on, such as a command server.
    """
    earlier = set(descendants(os.getpid()))

    def count() -> int:
        started = set(descendants(os.getpid())) - earlier
        return sum(map(resident_bytes, started))

    return count
