"""Errors about elements and arguments, with what there is instead."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeVar

import mujoco

import robocell as rc
from robocell._suggestions import did_you_mean, shortened

T = TypeVar("T")


def look_up(named: Mapping[str, T], name: str, what: str) -> T:
    """Returns the value of a name. Raises NotFoundError that lists all names."""
    if name in named:
        return named[name]
    known = shortened(list(named)) or "none"
    raise rc.NotFoundError(f"{what}: no '{name}'. There are: {known}.{did_you_mean(name, named)}")


def require_among(names: Iterable[str], known: Iterable[str], what: str) -> None:
    """Raises NotFoundError for the first name that is not known."""
    for name in names:
        look_up(dict.fromkeys(known), name, what)


def name_of(model: mujoco.MjModel, kind: str, index: int) -> str:
    """Returns the name of an element of a kind: "body", "joint", ...; "" if it has none."""
    object_type = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
    return mujoco.mj_id2name(model, object_type, int(index)) or ""
