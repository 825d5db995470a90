"""Brings the episodes of an item from another machine's disk to the dataset, piece by piece.

    folders = listing(its_dataset, "s0003_e0001")             # there
    data = read(its_dataset, folders[0], 0, PIECE_BYTES)      # there
    receive(folders[0], read_there, dataset, staging)         # here

A folder is complete or absent: it is written aside, compared with the hashes of its files, flushed,
and renamed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robocell import _core
from robocell._durable import flush_path

PIECE_BYTES = 4 << 20
DESCRIPTION = "episode.json"

# Returns the bytes [offset, offset + size) of a folder's files, one after the other.
Read = Callable[["Folder", int, int], bytes]


class DamagedPieceError(Exception):
    """What arrived differs from what was sent, or from what the episode says of its files."""


@dataclass(frozen=True)
class File:
    """A file of a folder: its path in the folder, its size and its hash."""

    path: str
    size: int
    sha256: str


@dataclass(frozen=True)
class Folder:
    """An episode or a model: its path in the dataset and its files, in the order of the bytes."""

    name: str
    files: tuple[File, ...]

    @property
    def size(self) -> int:
        """Size of all files."""
        return sum(file.size for file in self.files)


def listing(dataset: Path, item_id: str) -> list[Folder]:
    """Returns the episodes of an item, attempts in order, and before them the models they need."""
    attempts = [path for path in dataset.glob(f"{item_id}_a*") if _is_attempt(path.name, item_id)]
    attempts.sort(key=lambda path: (len(path.name), path.name))
    whole = [path for path in (dataset / item_id,) if path.is_dir()]
    episodes = [*attempts, *whole]
    models: dict[str, None] = {}
    for episode in episodes:
        described: Any = json.loads((episode / DESCRIPTION).read_text())
        models.update((str(Path(*Path(at).parts[:2])), None) for at in described["models"].values())
    names = [*models, *(path.name for path in episodes)]
    return [Folder(name, tuple(_files(dataset / name))) for name in names]


def read(dataset: Path, folder: Folder, offset: int, size: int) -> bytes:
    """Returns a piece of a folder's files, one after the other in the order of the listing."""
    parts: list[bytes] = []
    for file in folder.files:
        if size > 0 and offset < file.size:
            with (dataset / folder.name / file.path).open("rb") as opened:
                opened.seek(offset)
                part = opened.read(min(size, file.size - offset))
            parts.append(part)
            size -= len(part)
            offset += len(part)
        offset -= file.size
        if size <= 0 or offset < 0:
            break
    return b"".join(parts)


def receive(folder: Folder, read_there: Read, dataset: Path, staging: Path) -> None:
    """Adds a folder to the dataset, unless it has one of this name.

    `staging` is a folder on the dataset's disk that no other process uses. Raises DamagedPieceError
    for other bytes than those of the listing, and OSError if the disk fails.
    """
    target = dataset / folder.name
    if target.exists():
        return
    partial = staging / f"{threading.get_ident()}" / folder.name
    shutil.rmtree(partial, ignore_errors=True)
    try:
        _write(folder, _pieces(folder, read_there), partial)
        _require_described(folder, partial)
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            partial.rename(target)
        except OSError:
            if not target.exists():  # not even by another worker's hand
                raise
        flush_path(target.parent)
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def _is_attempt(name: str, item_id: str) -> bool:
    return name.removeprefix(f"{item_id}_a").isdecimal()


def _files(folder: Path) -> Iterator[File]:
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            with path.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            yield File(str(path.relative_to(folder)), path.stat().st_size, digest)


def _pieces(folder: Folder, read_there: Read) -> Iterator[bytes]:
    offset = 0
    while offset < folder.size:
        data = read_there(folder, offset, min(PIECE_BYTES, folder.size - offset))
        if not data:
            raise DamagedPieceError(f"'{folder.name}' ended after {offset} of {folder.size} bytes")
        offset += len(data)
        yield data


def _write(folder: Folder, pieces: Iterator[bytes], partial: Path) -> None:
    """Writes the files, compares their hashes and flushes them."""
    rest = b""
    folders = {partial}
    for file in folder.files:
        path = partial / file.path
        path.parent.mkdir(parents=True, exist_ok=True)
        folders.add(path.parent)
        digest, missing = hashlib.sha256(), file.size
        with path.open("wb") as opened:
            while missing:
                rest = rest or next(pieces)
                part, rest = rest[:missing], rest[missing:]
                digest.update(part)
                opened.write(part)
                missing -= len(part)
            opened.flush()
            os.fsync(opened.fileno())
        if digest.hexdigest() != file.sha256:
            raise DamagedPieceError(f"'{folder.name}/{file.path}' arrived with other bytes")
    for each in folders:
        flush_path(each)


def _require_described(folder: Folder, partial: Path) -> None:
    """Raises DamagedPieceError for an episode whose files are not those that it names."""
    with contextlib.suppress(FileNotFoundError):  # a model
        text = (partial / DESCRIPTION).read_text()
        if (damage := _core.json_damage(text)) is not None:
            raise DamagedPieceError(f"'{folder.name}/{DESCRIPTION}': {damage}")
        hashes = {file.path: file.sha256 for file in folder.files}
        for name, entry in json.loads(text)["files"].items():
            if hashes.get(name) != entry["sha256"]:
                raise DamagedPieceError(f"'{folder.name}/{name}' is not the file of its episode")
