"""The fields of a specification by their names, for comparisons.

    fields_of(run)["task.lift_height"]  # '0.05'

Paths are told by the name of their file: the same models may be anywhere.
"""

from __future__ import annotations

import enum
import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

# Properties that say where a specification was read, and what follows from others.
_NO_FIELDS = ("source_dir", "used_modes")
_FILES = (".xml", ".mjb", ".urdf", ".yaml", ".yml", ".obj", ".stl", ".py", ".so")


def fields_of(spec: Any) -> dict[str, str]:
    """Returns {'rates.policy_ms': '40'} of a specification; unset fields are left out."""
    return dict(_flat("", spec))


def fields_in(kind: type) -> set[str]:
    """Returns the names of the fields of a kind of specification."""
    names = [name for name in dir(kind) if not name.startswith("_")]
    return {name for name in names if isinstance(getattr(kind, name), property)} - set(_NO_FIELDS)


def file_hashes(files: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Returns {"file 'rc7.xml'": hash} of (path, hash); several files may have one name."""
    found: dict[str, set[str]] = {}
    for path, digest in files:
        found.setdefault(Path(path).name, set()).add(digest)
    return {f"file '{name}'": " ".join(sorted(found[name])) for name in sorted(found)}


def hashes_in(folder: Path) -> Iterator[tuple[str, str]]:
    """Yields (path, SHA-256) of the files in a folder."""
    for file in sorted(folder.rglob("*")):
        if file.is_file():
            yield str(file), hashlib.sha256(file.read_bytes()).hexdigest()


def _flat(name: str, value: Any) -> Iterator[tuple[str, str]]:
    inner = _parts(value)
    if inner is None:
        if value is not None:
            yield name or "?", _text(value)
        return
    for key, each in inner.items():
        yield from _flat(f"{name}.{key}" if name else str(key), each)


def _parts(value: Any) -> Mapping[str, Any] | None:
    """Returns the fields of a specification, the values of a mapping or list of them."""
    if hasattr(value, "to_dict"):
        return dict(value.to_dict())
    if hasattr(value, "to_yaml"):
        return {name: getattr(value, name) for name in sorted(fields_in(type(value)))}
    if hasattr(value, "keys"):
        return {str(key): value[key] for key in value.keys()}  # noqa: SIM118  (no dictionary)
    if _is_list(value) and any(_parts(each) is not None for each in value):
        return {str(number): each for number, each in enumerate(value)}
    return None


def _is_list(value: Any) -> bool:
    is_text = isinstance(value, str | bytes | np.ndarray | enum.Enum)
    return not is_text and hasattr(value, "__len__") and hasattr(value, "__getitem__")


def _text(value: Any) -> str:
    if isinstance(value, enum.Enum):
        return value.name.lower()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return str(value).removesuffix(".0")
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if _is_list(value):
        return f"[{', '.join(map(_text, value))}]"
    text = str(value)
    is_path = os.path.isabs(text) or text.endswith(_FILES)
    return Path(text).name if is_path and "\n" not in text else text
