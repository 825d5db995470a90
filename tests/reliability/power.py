"""Builds the folders that a power cut may leave, from a record of what a program wrote.

    record = Record.of(place, command)        # runs the command under librecord_io.so
    for cut in record.cuts(100, seed=0):
        cut.build()                           # `place` is now what the disk may have kept

Two file systems are modelled. A disk has taken what was flushed before the cut, in both.

ordered  A journal, as of ext4 and XFS: names change in the order of the calls, so a prefix of the
         changes is on the disk, at least up to the last flush of any file. The bytes of a file that
         was not flushed are missing, or there up to some sector.
weak     Names that were not flushed with their folder are there or not, each on its own; a renaming
         between two folders may be half done. A file that was not flushed has its old bytes, some
         of the new ones, or its size and zeros.

A torn file lacks what follows a sector; in the weak system it may lack any single write before it.
"""

from __future__ import annotations

import os
import random  # rule-ok: chooses cuts; no data depends on it
import shutil
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

SECTOR = 512
HEADER = struct.Struct("<4sIIIQq")
MODELS = ("ordered", "weak")
# What becomes of names that were not flushed, and of bytes.
NAMES = ("all", "none", "some", "all but one")
BYTES = ("none", "all", "torn", "mixed")


@dataclass(eq=False)
class Node:
    """A file, a folder (with `entries`) or a link (with `target`)."""

    content: bytes = b""
    entries: dict[str, Node] | None = None
    target: str | None = None
    writes: list[tuple[int, int, bytes | None]] = field(default_factory=list)  # event, at, bytes
    syncs: list[int] = field(default_factory=list)  # events

    def synced(self, cut: int) -> int:
        """The last flush before a cut; -1 without one."""
        return max((sync for sync in self.syncs if sync < cut), default=-1)


@dataclass(frozen=True)
class Naming:
    """A change of a folder: `name` becomes `node`, or nothing. Two of one event are a rename."""

    event: int
    folder: Node
    name: str
    node: Node | None


@dataclass(frozen=True)
class Event:
    """A recorded call."""

    kind: str
    path: str
    other: str
    content: bytes
    inode: int
    at: int


def _events(file: Path) -> Iterator[Event]:
    content, place = file.read_bytes(), 0
    while place < len(content):
        kind, path, other, size, inode, at = HEADER.unpack_from(content, place)
        parts = []
        place += HEADER.size
        for length in (path, other, size):
            parts.append(content[place : place + length])
            place += length
        yield Event(kind.decode(), *(os.fsdecode(p) for p in parts[:2]), parts[2], inode, at)


class Record:
    """What a program did to a folder.

    Attributes:
        place: The folder.
        says: What it wrote to standard output, and after how many events.
        length: Number of events.
    """

    def __init__(self, place: Path, before: dict[str, tuple[int, bytes | None]], file: Path):
        self.place = place
        self.says: list[tuple[int, bytes]] = []
        self._root = Node(entries={})
        self._inodes: dict[int, Node] = {}
        self._namings: list[Naming] = []
        self._nodes: list[Node] = []
        self.length = 0
        self._live: dict[Node, dict[str, Node]] = {}
        self._load(before)
        for event in _events(file):
            self._take(event)
            self.length += 1

    @staticmethod
    def snapshot(place: Path) -> dict[str, tuple[int, bytes | None]]:
        """What is in a folder: inodes and bytes by path, None for folders."""
        return {
            str(path.relative_to(place)): (
                path.lstat().st_ino,
                None if path.is_dir() else path.read_bytes(),
            )
            for path in (place, *sorted(place.rglob("*")))
        }

    def _load(self, before: dict[str, tuple[int, bytes | None]]) -> None:
        for name, (inode, content) in before.items():
            node = Node(content or b"", entries={} if content is None else None)
            self._inodes[inode] = node
            if name == ".":
                self._root = node
                continue
            folder, own = self._split(str(self.place / name))
            assert folder.entries is not None
            folder.entries[own] = self._entries(folder)[own] = node

    def _split(self, path: str) -> tuple[Node, str]:
        """The folder of a path, which is there when its call is made, and its name."""
        parts = Path(os.path.relpath(os.path.normpath(path), self.place)).parts
        node = self._root
        for part in parts[:-1]:
            node = self._entries(node)[part]
        return node, parts[-1]

    def _entries(self, folder: Node) -> dict[str, Node]:
        """The entries of a folder now, as the record is read."""
        assert folder.entries is not None
        return self._live.setdefault(folder, dict(folder.entries))

    def _set(self, path: str, node: Node | None) -> Node | None:
        folder, name = self._split(path)
        self._namings.append(Naming(self.length, folder, name, node))
        entries = self._entries(folder)
        former = entries.pop(name, None)
        if node is not None:
            entries[name] = node
        return former

    def _take(self, event: Event) -> None:
        match event.kind:
            case "says":
                self.says.append((self.length, event.content))
            case "make" | "fold" | "symb":
                node = Node(
                    entries={} if event.kind == "fold" else None,
                    target=event.other if event.kind == "symb" else None,
                )
                self._inodes[event.inode] = node
                self._nodes.append(node)
                self._set(event.path, node)
            case "gone":
                self._set(event.path, None)
            case "name":
                node = self._set(event.path, None)
                self._set(event.other, node)
            case "link":
                if event.inode not in self._inodes:  # from elsewhere
                    self._inodes[event.inode] = Node(Path(event.path).read_bytes())
                self._set(event.other, self._inodes[event.inode])
            case "writ" | "size":
                if event.inode not in self._inodes:
                    raise ValueError(f"'{event.path}' was made unseen")
                node = self._inodes[event.inode]
                write = event.content if event.kind == "writ" else None
                node.writes.append((self.length, event.at, write))
            case "sync":
                self._inodes[event.inode].syncs.append(self.length)
            case other:
                raise ValueError(other)

    @property
    def last_naming(self) -> int:
        """The last event that changed a name."""
        return max(naming.event for naming in self._namings)

    def cut(self, seed: int) -> Cut:
        """A power cut at random: an instant, a model, and what of the rest the disk has taken."""
        chance = random.Random(seed)
        # Instants beside renamings and flushes matter most.
        points = sorted(
            {naming.event for naming in self._namings}
            | {sync for node in self._inodes.values() for sync in node.syncs}
            | {event for event, _ in self.says}
        )
        at = chance.randint(0, self.length)
        if points and chance.random() < 0.75:
            at = chance.choice(points) + chance.randint(0, 1)
        model = chance.choice(MODELS)
        names = chance.choice(NAMES)
        content = chance.choice(BYTES)
        return Cut(self, at, model, names, content, seed)

    def whole(self) -> Cut:
        """What the program left."""
        return Cut(self, self.length, "weak", "all", "all", 0)


@dataclass
class Cut:
    """A power cut.

    Attributes:
        record: What was being done.
        at: Number of the events before it.
        model: The file system.
        names: What became of names that were not flushed.
        content: What became of bytes that were not flushed.
        seed: Of the random choices.
    """

    record: Record
    at: int
    model: str
    names: str
    content: str
    seed: int

    def __str__(self) -> str:
        return (
            f"power cut after call {self.at} of {self.record.length} ({self.model}; names: "
            f"{self.names}; bytes: {self.content}; seed {self.seed})"
        )

    @property
    def said(self) -> str:
        """What the program had said."""
        said = b"".join(text for event, text in self.record.says if event < self.at)
        return said.decode(errors="replace")

    def files(self) -> dict[str, bytes | None]:
        """What the disk has: bytes by path, None for folders."""
        chance = random.Random(self.seed)
        kept = self._kept(chance)
        entries: dict[Node, dict[str, Node]] = {}
        for naming in kept:
            assert naming.folder.entries is not None
            own = entries.setdefault(naming.folder, dict(naming.folder.entries))
            own.pop(naming.name, None)
            if naming.node is not None:
                own[naming.name] = naming.node
        found: dict[str, bytes | None] = {}
        contents: dict[Node, bytes] = {}
        self._walk(self.record._root, "", entries, contents, found, chance, set())
        return found

    def _walk(
        self,
        folder: Node,
        path: str,
        entries: dict[Node, dict[str, Node]],
        contents: dict[Node, bytes],
        found: dict[str, bytes | None],
        chance: random.Random,
        seen: set[Node],
    ) -> None:
        if folder in seen:  # a folder has one name
            return
        seen.add(folder)
        assert folder.entries is not None
        for name, node in sorted(entries.get(folder, folder.entries).items()):
            own = f"{path}/{name}" if path else name
            if node.entries is not None:
                found[own] = None
                self._walk(node, own, entries, contents, found, chance, seen)
                continue
            if node not in contents:
                contents[node] = self._bytes(node, chance)
            found[own] = contents[node]

    def build(self) -> dict[str, bytes | None]:
        """Makes the folder what the disk has."""
        place, found = self.record.place, self.files()
        for path in place.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        for name, content in found.items():
            if content is None:
                (place / name).mkdir(parents=True)
            else:
                (place / name).write_bytes(content)
        return found

    def _kept(self, chance: random.Random) -> list[Naming]:
        """The changes of names that the disk has taken, in their order."""
        done = [naming for naming in self.record._namings if naming.event < self.at]
        if self.model == "ordered":
            last = max((node.synced(self.at) for node in self.record._inodes.values()), default=-1)
            last = max([last, *(node.synced(self.at) for node in self.record._nodes)])
            events = sorted({naming.event for naming in done if naming.event > last})
            count = {
                "all": len(events),
                "none": 0,
                "some": chance.randint(0, len(events)),
                "all but one": max(0, len(events) - 1),
            }[self.names]
            until = events[count - 1] if count else last
            return [naming for naming in done if naming.event <= until]
        loose = sorted(
            {naming.event for naming in done if naming.folder.synced(self.at) < naming.event}
        )
        kept = {
            "all": set(loose),
            "none": set(),
            "some": {event for event in loose if chance.random() < 0.5},
            "all but one": set(loose) - ({chance.choice(loose)} if loose else set()),
        }[self.names]
        is_split = chance.random() < 0.5
        result = []
        by_event: dict[int, list[Naming]] = {}
        for naming in done:
            by_event.setdefault(naming.event, []).append(naming)
        for event, both in by_event.items():
            is_flushed = [naming.folder.synced(self.at) >= event for naming in both]
            is_folder = any(n.node is not None and n.node.entries is not None for n in both)
            is_inside_one = len({id(naming.folder) for naming in both}) == 1
            if is_inside_one or is_folder or not is_split:
                if event in kept or any(is_flushed):
                    result += both
                continue
            for naming, flushed in zip(both, is_flushed, strict=True):
                if flushed or (event in kept and chance.random() < 0.5):
                    result.append(naming)
        return result

    def _bytes(self, node: Node, chance: random.Random) -> bytes:
        synced = node.synced(self.at)
        done = [write for write in node.writes if write[0] < self.at]
        firm = [write for write in done if write[0] < synced]
        loose = done[len(firm) :]
        way = self.content if self.content != "mixed" else chance.choice(BYTES[:3])
        if not loose or way == "all":
            return _replayed(node.content, done)
        before = _replayed(node.content, firm)
        if way == "none":
            after = _replayed(node.content, done)
            if self.model == "weak" and chance.random() < 0.5:  # its size, and zeros
                return before[: len(after)].ljust(len(after), b"\0")
            return before
        last = chance.randrange(len(loose))
        taken = loose[:last]
        if self.model == "weak" and taken and chance.random() < 0.5:
            taken.pop(chance.randrange(len(taken)))
        event, at, content = loose[last]
        if content is not None:
            end = (at + chance.randint(0, len(content))) // SECTOR * SECTOR
            taken.append((event, at, content[: max(0, end - at)]))
        return _replayed(before, taken)


def _replayed(content: bytes, writes: Sequence[tuple[int, int, bytes | None]]) -> bytes:
    result = bytearray(content)
    for _, at, new in writes:
        if new is None:
            del result[at:]
            result.extend(bytes(at - len(result)))
        elif new:
            result.extend(bytes(max(0, at - len(result))))
            result[at : at + len(new)] = new
    return bytes(result)
