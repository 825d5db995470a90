"""SceneObject: beside a model file the fields of a primitive are ignored."""

from __future__ import annotations

import warnings
from typing import Any

import robocell

PRIMITIVE = ("shape", "size", "rgba", "mass", "friction", "condim")


def _field(name: str) -> Any:
    field: Any = vars(robocell.SceneObject)[name]

    def read(self: SceneObject) -> Any:
        return field.__get__(self)

    def write(self: SceneObject, value: Any) -> None:
        if value is not None and self.mjcf_path:
            self._ignore([name])
        else:
            field.__set__(self, value)

    return property(read, write, doc=field.__doc__)


def _model_file() -> Any:
    field: Any = vars(robocell.SceneObject)["mjcf_path"]

    def read(self: SceneObject) -> Any:
        return field.__get__(self)

    def write(self: SceneObject, value: Any) -> None:
        before = [name for name in PRIMITIVE if getattr(self, name) is not None] if value else []
        for name in before:
            setattr(self, name, None)
        field.__set__(self, value)
        self._ignore(before)

    return property(read, write, doc=field.__doc__)


class SceneObject(robocell.SceneObject):
    """An object: a model file, else a primitive.

    `mjcf_path` takes precedence in any order of setting: `shape`, `size`, `rgba`, `mass`,
    `friction` and `condim` are then ignored, with one warning per object.
    """

    __slots__ = ("_has_warned",)

    def __init__(self, **fields: Any) -> None:
        """Sets fields by name."""
        given = [name for name in PRIMITIVE if fields.get(name) is not None]
        ignored = given if fields.get("mjcf_path") else []
        fields.setdefault("pos", [0, 0, 0])  # mutable in place from the beginning
        super().__init__(**{name: fields[name] for name in fields if name not in ignored})
        self._ignore(ignored)

    shape = _field("shape")
    size = _field("size")
    rgba = _field("rgba")
    mass = _field("mass")
    friction = _field("friction")
    condim = _field("condim")
    mjcf_path = _model_file()

    def _ignore(self, fields: list[str]) -> None:
        if not fields or getattr(self, "_has_warned", False):
            return
        self._has_warned = True
        warnings.warn(
            f"object '{self.name}': {', '.join(fields)} ignored, for its model '{self.mjcf_path}' "
            f"says that; leave the fields of a primitive out",
            stacklevel=3,
        )
