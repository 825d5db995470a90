"""Memory and time of processes, as the kernel counts them.

    with MemoryWatch(children_peak_bytes) as watch:
        encode()
    watch.bytes  # peak memory of the children of this process, together
    peak_bytes()  # peak memory of this process
    age_s()  # age of this process

`getrusage` would count the memory that a child shared with us before it executed a program.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

LOOK_EVERY_S = 0.05


def peak_bytes(pid: int | str = "self") -> int:
    """Returns the peak memory of a process; 0 if it has ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    found = (line for line in lines if line.startswith("VmHWM:"))
    return sum(int(line.split()[1]) for line in found) * 1024  # there is one


def children(pid: int) -> list[int]:
    """Returns the child processes that have executed a program.

    A child that has not executed its program yet still shares its parent's memory.
    """
    own = _command(pid)
    return [child for child in _started_by(pid) if _command(child) not in (own, b"")]


def age_s() -> float:
    """Returns the age of this process in seconds, including the start of Python."""
    started = int(_stat("self")[19]) / os.sysconf("SC_CLK_TCK")
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started


def children_peak_bytes() -> int:
    """Returns the sum of `peak_bytes` over all children of this process."""
    return sum(map(peak_bytes, children(os.getpid())))


def _started_by(pid: int) -> list[int]:
    """Returns the kernel's lists of children, one for each thread; else by the parents of all."""
    try:
        lists = [path.read_text() for path in Path(f"/proc/{pid}/task").glob("*/children")]
    except OSError:
        lists = []  # a thread ended meanwhile
    if lists:
        return [int(child) for text in lists for child in text.split()]
    return _with_parent(pid)


def _with_parent(pid: int) -> list[int]:
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            parent = int(_stat(entry.name)[1])
        except OSError:
            continue  # it ended
        if parent == pid:
            found.append(int(entry.name))
    return found


def _stat(pid: str) -> list[str]:
    """Returns the fields after the name, proc(5)'s third and up."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()


def _command(pid: int) -> bytes:
    """Words of its command line; b"" when it is gone."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""


class MemoryWatch:
    """Samples a byte count repeatedly and keeps the maximum; see above.

    Args:
        count: Function that returns the present count, such as `children_peak_bytes`.

    Attributes:
        bytes: Largest sample.
    """

    def __init__(self, count: Callable[[], int]) -> None:
        self.bytes = 0
        self._count = count
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> MemoryWatch:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._stop.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._stop.wait(LOOK_EVERY_S):
            self.bytes = max(self.bytes, self._count())
