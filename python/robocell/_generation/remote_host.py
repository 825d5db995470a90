"""The side of another machine: runs one worker process there, for a supervisor elsewhere.

`RemoteWorker` calls these methods, each in a thread of its own. A machine that sees the folder of
the dataset writes there; others write to their own disk, and the episodes are fetched in pieces.
"""

from __future__ import annotations

import fcntl
import json
import os
import select
import shutil
import socket
import stat
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from robocell._generation import pieces, work
from robocell._generation.items import Item
from robocell._generation.own_process import own_environment
from robocell._generation.protocol import Failure, ProtocolError
from robocell._generation.run_source import RunSource
from robocell._generation.worker_process import WorkerProcess

PREFIX = "robocell-remote-"
LOCK = ".lock"
MANIFEST = "dataset.json"


@dataclass(frozen=True)
class RemoteJob:
    """What another machine needs to know to make episodes.

    Attributes:
        source: The run, with absolute paths: the same on all machines.
        overrides: Replaced fields.
        folder: The working folder of the command.
        dataset: The dataset.
        token: A file below `dataset` that only machines see which share the folder.
        manifest: Content of its dataset.json, which tells runs apart.
        fetch: True if episodes are fetched even from machines that share the folder.
    """

    source: RunSource
    overrides: tuple[str, ...]
    folder: str
    dataset: str
    token: str
    manifest: str
    fetch: bool = False

    def shares_folder(self) -> bool:
        """Returns True if this machine sees the folder of the dataset."""
        return (Path(self.dataset) / self.token).is_file()


class RemoteHost:
    """Runs one worker process."""

    def __init__(self) -> None:
        self._worker: WorkerProcess | None = None
        self._folder: Path | None = None
        self._own: tuple[Path, BinaryIO] | None = None

    def start(self, job: RemoteJob, number: int, environment: Mapping[str, str]) -> dict[str, Any]:
        """Starts the worker. Returns its pid, its machine, and whether episodes are fetched.

        Returns {"refused": ...} if this machine lacks the run's files.
        """
        node = socket.gethostname()
        try:
            fetches = job.fetch or not job.shares_folder()
            _enter(job.folder, node)
            self._own = _own_folder()
            self._folder = self._own[0] / "dataset" if fetches else Path(job.dataset)
            if fetches:
                self._folder.mkdir()
                (self._folder / MANIFEST).write_text(job.manifest)
            log = self._own[0] / "worker.log"
            command = self._command(job, self._folder)
            self._worker = WorkerProcess(number, command, log, {**own_environment(), **environment})
        except OSError as error:
            failure = Failure("io", f"machine '{node}': {error}")
            return {"refused": failure.to_json()}
        return {"pid": self._worker.pid, "node": node, "fetches": fetches}

    def _command(self, job: RemoteJob, dataset: Path) -> list[str]:
        output = f"output={json.dumps(str(dataset))}"
        return work.command(job.source, [*job.overrides, output])

    @property
    def worker(self) -> WorkerProcess:
        """The worker process."""
        assert self._worker is not None
        return self._worker

    @property
    def dataset(self) -> Path:
        """Where this machine writes the episodes."""
        assert self._folder is not None
        return self._folder

    def listen(self, longest_s: float) -> tuple[list[dict[str, Any]], bool]:
        """Returns new messages of the worker, and True after the last one."""
        select.select([self.worker], [], [], longest_s)
        try:
            messages = self.worker.messages()
            return ([], True) if messages is None else (list(messages), False)
        except ProtocolError as error:
            self.worker.kill(str(error))
            return [], False

    def hand(self, item: Mapping[str, Any]) -> None:
        """Gives the worker an item."""
        self.worker.hand(Item.from_json(item))

    def stop(self) -> None:
        """Asks the worker to end its item quickly and exit."""
        self.worker.stop()

    def finish(self) -> None:
        """Ends the work of the worker, which then exits."""
        self.worker.finish()

    def kill(self, reason: str, hangs: bool) -> None:
        """Kills the worker; one that hangs writes its stacks first."""
        (self.worker.kill_hanging if hangs else self.worker.kill)(reason)

    def bury(self) -> tuple[str, str, str]:
        """Returns how the worker ended, its whole log, and the end of its log."""
        how, tail = self.worker.bury(), self.worker.log_tail()
        log = self.worker.log.read_text(errors="replace")
        if self._own is not None:
            folder, lock = self._own
            shutil.rmtree(folder, ignore_errors=True)
            lock.close()
        return how, log, tail

    def listing(self, item_id: str) -> list[pieces.Folder]:
        """Returns the folders of an item's episodes."""
        return pieces.listing(self.dataset, item_id)

    def read(self, folder: pieces.Folder, offset: int, size: int) -> bytes:
        """Returns a piece of a folder."""
        return pieces.read(self.dataset, folder, offset, size)

    def forget(self, episodes: list[str]) -> None:
        """Removes episodes that were fetched."""
        for name in episodes:
            shutil.rmtree(self.dataset / name, ignore_errors=True)


def _enter(folder: str, node: str) -> None:
    try:
        os.chdir(folder)
    except OSError as error:
        raise OSError(
            f"cannot enter the working folder '{folder}' ({error.strerror}). The run's files need "
            "the same paths on all machines: use one image or a shared folder, or submit the "
            f"command with `ray job submit --working-dir`; without '{node}', the run works"
        ) from error


def _own_folder() -> tuple[Path, BinaryIO]:
    """Makes and locks a folder, and removes those of processes that were killed."""
    for left in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with suppress(OSError):  # it went away, is in use, or belongs to somebody else
            status = left.lstat()
            if stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid():
                with open(os.open(left / LOCK, os.O_RDWR | os.O_NOFOLLOW), "rb") as held:
                    fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    shutil.rmtree(left)
    folder = Path(tempfile.mkdtemp(prefix=PREFIX))
    # It gets its name when it is held, so that no other process takes the folder for a leftover.
    lock = (folder / f"{LOCK}.new").open("xb")
    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    (folder / f"{LOCK}.new").rename(folder / LOCK)
    return folder, lock
