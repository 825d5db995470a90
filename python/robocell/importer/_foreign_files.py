"""Files of a dataset from elsewhere: none lies outside the dataset, none blocks or is endless.

Readers take every path that a dataset says from here, and every library call that decodes its
bytes runs in `reading`.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import stat
import string
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from robocell._core import Error, IoError

LARGEST_TEXT = 256 << 20  # bytes of a JSON file
ADVICE = "the dataset is damaged. Get it again from where it came"
FORMAT = re.compile(r"0?[1-9]?d?")  # of a number in a path: 03d


@contextmanager
def reading(place: str | os.PathLike[str]) -> Iterator[None]:
    """Raises IoError naming the place for whatever a library raises about damaged bytes."""
    what = place if isinstance(place, str) else f"'{place}'"
    try:
        yield
    except (Error, ModuleNotFoundError, AttributeError, NameError):  # damage raises none of them
        raise
    except MemoryError as error:
        raise IoError(f"{what} does not fit into memory: {ADVICE}") from error
    except OSError as error:
        raise IoError(f"cannot read {what}: {error.strerror or error}") from error
    except Exception as error:  # h5py, zarr and pyarrow raise any kind for damaged bytes
        reason = str(error) or type(error).__name__
        raise IoError(f"cannot read {what}: {reason}: {ADVICE}") from error


def confined(root: Path, relative: str, what: str) -> Path:
    """Returns the path of a file inside a folder.

    Args:
        root: The folder of the dataset.
        relative: The path that the dataset says.
        what: Where it says it, which begins the message.

    Raises:
        IoError: The path is absolute, contains "..", a link leads outside, or it is no file.
    """
    path = root / relative
    parts = Path(relative).parts
    is_inside = "\0" not in relative and parts and ".." not in parts and parts[0] != "/"
    if not is_inside or not _real(path).is_relative_to(_real(root)):
        raise IoError(
            f"{what} names the file '{relative}', which is outside of '{root}'. Datasets have "
            "their files inside; copy links with `cp -rL` if you trust them"
        )
    require_file(path)
    return path


def require_file(path: Path) -> None:
    """Raises IoError for a pipe, a device or another path that is no file."""
    with reading(path):
        mode = path.stat().st_mode
    if not stat.S_ISREG(mode):
        raise IoError(f"'{path}' is not a file: {ADVICE}")


def filled(template: str, values: Mapping[str, int | str], what: str) -> str:
    """Returns the path of a template such as "data/chunk-{episode_chunk:03d}/{episode_index}".

    Raises:
        IoError: It has other fields than `values`, or fields with attributes or conversions.
    """
    path = ""
    with reading(what):
        pieces = list(string.Formatter().parse(template))
    for literal, name, form, conversion in pieces:
        path += literal
        if name is None:
            continue
        is_number = isinstance(values.get(name), int)
        is_form = bool(FORMAT.fullmatch(form or "")) if is_number else not form
        if name not in values or conversion or not is_form:
            raise IoError(
                f"{what} is '{template}'; expected a path whose fields are among: "
                f"{', '.join(f'{{{each}}}' for each in values)}"
            )
        path += format(values[name], form or "")
    return path


def parsed(path: Path) -> Any:
    """Returns the content of a JSON file."""
    with reading(path):
        return json.loads(_text(path))


def parsed_lines(path: Path) -> list[Any]:
    """Returns the content of a file with JSON in each line."""
    found = []
    with reading(path):
        lines = _text(path).split("\n")
    for number, line in enumerate(lines, 1):
        if line.strip():
            with reading(f"'{path}' line {number}"):
                found.append(json.loads(line))
    return found


def fingerprint(root: Path, files: Iterable[Path] | None = None) -> str:
    """Returns a hash of the names, sizes and times of a dataset's files.

    Args:
        root: The folder of the dataset.
        files: Its files; None for all in the folder.

    Raises:
        IoError: One of them is a link to the outside, or no file.
    """
    digest = hashlib.sha256()
    real = _real(root)
    for path in sorted(_all(root) if files is None else files):
        if path.is_symlink() and not _real(path).is_relative_to(real):
            raise IoError(
                f"'{path}' is a link to '{os.readlink(path)}', outside of '{root}'. Datasets have "
                "their files inside; copy links with `cp -rL` if you trust them"
            )
        with reading(path):
            facts = path.stat()
        if not stat.S_ISREG(facts.st_mode) and not stat.S_ISDIR(facts.st_mode):
            raise IoError(f"'{path}' is not a file: {ADVICE}")
        name = os.fsencode(path.relative_to(root))
        digest.update(b"%s\0%d %d\n" % (name, facts.st_size, facts.st_mtime_ns))
    return digest.hexdigest()


def _all(root: Path) -> Iterator[Path]:
    """Yields the files below a folder, and links to folders; not what is hidden beside them."""
    for place, folders, files in os.walk(root):
        if place == str(root):
            folders[:] = [name for name in folders if name not in (".git", ".cache")]
        yield from (Path(place) / name for name in files)
        yield from (Path(place) / name for name in folders if (Path(place) / name).is_symlink())


def _real(path: Path) -> Path:
    """Returns a path without links; itself if they form a cycle."""
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError):
        return path.absolute()


def _text(path: Path) -> str:
    require_file(path)
    with path.open("rb") as file:
        content = file.read(LARGEST_TEXT + 1)
    if len(content) > LARGEST_TEXT:
        raise IoError(f"'{path}' has more than {LARGEST_TEXT >> 20} MiB: {ADVICE}")
    return content.decode()
