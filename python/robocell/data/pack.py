"""Packs a dataset into a few large files, as object stores and copies like them, and unpacks it.

    pack("out/picks", "out/picks.packed")
    unpack("out/picks.packed", "out/again")     # the same bytes

A packed dataset is a folder of zip files without compression, `shard-00000.zip` and so on, and
`packed.json` with their hashes and the place of every file in them. An episode is in one shard. Any
zip program reads a shard; a file's bytes can also be read from its place without one. dataset.json,
reports and models lie beside the shards. Everything that reads datasets reads packed ones.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
import shutil
import zipfile
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Any, NoReturn

from robocell import __version__
from robocell._core import (
    ArgumentError,
    Dataset,
    Episode,
    IoError,
    json_damage,
    self_hashed_json,
    verify,
)
from robocell._staging import Staging, staging

__all__ = ["Packed", "is_packed", "pack", "read_packed", "unpack"]

INDEX, FORMAT, VERSION = "packed.json", "robocell-packed", 2
HASH, NO_HASH = "json_sha256", "0" * 64
SHARD_BYTES = 1 << 30
BLOCK = 1 << 20
MOST_INDEX_BYTES = 1 << 30
MODELS = "models"
SHARD_NAME = re.compile(r"shard-\d+\.zip$")


@dataclass(frozen=True)
class Packed:
    """A packed dataset.

    Attributes:
        folder: Where it is.
        episodes: Number of its episodes.
        shards: Number of its shards.
        files: Number of files of the dataset.
        bytes: Their size, with the tables of the shards.
        skipped: Damaged episodes, models and other files that `unpack` left out.
    """

    folder: Path
    episodes: int
    shards: int
    files: int
    bytes: int
    skipped: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Unit:
    """Files that are in one shard: an episode, or a folder of another kind."""

    files: dict[str, Path]  # name in the dataset -> file
    hashes: dict[str, str]  # those that are known
    is_episode: bool = False

    @property
    def bytes(self) -> int:
        return sum(file.stat().st_size for file in self.files.values())


def pack(
    dataset: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    shard_bytes: int = SHARD_BYTES,
    on_episodes: Callable[[int, int], None] | None = None,
) -> Packed:
    """Packs a dataset: its episodes, models and other visible files.

    Files are compared with the hashes in their episode.json while they are read. Every byte is
    stored; a link becomes the file behind it.

    Args:
        dataset: The folder of a dataset.
        out: The folder to make; it must not exist.
        shard_bytes: A shard gets episodes until it has this size, and at least one.
        on_episodes: Is called with the number of episodes that are packed, and of all.

    Raises:
        ArgumentError: There are no episodes, or `out` exists.
        IoError: A file is damaged, or reading or writing failed.
    """
    if is_packed(dataset):
        raise ArgumentError(
            f"'{dataset}' is packed already. For shards of another size, unpack it first: "
            f"`robocell unpack {shlex.quote(str(dataset))} OUT`"
        )
    opened = Dataset(os.fspath(dataset))
    if not len(opened):
        raise ArgumentError(f"dataset '{opened.folder}' has no episodes")
    if shard_bytes < 1:
        raise ArgumentError(f"shard_bytes must be at least 1, got {shard_bytes}")
    broken = [*opened.broken, *opened.misnamed]
    if broken:
        raise IoError(
            f"'{Path(opened.folder) / broken[0]}' is not a whole episode of its name. "
            f"`robocell verify {opened.folder}` says why"
        )
    target = Path(out).parent.resolve() / Path(out).name
    if target.is_relative_to(Path(opened.folder).resolve()):
        raise ArgumentError(
            f"'{out}' is inside the dataset '{opened.folder}'. Choose a folder beside it"
        )
    shards = list(_shards(list(_units(opened)), shard_bytes))
    beside = _beside(Path(opened.folder))
    request = {
        "packed": str(Path(opened.folder).resolve()),
        "shard_bytes": shard_bytes,
        "files": [
            [name, unit.hashes.get(name), file.stat().st_size, file.stat().st_mtime_ns]
            for units in (*shards, [_Unit(beside, {})])
            for unit in units
            for name, file in unit.files.items()
        ],
    }
    with _explaining(target), staging(target, request) as place:
        entries: list[dict[str, Any]] = []
        done = 0
        for number, units in enumerate(shards):
            name = f"shard-{number:05d}.zip"
            entry = place.state(name) if (place.folder / name).exists() else None
            if entry is None:
                entry = _write_shard(place, name, units)
                place.keep(name, entry)
            entries.append(entry)
            done += sum(unit.is_episode for unit in units)
            if on_episodes is not None:
                on_episodes(done, len(opened))
        index = {
            "format": FORMAT,
            "format_version": VERSION,
            "robocell": __version__,
            "episodes": list(opened.ids),
            "shards": entries,
            "files": {name: _copy(file, place.path(name)) for name, file in beside.items()},
            HASH: NO_HASH,
        }
        text = self_hashed_json(json.dumps(index, indent=1) + "\n")
        (place.folder / INDEX).write_text(text)
        place.commit()
    return _packed(target, index)


def unpack(
    packed: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    skip_damaged: bool = False,
    on_shards: Callable[[int, int], None] | None = None,
) -> Packed:
    """Makes the dataset again that was packed, with the same bytes.

    Args:
        packed: The folder of a packed dataset.
        out: The folder to make; it must not exist.
        skip_damaged: Leave out damaged episodes, models and files, instead of raising IoError.
        on_shards: Is called with the number of shards that are unpacked, and of all.

    Raises:
        ArgumentError: The folder is not a packed dataset, or `out` exists.
        IoError: A file is damaged, or reading or writing failed.
    """
    folder, index = Path(packed), _index(Path(packed))
    target = Path(out).parent.resolve() / Path(out).name
    if target.is_relative_to(folder.resolve()):
        raise ArgumentError(f"'{out}' is inside '{packed}'. Choose a folder beside it")
    skipped = _damaged(folder, index) if skip_damaged else ()
    left_out = frozenset(skipped)
    request = {"unpacked": str(folder.resolve()), "index": index[HASH], "skipped": skipped}
    with _explaining(target), staging(target, request) as place:
        for number, shard in enumerate(index["shards"], start=1):
            if place.state(shard["file"]) is None:
                for name, content in _contents(folder, shard, left_out):
                    _write(content, place, name)
                place.keep(shard["file"], True)  # a command that continues skips these files
            if on_shards is not None:
                on_shards(number, len(index["shards"]))
        for name, facts in index["files"].items():
            if _is_of(name, left_out):
                continue
            with _opened(folder / name) as source:
                _write(_Part(source, folder / name, name, facts | {"offset": 0}), place, name)
        place.commit()
    return _packed(target, index, skipped)


def _damaged(folder: Path, index: dict[str, Any]) -> tuple[str, ...]:
    """Returns damaged episodes, models and files. Raises IoError if no episode would be left."""
    found = verify(folder)
    bad = {*found.bad, *found.unjudged}
    if len(bad) == len(index["episodes"]):
        raise IoError(f"all episodes of '{folder}' are damaged: {found.problems[0]}")
    files = {name for listed in (index, *index["shards"]) for name in listed["files"]}
    own = {each.file for each in found.problems if not each.episode and each.file in files}
    for name in own - {*found.foreign}:
        # A model is of no use without one of its files.
        bad.add("/".join(name.split("/")[:2]) if name.startswith(f"{MODELS}/") else name)
    return tuple(sorted(bad))


def _is_of(name: str, some: Collection[str]) -> bool:
    """Returns whether a file is of one of some episodes, models and files."""
    first, second, *_ = (*name.split("/"), "")
    return name in some or first in some or f"{first}/{second}" in some


def _write(content: _Part, place: Staging, name: str) -> None:
    """Writes a file, which is there when all of it was compared with its hash."""
    partial = place.scratch("file")
    with partial.open("wb") as file:
        shutil.copyfileobj(content, file, BLOCK)
    partial.rename(place.path(name))


def read_packed(packed: str | os.PathLike[str], episode: str, file: str = "episode.json") -> bytes:
    """Returns a file of an episode, compared with its hash.

    Raises:
        ArgumentError: The folder is not a packed dataset, or has no such file.
        IoError: The file is damaged, or cannot be read.
    """
    folder, index = Path(packed), _index(Path(packed))
    name = f"{episode}/{file}"
    for shard in index["shards"]:
        if name in shard["files"]:
            with _opened(folder / shard["file"]) as source:
                content = _Part(source, folder / shard["file"], name, shard["files"][name])
                return content.read()
    raise ArgumentError(f"'{packed}' has no '{name}'; '{INDEX}' lists its files")


def is_packed(folder: str | os.PathLike[str]) -> bool:
    """Returns whether a folder is a packed dataset."""
    return (Path(folder) / INDEX).is_file()


def _packed(folder: Path, index: dict[str, Any], skipped: tuple[str, ...] = ()) -> Packed:
    shards, beside = index["shards"], index["files"]
    left_out = frozenset(skipped)
    names = [name for listed in (index, *shards) for name in listed["files"]]
    return Packed(
        folder,
        len(set(index["episodes"]) - left_out),
        len(shards),
        sum(not _is_of(name, left_out) for name in names),
        sum(each["bytes"] for each in (*shards, *beside.values())),
        skipped,
    )


def _units(dataset: Dataset) -> Iterator[_Unit]:
    """Yields the episodes and the other folders but the models."""
    root = Path(dataset.folder)
    ids = set(dataset.ids)
    for path in sorted(root.iterdir()):
        if path.is_dir() and not path.name.startswith(".") and path.name not in {*ids, MODELS}:
            yield _Unit(_files_of(root, path), {})
    for id in dataset.ids:
        described: Any = Episode(root / id).json
        hashes = {f"{id}/{name}": facts["sha256"] for name, facts in described["files"].items()}
        yield _Unit(_files_of(root, root / id), hashes, is_episode=True)


def _beside(root: Path) -> dict[str, Path]:
    """Returns the files that stay beside the shards: simulators open models by their paths."""
    own = [path for path in sorted(root.iterdir()) if path.is_file()]
    if taken := [path for path in own if path.name == INDEX or SHARD_NAME.match(path.name)]:
        raise ArgumentError(f"a packed dataset has its own '{taken[0].name}'. Rename '{taken[0]}'")
    models = sorted((root / MODELS).iterdir()) if (root / MODELS).is_dir() else []
    visible = [path for path in (*own, *models) if not path.name.startswith(".")]
    return {name: file for path in visible for name, file in _files_of(root, path).items()}


def _copy(source: Path, to: Path) -> dict[str, Any]:
    """Copies a file; returns its entry in the index. `commit` flushes it."""
    digest, size = hashlib.sha256(), 0
    with source.open("rb") as content, to.open("wb") as out:
        while block := content.read(BLOCK):
            digest.update(block)
            size += out.write(block)
    return {"bytes": size, "sha256": digest.hexdigest()}


def _files_of(root: Path, folder: Path) -> dict[str, Path]:
    """Returns a file, or all files below a folder, by their names in the dataset."""
    if folder.is_file():
        return {folder.relative_to(root).as_posix(): folder}
    files: dict[str, Path] = {}
    for at, folders, names in os.walk(folder, onerror=_raise):
        folders.sort()
        files |= {(Path(at) / n).relative_to(root).as_posix(): Path(at) / n for n in sorted(names)}
    return files


def _raise(error: OSError) -> NoReturn:
    raise IoError(f"cannot list '{error.filename}': {error.strerror}") from error


def _shards(units: Sequence[_Unit], shard_bytes: int) -> Iterator[list[_Unit]]:
    """Yields the units of each shard."""
    shard: list[_Unit] = []
    size = 0
    for unit in units:
        if shard and size + unit.bytes > shard_bytes:
            yield shard
            shard, size = [], 0
        shard.append(unit)
        size += unit.bytes
    yield shard


def _write_shard(place: Staging, name: str, units: Sequence[_Unit]) -> dict[str, Any]:
    """Writes a shard and flushes it; returns its entry in the index."""
    partial = place.scratch("shard")
    files: dict[str, dict[str, Any]] = {}
    with partial.open("wb") as out:
        with zipfile.ZipFile(out, "w", zipfile.ZIP_STORED) as shard:
            for unit in units:
                for member, file in unit.files.items():
                    info = zipfile.ZipInfo(member)  # of 1980: the same files give the same shard
                    info.file_size = file.stat().st_size
                    info.external_attr = 0o100644 << 16
                    digest = hashlib.sha256()
                    with file.open("rb") as source, shard.open(info, "w") as to:
                        begin = out.tell()
                        while block := source.read(BLOCK):
                            digest.update(block)
                            to.write(block)
                        size = out.tell() - begin
                    sha256 = digest.hexdigest()
                    if unit.hashes.get(member, sha256) != sha256:
                        raise IoError(
                            f"'{file}' is damaged: its hash does not match. `robocell verify` "
                            "names all that is damaged"
                        )
                    files[member] = {"offset": begin, "bytes": size, "sha256": sha256}
        out.flush()
        os.fsync(out.fileno())
    size = partial.stat().st_size
    partial.rename(place.path(name))
    return {
        "file": name,
        "bytes": size,
        "rest_sha256": _rest(place.path(name), files),
        "files": files,
    }


def _rest(shard: Path, files: dict[str, dict[str, Any]]) -> str:
    """Returns the hash of the bytes that are of no file: the tables of the zip file."""
    digest = hashlib.sha256()
    with shard.open("rb") as source:
        for facts in files.values():
            digest.update(source.read(facts["offset"] - source.tell()))
            source.seek(facts["bytes"], os.SEEK_CUR)
        digest.update(source.read())
    return digest.hexdigest()


def _index(folder: Path) -> dict[str, Any]:
    """Reads packed.json. Raises ArgumentError without one, IoError if it is damaged."""
    file = folder / INDEX
    if not file.is_file():
        raise ArgumentError(
            f"'{folder}' is not a packed dataset: it has no {INDEX}; `robocell pack` makes one"
        )
    try:
        if (size := file.stat().st_size) > MOST_INDEX_BYTES:
            raise IoError(f"cannot read '{file}': it has {size} bytes, of an index at most 1 GiB")
        text = file.read_text()
        damage = json_damage(text)
        index: dict[str, Any] = {} if damage else json.loads(text)
    except IoError:
        raise
    except (OSError, ValueError) as error:
        raise IoError(f"cannot read '{file}': {error}") from error
    if damage:
        raise IoError(f"'{file}' is damaged: {damage}. Copy the packed dataset again")
    if index.get("format") != FORMAT or index.get("format_version") != VERSION:
        raise IoError(
            f"'{file}' is not of format version {VERSION}, which this robocell reads. Unpack it "
            "with the version that packed it"
        )
    for listed in (index, *index["shards"]):
        for name in (listed.get("file", INDEX), *listed["files"]):
            parts = PurePosixPath(name).parts
            if not parts or parts[0].startswith(("/", ".")) or ".." in parts or "\0" in name:
                raise IoError(f"'{file}' names '{name}', which is not inside a dataset")
    return index


class _Part:
    """A file in a shard, which is compared with its hash when its end is read."""

    def __init__(self, shard: IO[bytes], path: Path, name: str, facts: dict[str, Any]) -> None:
        self._shard, self._name, self._sha256 = shard, f"'{name}' in '{path}'", facts["sha256"]
        self._left, self._digest = int(facts["bytes"]), hashlib.sha256()
        shard.seek(int(facts["offset"]))
        if not self._left:
            self._compare()

    def read(self, most: int = -1) -> bytes:
        """Returns the next bytes; b"" at the end."""
        size = self._left if most < 0 else min(most, self._left)
        block = self._shard.read(size)
        if len(block) < size:
            raise IoError(f"{self._name} is damaged: the shard is too short")
        self._digest.update(block)
        self._left -= size
        if size and not self._left:
            self._compare()
        return block

    def _compare(self) -> None:
        if self._digest.hexdigest() != self._sha256:
            raise IoError(f"{self._name} is damaged: its hash does not match")


def _contents(
    folder: Path, shard: dict[str, Any], skipped: Collection[str]
) -> Iterator[tuple[str, _Part]]:
    """Yields the files of a shard but those of some episodes, or some files."""
    path = folder / shard["file"]
    wanted = {name: facts for name, facts in shard["files"].items() if not _is_of(name, skipped)}
    if not wanted:
        return
    with _opened(path) as source:
        for name, facts in wanted.items():
            yield name, _Part(source, path, name, facts)


@contextmanager
def _explaining(target: Path) -> Iterator[None]:
    """Context manager: errors of the disk say that the same command continues."""
    try:
        yield
    except IoError:
        raise
    except OSError as error:
        raise IoError(
            f"cannot make '{target}': {error.strerror or error}. What was written stays in "
            f"'{target.parent / f'.{target.name}.partial'}'; the same command continues there"
        ) from error


def _opened(path: Path) -> IO[bytes]:
    try:
        return path.open("rb")
    except OSError as error:
        raise IoError(f"cannot read '{path}': {error.strerror}") from error
