"""The folder in which a result is made, and which becomes the result by one rename.

It lies beside the result, under a hidden name, and stays behind when the command is killed; the
same command continues in it, another one begins anew. A command that is refused before its first
episode leaves none.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from robocell import _core
from robocell._core import ArgumentError, IoError

STATE = ".state"


class Staging:
    """Where a result is made.

    Attributes:
        folder: The hidden folder.
        out: Its name when it is complete.
        has_episodes: Whether it has anything that another command can continue. `keep` sets it.
    """

    def __init__(self, folder: Path, out: Path) -> None:
        self.folder = folder
        self.out = out
        self.has_episodes = False

    def state(self, name: str) -> Any:
        """Returns what a killed command has kept under a name; None without it."""
        file = self.folder / STATE / f"{name}.json"
        return json.loads(file.read_text()) if file.exists() else None

    def keep(self, name: str, content: Any) -> None:
        """Keeps a value for the command that continues this one."""
        self.has_episodes = True
        text = json.dumps(content)
        _core.atomic_write(self.folder / STATE / f"{name}.json", text.encode())

    def path(self, name: str) -> Path:
        """Returns the path of a file, whose folders exist."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def scratch(self, name: str) -> Path:
        """Returns the path of a file that the result will not have."""
        return self.folder / STATE / name

    def flush(self, partial: Path) -> None:
        """Does nothing: `commit` flushes all folders."""

    def commit(self) -> None:
        """Gives the folder its final name, when every byte is on the disk."""
        shutil.rmtree(self.folder / STATE)
        flush_folder(self.folder)
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
        hidden.mkdir(parents=True, exist_ok=True)
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
            for entry in hidden.iterdir():
                shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
            (hidden / STATE).mkdir()
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


def _require_absent(out: Path) -> None:
    if not os.path.lexists(out) or (out.is_dir() and not any(out.iterdir())):
        return
    what = "a folder that is not empty" if out.is_dir() else "a file"
    raise ArgumentError(
        f"'{out}' exists already, {what}. Choose another name, or remove it; nothing is replaced"
    )


def flush_folder(folder: Path) -> None:
    """Brings every byte below a folder to the disk."""
    for place, _, files in os.walk(folder):
        for name in (*files, "."):
            flush_path(Path(place) / name)


def flush_path(path: Path) -> None:
    """Brings a file, or the entries of a folder, to the disk."""
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
