"""Makes datasets from the episodes of others: several as one, one as several, those that fit.

    merge(["out/monday", "out/tuesday"], "out/both")
    split("out/both", {"train": 0.9, "valid": 0.1}, "out/parts")
    keep("out/both", "success and length < 200", "out/short")

The files of episodes are hard links where the file system allows it, so a result takes hardly any
space; robocell never writes into them. Results are complete or absent, and dataset.json says where
every episode comes from.
"""

from __future__ import annotations

import errno
import itertools
import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robocell import __version__, _core
from robocell._core import ArgumentError, Dataset, Episode, IoError, json_damage, self_hashed_json
from robocell._dataset_run import manifest_of_dataset
from robocell._durable import flush_folder, flush_path
from robocell._staging import Staging, staging
from robocell._stored_files import open_stored, read_stored
from robocell._suggestions import counted
from robocell.data._where import Condition, Value, fields

__all__ = ["Derived", "keep", "merge", "split"]

MANIFEST, DESCRIPTION, MODELS = "dataset.json", "episode.json", "models"
HASH = "json_sha256"
NO_HASH = "0" * 64
# Under this name it is kept how many episodes are on the disk, after so many or so many bytes.
ADDED, BATCH, BATCH_BYTES = "added", 256, 256 << 20
# Links are impossible between file systems, on some of them, and beyond a number of links.
UNLINKABLE = (errno.EXDEV, errno.EPERM, errno.EOPNOTSUPP, errno.EMLINK)

Datasets = Sequence["Dataset | str | os.PathLike[str]"]


@dataclass(frozen=True)
class Derived:
    """A dataset that was made from others.

    Attributes:
        folder: Where it is.
        episodes: Number of its episodes.
        of: Number of episodes that there were to choose from.
        renamed: Number of episodes that have another id than in their own dataset.
        copied: Number of files that could not be linked, and were copied.
    """

    folder: Path
    episodes: int
    of: int
    renamed: int = 0
    copied: int = 0


@dataclass(frozen=True)
class _Item:
    """An episode of a result: its own dataset, its id there, and its id in the result."""

    dataset: Dataset
    id: str
    name: str

    @property
    def recording(self) -> str:
        """The hash of its episode.json, which holds those of all its files."""
        described: Any = self.dataset[self.id].json
        return str(described.get("run", {}).get(HASH, ""))


def merge(
    datasets: Datasets,
    out: str | os.PathLike[str],
    *,
    copy: bool = False,
    on_episodes: Callable[[int, int], None] | None = None,
) -> Derived:
    """Makes one dataset of several.

    Episodes keep their ids. Where two datasets have the same id, the later one is renamed: its id
    begins with the name of its dataset. A recording that is in two datasets is taken once.

    Args:
        datasets: Datasets, slices of them, or folders.
        out: The folder to make; it must not exist.
        copy: Copy files instead of linking them.
        on_episodes: Is called with the number of episodes that are there, and of all.

    Raises:
        ArgumentError: There are no episodes, a dataset is given twice, or `out` exists.
        IoError: Reading or writing failed.
    """
    opened = [_open(each) for each in datasets]
    folders = [each.folder.resolve() for each in opened]
    for index, folder in enumerate(folders):
        if folder in folders[:index]:
            raise ArgumentError(f"dataset '{opened[index].folder}' is given twice")
    items = list(_named(opened))
    renamed = sum(item.id != item.name for item in items)
    made = {"merged": [str(folder) for folder in folders]}
    copied = _make(Path(out), {"": items}, made, copy, on_episodes)
    return Derived(Path(out), len(items), sum(map(len, opened)), renamed, copied)


def split(
    dataset: Dataset | str | os.PathLike[str],
    parts: Mapping[str, float],
    out: str | os.PathLike[str],
    *,
    seed: int = 0,
    by: str | None = None,
    copy: bool = False,
    on_episodes: Callable[[int, int], None] | None = None,
) -> dict[str, Derived]:
    """Makes several datasets of one, `out/train` and so on, with no episode in two of them.

    Args:
        dataset: A dataset, one of its slices, or a folder.
        parts: The share of each part; their sum is 1.
        out: The folder to make, which holds the parts; it must not exist.
        seed: Another number gives another choice of the same sizes.
        by: Name of a field, as in conditions. Episodes that share its value stay together:
            "scene", "task".
        copy: Copy files instead of linking them.
        on_episodes: Is called with the number of episodes that are there, and of all.

    Raises:
        ArgumentError: The shares are not shares, a part would be empty, or `out` exists.
        NotFoundError: Episodes have no field of the name `by`.
        IoError: Reading or writing failed.
    """
    opened = _open(dataset)
    _require_shares(parts)
    chosen = _chosen(opened, parts, seed, by)
    made = {
        "split": str(opened.folder.resolve()),
        "parts": dict(parts),
        "seed": seed,
        "by": by,
    }
    items = {name: [_Item(opened, id, id) for id in ids] for name, ids in chosen.items()}
    copied = _make(Path(out), items, made, copy, on_episodes)
    return {
        name: Derived(Path(out) / name, len(ids), len(opened), copied=copied)
        for name, ids in chosen.items()
    }


def fitting(dataset: Dataset, condition: str) -> list[str]:
    """Returns the ids of the episodes that a condition holds for; `where` describes conditions.

    Raises:
        ArgumentError: It is no condition, or compares values of different types.
        NotFoundError: No episode has a field of a name in it.
    """
    parsed = Condition.parse(condition)
    each = {episode.id: fields(episode) for episode in dataset}
    parsed.require_known({name for own in each.values() for name in own})
    return [id for id, own in each.items() if parsed.holds(own)]


def keep(
    dataset: Dataset | str | os.PathLike[str],
    condition: str,
    out: str | os.PathLike[str],
    *,
    copy: bool = False,
    on_episodes: Callable[[int, int], None] | None = None,
) -> Derived:
    """Makes a dataset of the episodes that a condition holds for.

    Args:
        dataset: A dataset, one of its slices, or a folder.
        condition: "success and length < 200"; docs/data.md lists the fields.
        out: The folder to make; it must not exist.
        copy: Copy files instead of linking them.
        on_episodes: Is called with the number of episodes that are there, and of all.

    Raises:
        ArgumentError: It is no condition, holds for no episode, or `out` exists.
        NotFoundError: No episode has a field of a name in it.
        IoError: Reading or writing failed.
    """
    opened = _open(dataset)
    ids = fitting(opened, condition)
    if not ids:
        raise ArgumentError(
            f"'{condition}' holds for none of the {counted(len(opened), 'episode')} of "
            f"'{opened.folder}'"
        )
    made = {"filtered": str(opened.folder.resolve()), "where": condition}
    items = {"": [_Item(opened, id, id) for id in ids]}
    copied = _make(Path(out), items, made, copy, on_episodes)
    return Derived(Path(out), len(ids), len(opened), copied=copied)


def extend(folder: Path, parts: Sequence[tuple[Dataset, str]], made: dict[str, Any]) -> int:
    """Adds what datasets have to a dataset that nobody else writes; returns its episodes.

    Args:
        folder: The dataset, or a folder that becomes one.
        parts: Datasets, and what the ids of their episodes begin with.
        made: How, for dataset.json.
    """
    items = [_Item(each, id, f"{prefix}_{id}") for each, prefix in parts for id in each.ids]
    for item in items:
        _add(_Durable(folder), folder, item, copy=False)
    _core.atomic_write(folder / MANIFEST, _manifest(items, made).encode())
    return len(items)


class _Durable(Staging):
    """A dataset that is extended: its folders are on the disk before they have their names."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, folder)

    def scratch(self, name: str) -> Path:
        """Returns a path that no reader sees."""
        return self.folder / f".{name}.partial"

    def add(self, partial: Path, folder: Path) -> None:
        """Gives a folder its name when its files are on the disk."""
        flush_folder(partial)
        partial.rename(folder)
        if folder.parent != self.folder:  # the dataset's own entries are flushed with its manifest
            flush_path(folder.parent)


def _open(dataset: Dataset | str | os.PathLike[str]) -> Dataset:
    opened = dataset if isinstance(dataset, Dataset) else Dataset(os.fspath(dataset))
    if not len(opened):
        raise ArgumentError(f"dataset '{opened.folder}' has no episodes")
    return opened


def _named(datasets: Sequence[Dataset]) -> Iterator[_Item]:
    """Yields all recordings, each once and under a name that no other has."""
    taken = {id for dataset in datasets for id in dataset.ids}
    used: set[str] = set()
    recordings: set[str] = set()
    for dataset in datasets:
        prefix = dataset.folder.resolve().name.lstrip(".") or "dataset"
        for id in dataset.ids:
            described: Any = dataset[id].json
            recording = json.dumps(described["files"], sort_keys=True)  # with their hashes
            if recording in recordings:
                continue
            recordings.add(recording)
            name, number = id, 1
            while name in used or (name != id and name in taken):
                name = f"{prefix}_{id}" if number == 1 else f"{prefix}_{number}_{id}"
                number += 1
            used.add(name)
            yield _Item(dataset, id, name)


def _require_shares(parts: Mapping[str, float]) -> None:
    if len(parts) < 2:
        raise ArgumentError("a split has two or more parts, such as train=0.9,valid=0.1")
    for name, share in parts.items():
        if not name or name.startswith(".") or "/" in name:
            raise ArgumentError(f"'{name}' cannot be the name of a part: parts are folders")
        if not 0 < share < 1:
            raise ArgumentError(f"the share of '{name}' is {share:g}; shares are between 0 and 1")
    if abs(sum(parts.values()) - 1) > 1e-6:
        raise ArgumentError(
            f"the shares of {', '.join(parts)} sum to {sum(parts.values()):g} instead of 1"
        )


def _chosen(
    dataset: Dataset, parts: Mapping[str, float], seed: int, by: str | None
) -> dict[str, list[str]]:
    """Returns the ids of each part, in the order of the dataset."""
    groups: dict[Value | None, list[str]] = {}
    if by is None:
        groups = {id: [id] for id in dataset.ids}
    else:
        each = {episode.id: fields(episode) for episode in dataset}
        Condition.parse(by).require_known({name for own in each.values() for name in own})
        for id, own in each.items():
            groups.setdefault(own.get(by), []).append(id)
    import numpy as np  # here, so that the command line begins without it

    together = list(groups.values())
    order = [together[i] for i in np.random.default_rng(seed).permutation(len(together))]
    order.sort(key=len, reverse=True)  # keeps the order of equals; the small ones fill the gaps
    chosen: dict[str, list[str]] = {name: [] for name in parts}
    for group in order:

        def missing(name: str) -> float:
            return parts[name] * len(dataset) - len(chosen[name])

        chosen[max(parts, key=missing)] += group
    empty = [name for name, ids in chosen.items() if not ids]
    if empty:
        what = "episode" if by is None else f"value of '{by}'"
        raise ArgumentError(
            f"part '{empty[0]}' would be empty: dataset '{dataset.folder}' has "
            f"{counted(len(groups), what)} for {len(parts)} parts"
        )
    place = {id: index for index, id in enumerate(dataset.ids)}
    return {name: sorted(ids, key=place.__getitem__) for name, ids in chosen.items()}


def _make(
    out: Path,
    parts: dict[str, list[_Item]],
    made: dict[str, Any],
    copy: bool,
    on_episodes: Callable[[int, int], None] | None,
) -> int:
    """Makes a dataset, or a folder of several; returns the number of files that were copied.

    Args:
        out: The result.
        parts: Episodes of each dataset, by its folder in the result; "" is the result itself.
        made: How, for dataset.json.
        copy: Copy files instead of linking them.
        on_episodes: Is called with the number of episodes that are there, and of all.
    """
    target = out.parent.resolve() / out.name
    sources = {item.dataset.folder.resolve() for items in parts.values() for item in items}
    for folder in sources:
        if target.is_relative_to(folder):
            raise ArgumentError(
                f"'{out}' is inside the dataset '{folder}'. Choose a folder beside it"
            )
    request = {
        "made": made,
        "copy": copy,
        "episodes": {
            part: [[str(item.dataset.folder), item.id, item.name, item.recording] for item in items]
            for part, items in parts.items()
        },
    }
    whole = sum(len(items) for items in parts.values())
    done = copied = 0
    try:
        with staging(target, request) as place:
            kept = int(place.state(ADDED) or 0)
            safe = {
                (part, model)
                for part, item in itertools.islice(_each(parts), kept)
                for model in _models_of(item)
            }
            for part, items in parts.items():
                folder = place.path(str(Path(part) / MANIFEST)).parent
                for item in items:
                    if done >= kept:
                        for model in _models_of(item):
                            if (part, model) not in safe:
                                safe.add((part, model))
                                _remove(folder / model)
                        _remove(folder / item.name)
                        copied += _add(place, folder, item, copy)
                        place.has_episodes = True
                    done += 1
                    is_full = done % BATCH == 0 or place.unflushed_bytes >= BATCH_BYTES
                    if is_full and done > kept:
                        place.keep(ADDED, done)
                    if on_episodes is not None:
                        on_episodes(done, whole)
                (folder / MANIFEST).write_text(_manifest(items, made))
            place.commit()
    except IoError:
        raise
    except OSError as error:
        raise IoError(
            f"cannot make '{out}': {error.strerror or error}. What was written stays in "
            f"'{target.parent / f'.{target.name}.partial'}'; the same command continues there"
        ) from error
    return copied


def _each(parts: Mapping[str, Sequence[_Item]]) -> Iterator[tuple[str, _Item]]:
    return ((part, item) for part, items in parts.items() for item in items)


def _models_of(item: _Item) -> list[Path]:
    """Returns the models of an episode, each a folder: models/rc7-<hash>/rc7.xml."""
    paths = item.dataset[item.id].models.values()
    return sorted({Path(*Path(path).parts[:2]) for path in paths})


def _remove(folder: Path) -> None:
    """Removes what a killed command added; after a power cut its files may be empty."""
    if folder.exists():
        shutil.rmtree(folder)


def _add(place: Staging, folder: Path, item: _Item, copy: bool) -> int:
    """Adds an episode and its models, unless they are there; returns the number of copied files."""
    episode = item.dataset[item.id]
    root = item.dataset.folder
    copied = 0
    for model in _models_of(item):
        if not (folder / model).exists():
            copied += _add_folder(place, root / model, folder / model, copy)
    if not (folder / item.name).exists():
        copied += _add_folder(
            place,
            episode.folder,
            folder / item.name,
            copy,
            {DESCRIPTION: _renamed(episode, item.name)} if item.name != item.id else {},
        )
    return copied


def _add_folder(
    place: Staging, source: Path, to: Path, copy: bool, replaced: Mapping[str, str] | None = None
) -> int:
    """Adds a folder by one rename; returns the number of copied files."""
    partial = place.scratch("folder")
    shutil.rmtree(partial, ignore_errors=True)
    if _core.packed_part(source / DESCRIPTION) is not None:
        copied = _extract(source, partial, copy, replaced or {})
    else:
        copied = _link(source, partial, copy, replaced or {})
    to.parent.mkdir(parents=True, exist_ok=True)
    place.add(partial, to)
    return copied


def _link(source: Path, to: Path, copy: bool, replaced: Mapping[str, str]) -> int:
    """Links a folder, or copies it; returns the number of copies that should have been links."""
    copied = 0
    for at, folders, files in os.walk(source):
        folders.sort()
        inner = to / Path(at).relative_to(source)
        inner.mkdir()
        for name in sorted(files):
            if name in replaced and inner == to:
                (inner / name).write_bytes(replaced[name].encode())
            else:
                copied += _add_file(Path(at) / name, inner / name, copy)
    return copied


def _extract(episode: Path, to: Path, copy: bool, replaced: Mapping[str, str]) -> int:
    """Copies an episode of a packed dataset, whose files cannot be linked; returns as `_link`."""
    to.mkdir()
    copied = 0
    for name in (DESCRIPTION, *Episode(episode).files):
        if name in replaced:
            (to / name).write_bytes(replaced[name].encode())
            continue
        with open_stored(episode / name) as content, (to / name).open("wb") as out:
            shutil.copyfileobj(content, out)
        copied += not copy
    return copied


def _add_file(source: Path, to: Path, copy: bool) -> bool:
    """Links a file, or copies it; returns True for a copy that should have been a link."""
    real = source.resolve()
    if not copy:
        try:
            os.link(real, to)
        except OSError as error:
            if error.errno not in UNLINKABLE:
                raise
        else:
            return False
    shutil.copyfile(real, to)
    return not copy


def _renamed(episode: Episode, name: str) -> str:
    """Returns the content of episode.json with another id."""
    file = episode.folder / DESCRIPTION
    text = read_stored(file).decode()
    if (damage := json_damage(text)) is not None:
        raise IoError(f"'{file}' is damaged: {damage}")
    before = json.loads(text)
    changed = text.replace(f'"id": {json.dumps(episode.id)}', f'"id": {json.dumps(name)}', 1)
    changed = changed.replace(before["run"][HASH], NO_HASH, 1)
    text = self_hashed_json(changed)
    after = json.loads(text)
    after["run"][HASH] = before["run"][HASH]
    if after != before | {"id": name}:
        raise IoError(f"'{file}' cannot be given the id '{name}'")
    return text


def _manifest(items: Sequence[_Item], made: dict[str, Any]) -> str:
    """Returns dataset.json: that of the run, where all come from one, and the origin of all."""
    sources: dict[str, dict[str, Any]] = {}
    runs = []
    for item in items:
        folder = str(item.dataset.folder.resolve())
        if folder not in sources:
            manifest = manifest_of_dataset(item.dataset.folder) or {}
            runs.append({key: value for key, value in manifest.items() if key != HASH})
            sources[folder] = {"folder": folder, "manifest_sha256": manifest.get(HASH)}
            for key in ("run", "identity", "derived"):
                if key in manifest:
                    sources[folder][key] = manifest[key]
            sources[folder]["episodes"] = {}
        sources[folder]["episodes"][item.name] = item.id
    comparable = [{key: run[key] for key in run if key != "derived"} for run in runs]
    is_one_run = all(each == comparable[0] for each in comparable)
    keeps = bool(items) and is_one_run and all(item.id == item.name for item in items)
    whole = dict(comparable[0]) if keeps else {}
    whole["format"] = "robocell-dataset"
    whole["derived"] = {"robocell": __version__, **made, "sources": list(sources.values())}
    whole[HASH] = NO_HASH
    return self_hashed_json(json.dumps(whole, indent=2) + "\n")
