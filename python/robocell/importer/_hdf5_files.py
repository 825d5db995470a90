"""Reads robomimic's HDF5 file, and the HDF5 files of ALOHA, ACT and RoboTwin."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import IoError
from robocell._extras import needed_by
from robocell._suggestions import shortened
from robocell.importer._arrays import is_numbers, is_pixels, numbers, pixels
from robocell.importer._entries import Entries, is_text, rate_of
from robocell.importer._foreign_files import ADVICE, fingerprint, reading, require_file
from robocell.importer._recording import Clip, Column, Recording, Stills

with needed_by("robocell.importer", "export"):
    import h5py

COLUMNS = {"actions": "action", "rewards": "reward", "dones": "terminated"}


class Robomimic:
    """A robomimic dataset; see `recording.Origin`."""

    title = "robomimic HDF5"

    def __init__(self, file: Path) -> None:
        self.file = file
        self.fingerprint = fingerprint(file.parent, [file])
        self._data = _child(_open(file), "data", h5py.Group)
        with reading(file):
            self._demos = sorted((name for name in self._data if _is_demo(name)), key=_number)
        self.gaps = _gaps(self._demos)
        settings = _settings(_attribute(self._data, "env_args", "{}"), file)
        self._environment = settings.text("env_name", "")
        arguments = settings.table("env_kwargs") if "env_kwargs" in settings else Entries({}, "")
        names = [name for name in ("control_freq", "rate") if name in arguments]
        self.rate: Fraction | None = None
        for name in names[:1]:
            self.rate = rate_of(arguments.content[name], f"{arguments.place}: '{name}'")
        robots = arguments.content.get("robots")
        is_one = robots is None or isinstance(robots, str)
        self.robots = (
            arguments.text("robots", "") if is_one else ", ".join(arguments.texts("robots"))
        )

    def __len__(self) -> int:
        return len(self._demos)

    def read(self, index: int) -> Recording:
        """Reads a demonstration."""
        name = self._demos[index]
        demo = _child(self._data, name, h5py.Group)
        rows = _rows(demo, "actions")
        count = _attribute(demo, "num_samples", rows)
        if not np.array_equal(count, rows):
            raise IoError(
                f"{_place(demo)} has {rows} actions, its attribute num_samples is {count}: {ADVICE}"
            )
        columns, images = _arrays(demo, rows, skipped=("next_obs",))
        metadata = {"episode": name, "environment": self._environment}
        return Recording(_instruction(demo), rows, columns, images, metadata)

    def column_name(self, name: str) -> str | None:
        """Returns "observation/object" for obs/object."""
        if name.startswith("obs/"):
            return f"observation/{name[4:]}"
        return COLUMNS.get(name, name)


class Aloha:
    """A folder of ALOHA's episodes; see `recording.Origin`."""

    title = "ALOHA HDF5"
    robots = ""

    def __init__(self, folder: Path) -> None:
        files = folder.glob("episode_*.hdf5")
        self._files = sorted(files, key=lambda file: _number(file.stem))
        self.fingerprint = fingerprint(folder, self._files)
        self.gaps = _gaps([file.stem for file in self._files])
        first = _open(self._files[0])
        hertz = _attribute(first, "rate", None)
        self.rate: Fraction | None = None
        if hertz is not None:
            self.rate = rate_of(hertz, f"{_place(first)}: the attribute rate")

    def __len__(self) -> int:
        return len(self._files)

    def read(self, index: int) -> Recording:
        """Reads an episode."""
        content = _open(self._files[index])
        rows = _rows(content, "action")
        columns, images = _arrays(content, rows, skipped=("compress_len",))
        metadata = {"episode": self._files[index].stem}
        return Recording(_instruction(content), rows, columns, images, metadata)

    def column_name(self, name: str) -> str | None:
        """Returns "observation/qpos" for observations/qpos."""
        return name.replace("observations/", "observation/", 1)


def is_robomimic(file: Path) -> bool:
    """Whether an HDF5 file has demonstrations of robomimic."""
    content = _open(file)
    with reading(file), content:
        data = content.get("data")
        return isinstance(data, h5py.Group) and any(map(_is_demo, data))


def is_aloha(file: Path) -> bool:
    """Whether an HDF5 file is an episode of ALOHA."""
    content = _open(file)
    with reading(file), content:
        return "action" in content and "observations" in content


def _open(file: Path) -> Any:
    """Opens a file; raises IoError if it names other files."""
    require_file(file)
    with reading(file):
        content = h5py.File(file)
        links = content.id.links
        outside = links.visit(_outside, info=True)
    if outside is not None:
        name = outside.decode(errors="replace")
        raise IoError(
            f"'{file}': {name} is a link to another file. Datasets have their arrays inside; copy "
            "them with `h5repack --merge` if you trust the link"
        )
    return content


def _outside(name: bytes, info: Any) -> bytes | None:
    """Returns the name of a link to another file, which ends the walk over all links."""
    return None if info.type in (h5py.h5l.TYPE_HARD, h5py.h5l.TYPE_SOFT) else name


def _require_own_bytes(array: Any) -> None:
    """Raises IoError for a dataset whose numbers are in other files."""
    with reading(_place(array)):
        files = [name for name, *_ in array.external or ()]
        if array.is_virtual:
            files += [each.file_name for each in array.virtual_sources()]
    for name in files:
        if name != ".":
            raise IoError(
                f"{_place(array)} has its numbers in another file, '{name}'. Datasets have their "
                "arrays inside; copy them with `h5repack` if you trust the file"
            )


def _child(group: Any, name: str, kind: type) -> Any:
    with reading(f"{_place(group)}: {name}"):
        found = group.get(name)
    if not isinstance(found, kind):
        what = "group" if kind is h5py.Group else "dataset"
        raise IoError(f"{_place(group)} has no {what} '{name}': {ADVICE}")
    return found


def _rows(group: Any, name: str) -> int:
    """Returns the number of rows of the actions, which is that of the recording."""
    actions = _child(group, name, h5py.Dataset)
    if not actions.shape:
        raise IoError(f"{_place(actions)} has no rows: {ADVICE}")
    return int(actions.shape[0])


def _arrays(
    group: Any, rows: int, skipped: tuple[str, ...]
) -> tuple[dict[str, Callable[[], Column]], dict[str, Clip | Stills]]:
    """Returns the columns and the images below a group, by their paths."""
    columns: dict[str, Callable[[], Column]] = {}
    images: dict[str, Clip | Stills] = {}

    def look(name: str, array: Any) -> None:
        if not isinstance(array, h5py.Dataset) or name.split("/")[0] in skipped:
            return
        if is_pixels(array):
            images[name] = Stills(_pixels(array, rows))
        elif "images/" in name and array.ndim in (1, 2):
            images[name] = Stills(_files(array, rows))
        elif is_numbers(array):
            columns[name] = partial(_column, array, rows)

    with reading(_place(group)):
        group.visititems(look)
    return columns, images


def _require_rows(array: Any, rows: int) -> None:
    if array.shape[0] != rows:
        raise IoError(
            f"{_place(array)} has {array.shape[0]} rows, the actions have {rows}: {ADVICE}. A "
            "mapping file leaves it out: --mapping FILE"
        )


def _column(array: Any, rows: int) -> Column:
    _require_own_bytes(array)
    _require_rows(array, rows)
    return Column(numbers(array, 0, rows, _place(array)))


def _pixels(array: Any, rows: int) -> Iterator[Any]:
    _require_own_bytes(array)
    _require_rows(array, rows)
    yield from pixels(array, 0, rows, _place(array))


def _files(array: Any, rows: int) -> Iterator[bytes]:
    """Yields JPEG or PNG files, which ALOHA pads with zeros to one length."""
    _require_own_bytes(array)
    _require_rows(array, rows)
    for row in range(rows):
        with reading(f"{_place(array)} row {row}"):
            file = bytes(np.asarray(array[row]).view(np.uint8)).rstrip(b"\0")
        yield file


def _settings(text: str, file: Path) -> Entries:
    place = f"'{file}': the attribute env_args"
    with reading(place):
        content = json.loads(text)
    return Entries(content, place)


def _instruction(group: Any) -> str:
    text = _attribute(group, "instruction", "")
    if not is_text(text):
        raise IoError(f"{_place(group)}: the attribute instruction is no text: {ADVICE}")
    return str(text)


def _attribute(group: Any, name: str, default: Any) -> Any:
    """Returns a text, a number, or what else an attribute has."""
    with reading(f"{_place(group)}: the attribute {name}"):
        value = group.attrs.get(name, default)
        if isinstance(value, bytes):
            return value.decode()
        if isinstance(value, np.ndarray | np.generic) and value.size == 1:
            return value.reshape(-1)[0].item()
        return value


def _place(found: Any) -> str:
    """Returns the file and the path of a group or dataset, for messages."""
    file = found.file.filename
    return f"'{file}'" if found.name == "/" else f"'{file}': {ascii(found.name)[1:-1]}"


def _is_demo(name: str) -> bool:
    return name.startswith("demo")


def _number(name: str) -> tuple[int, str]:
    """Returns a key by which demo_2 comes before demo_10."""
    digits = re.search(r"(\d{1,18})$", name)
    return (int(digits[1]) if digits else -1, name)


def _gaps(names: Sequence[str]) -> str:
    """Returns the numbers that sorted names skip: "no 1, 5 to 7 between demo_0 and demo_9"."""
    numbers = [number for number, _ in map(_number, names) if number >= 0]
    gaps = [
        f"{one + 1}" if other == one + 2 else f"{one + 1} to {other - 1}"
        for one, other in itertools.pairwise(numbers)
        if other > one + 1
    ]
    return f"no {shortened(gaps)} between {names[0]} and {names[-1]}" if gaps else ""
