"""Disks that are really full, and folders that really cannot be written."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from ledger import BUILD

# In namespaces of its own, so that nothing stays when it ends; it mounts again for each new size.
_HOLD = """
mount -t tmpfs -o size="$1" small "$0" && echo mounted
while read -r size; do mount -o remount,size="$size" "$0" && echo grown; done
"""
_ENOUGH = 32 << 20
_AS_ROOT, _AS_USER = ["--mount"], ["--map-root-user", "--mount"]


@dataclass
class SmallDisk:
    """A file system with little room.

    Attributes:
        folder: Where it is.
        environment: For programs that are to write to it.
    """

    folder: Path
    environment: dict[str, str] = field(default_factory=dict)
    holder: subprocess.Popen[str] | None = None

    def grow(self, size: str) -> None:
        """Gives it more room."""
        self.environment = {}
        if self.holder:
            _tell(self.holder, size, "grown")


@contextmanager
def small_disk(mount: Path, kilobytes: int) -> Iterator[SmallDisk]:
    """A tmpfs; where none may be mounted, a folder where Python meets ENOSPC after so much."""
    mount.mkdir()
    for namespaces in (_AS_ROOT, _AS_USER):
        holder = subprocess.Popen(
            ["unshare", *namespaces, "sh", "-c", _HOLD, mount, f"{kilobytes}k"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        try:
            if _answer(holder) == "mounted":
                yield SmallDisk(Path(f"/proc/{holder.pid}/root{mount}"), holder=holder)
                return
        finally:
            _pipe(holder.stdin).close()
            holder.wait()
            _pipe(holder.stdout).close()
    count = mount.with_suffix(".count")
    count.write_bytes(bytes(8))
    shim = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": Path(sys.executable).name,
        "FAULT_UNDER": str(mount),
        "FAULT_SHARED": str(count),
        "FAULT_AT": f"{kilobytes << 10} bytes",
        "FAULT_DO": "full",
    }
    yield SmallDisk(mount, shim)


@contextmanager
def quick_folder(otherwise: Path) -> Iterator[Path]:
    """In memory where there is room, for faults that are made: flushing real disks takes long."""
    memory = Path("/dev/shm")
    if not os.access(memory, os.W_OK) or shutil.disk_usage(memory).free < _ENOUGH:
        yield otherwise
        return
    with tempfile.TemporaryDirectory(prefix="robocell-", dir=memory) as folder:
        yield Path(folder)


def bound_by_permissions(command: list[str]) -> list[str]:
    """The command such that the permissions of files hold for it, if it is root's too."""
    if os.geteuid() != 0:
        return command
    passing = "-dac_override,-dac_read_search"
    return ["setpriv", f"--bounding-set={passing}", f"--inh-caps={passing}", *command]


def _pipe(pipe: IO[str] | None) -> IO[str]:
    assert pipe is not None
    return pipe


def _answer(holder: subprocess.Popen[str]) -> str:
    return _pipe(holder.stdout).readline().strip()


def _tell(holder: subprocess.Popen[str], line: str, answer: str) -> None:
    print(line, file=_pipe(holder.stdin), flush=True)
    assert _answer(holder) == answer
