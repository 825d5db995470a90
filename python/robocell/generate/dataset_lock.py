"""Keeps two runs from making the same episodes: a lock file in the dataset's folder.

The whole plan is locked exclusively; the shards of a plan share the folder and lock themselves.
The system frees the locks of a process that is killed.
"""

from __future__ import annotations

import fcntl
import os
from pathlib import Path
from types import TracebackType


class DatasetBusyError(Exception):
    """Another process generates into this folder."""


class DatasetLock:
    """`with DatasetLock(dataset, shard, count):` DatasetBusyError when it is taken.

    Args:
        dataset: Existing folder.
        shard: Which part of the plan.
        count: How many parts; 1 for the whole plan.
    """

    def __init__(self, dataset: Path, shard: int = 0, count: int = 1) -> None:
        self._dataset = dataset
        self._wanted = [(".lock", fcntl.LOCK_EX if count == 1 else fcntl.LOCK_SH)]
        if count > 1:
            self._wanted.append((f".lock-{shard}-of-{count}", fcntl.LOCK_EX))
        self._held: list[int] = []

    def __enter__(self) -> DatasetLock:
        for name, mode in self._wanted:
            self._take(self._dataset / name, mode)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        while self._held:
            os.close(self._held.pop())

    def _take(self, path: Path, mode: int) -> None:
        fd = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        self._held.append(fd)
        try:
            fcntl.flock(fd, mode | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.read(fd, 200).decode(errors="replace").strip()
            self.__exit__(None, None, None)
            by = f" by {owner}" if owner else ""
            raise DatasetBusyError(
                f"'{self._dataset}' is being generated{by}. Wait for it, stop it, "
                "or give another --output"
            ) from None
        if mode == fcntl.LOCK_EX:
            os.ftruncate(fd, 0)
            os.pwrite(fd, f"process {os.getpid()} on {os.uname().nodename}\n".encode(), 0)
