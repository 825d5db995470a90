"""The folder in which a result is made, and which becomes the result by one rename.

It lies beside the result, under a hidden name, and stays behind when the command is killed or the
power fails; the same command continues in it, another one begins anew. A command that is refused
before its first episode leaves none.

Two ways tell the next command that a part is complete: a value that was kept (`keep`), and a file
that was put in place (`put`). Both flush first what was written until then, so neither is on the
disk without it. That a file exists means nothing otherwise: its bytes may be missing.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from robocell import _core
from robocell._core import ArgumentError, IoError
from robocell._durable import flush_all, flush_folder, flush_path, make_folders

STATE = ".state"


class Staging:
    """Where a result is made.

    Attributes:
        folder: The hidden folder.
        out: Its name when it is complete.
        has_episodes: Whether it has anything that another command can continue. `keep` sets it.
        unflushed_bytes: Size of the copies that `add` got since the last flush.
    """

    def __init__(self, folder: Path, out: Path) -> None:
        self.folder = folder
        self.out = out
        self.has_episodes = False
        self.unflushed_bytes = 0
        self._written: dict[Path, None] = {}  # since the last flush

    def state(self, name: str) -> Any:
        """Returns what a killed command has kept under a name; None without it."""
        file = self.folder / STATE / f"{name}.json"
        return json.loads(file.read_text()) if file.exists() else None

    def keep(self, name: str, content: Any) -> None:
        """Keeps a value for the command that continues this one, after all that was written."""
        self.flush()
        self.has_episodes = True
        text = json.dumps(content)
        _core.atomic_write(self.folder / STATE / f"{name}.json", text.encode())

    def path(self, name: str) -> Path:
        """Returns the path of a file to write, whose folders exist."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        self.wrote([path])
        return path

    def scratch(self, name: str) -> Path:
        """Returns the path of a file or folder that the result will not have."""
        path = self.folder / STATE / name
        self.wrote([path])
        return path

    def wrote(self, paths: Iterable[Path]) -> None:
        """Notes more files and folders that are written, such as those in a scratch folder."""
        self._written.update(dict.fromkeys(paths))

    def add(self, partial: Path, folder: Path) -> None:
        """Gives a folder its name; a value that is kept later says that it is complete."""
        partial.rename(folder)
        for path in (folder, *folder.rglob("*")):
            self.wrote([path])
            status = path.stat()
            if status.st_nlink == 1:  # no link to a file of another dataset
                self.unflushed_bytes += status.st_size

    def put(self, partial: Path, target: Path) -> None:
        """Gives a file its name, under which it is complete, after all that was written."""
        self.flush()
        os.replace(partial, target)

    def flush(self) -> None:
        """Brings what was written to the disk, with the entries of its folders."""
        there = [path for path in self._written if path.exists()]
        folders = {above for path in there for above in path.parents}
        flush_all([*there, *(each for each in folders if each.is_relative_to(self.folder))])
        self._written.clear()
        self.unflushed_bytes = 0

    def commit(self) -> None:
        """Gives the folder its final name, when every byte is on the disk."""
        flush_folder(self.folder, without=STATE)
        _forget(self.folder)
        shutil.rmtree(self.folder / STATE)
        flush_path(self.folder)
        _require_absent(self.out)
        self.folder.rename(self.out)
        flush_path(self.out.parent)


@contextmanager
def staging(out: Path, request: dict[str, Any]) -> Iterator[Staging]:
    """The folder of a result, which belongs to this process inside the block.

    Args:
        out: The result.
        request: What is made; a command with another request begins anew.

    Raises:
        ArgumentError: The result exists, or another process makes it.
        IoError: The folder cannot be written.
    """
    _require_absent(out)
    hidden = out.parent / f".{out.name}.partial"
    digest = hashlib.sha256(json.dumps(request, sort_keys=True).encode()).hexdigest()
    try:
        make_folders(hidden)
        lock = os.open(hidden, os.O_RDONLY | os.O_DIRECTORY)
    except OSError as error:
        raise IoError(f"cannot write '{hidden}': {error.strerror}") from error
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ArgumentError(
                f"another process makes '{out}'. Wait for it, or choose another name"
            ) from error
        whole = Staging(hidden, out)
        whole.has_episodes = whole.state("request") == digest
        if not whole.has_episodes:
            _forget(hidden)
            for entry in hidden.iterdir():
                shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
            (hidden / STATE).mkdir()
            flush_path(
                hidden
            )  # a new request beside files of another one would take them for its own
            whole.keep("request", digest)
            whole.has_episodes = False
        try:
            yield whole
        except Exception as error:
            is_of_disk = isinstance(error, OSError) and not isinstance(error, IoError)
            if not (whole.has_episodes or is_of_disk):
                shutil.rmtree(hidden, ignore_errors=True)
            raise
    finally:
        os.close(lock)


def _forget(hidden: Path) -> None:
    """Makes what is kept worthless before it is removed, piece by piece and in any order."""
    request = hidden / STATE / "request.json"
    if request.exists():
        request.unlink()
        flush_path(request.parent)


def _require_absent(out: Path) -> None:
    if not os.path.lexists(out) or (out.is_dir() and not any(out.iterdir())):
        return
    what = "a folder that is not empty" if out.is_dir() else "a file"
    raise ArgumentError(
        f"'{out}' exists already, {what}. Choose another name, or remove it; nothing is replaced"
    )
