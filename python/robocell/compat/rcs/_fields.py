"""Configurations whose fields are checked: their names when they are set, their values when read.

The error for a misspelt field contains the right one. `as_read` reads all values by their
annotations (`_reading`).
"""

from __future__ import annotations

import copy
import difflib
import inspect
import warnings
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, Self, get_type_hints

from robocell.compat.rcs._reading import form_of


class NamedFields:
    """Base of dataclasses that rejects unknown fields instead of storing them.

    Raises TypeError for an argument, AttributeError for an attribute. Attributes that begin with an
    underscore belong to a subclass.
    """

    _place: str | None = None  # None: the name of the class

    def __new__(cls, *args: Any, **kwargs: Any) -> Any:
        """Refuses arguments that ``__init__`` does not have."""
        parameters = list(inspect.signature(cls.__init__).parameters.values())[1:]
        if all(each.kind != each.VAR_KEYWORD for each in parameters):
            names = [each.name for each in parameters]
            for name in kwargs:
                if name not in names:
                    raise TypeError(_no_field(cls, name, names))
        return super().__new__(cls)

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuses attributes that are not there."""
        cls = type(self)
        fields: dict[str, Any] = getattr(cls, "__dataclass_fields__", {})
        if not name.startswith("_") and name not in fields and not hasattr(cls, name):
            raise AttributeError(_no_field(cls, name, list(fields)))
        super().__setattr__(name, value)

    def as_read(self, place: str | None = None) -> Self:
        """Returns a copy whose values have the types of the annotations.

        Args:
            place: Name of this configuration in errors, such as "robot_cfgs.left"; unless given,
                its former name, else its class. Fields of "" have only their own names.

        Raises:
            TypeError: A value has another type.
            ArgumentError: A value is invalid.
        """
        mine = copy.copy(self)
        place = place if place is not None else self._place
        mine._place = type(self).__name__ if place is None else place
        hints = _hints(type(self))
        for each in fields(self):  # type: ignore[arg-type]
            if not each.name.startswith("_") and each.name in hints:
                value = getattr(self, each.name)
                read = form_of(hints[each.name]).read(value, mine._of(each.name))
                setattr(mine, each.name, read)
        mine._check()
        return mine

    def _check(self) -> None:
        """Raises an error for values that do not fit each other; all have been read."""

    def _of(self, name: str) -> str:
        """Returns the name of a field in errors."""
        place = type(self).__name__ if self._place is None else self._place
        return f"{place}.{name}" if place else name

    def _warn_of_unused(self, instead: Mapping[str, str]) -> None:
        """Warns for each of these fields with another value than its default: it has no effect.

        The warning names the field that has the effect. Python shows each text once.
        """
        for each in fields(self):  # type: ignore[arg-type]
            if each.name in instead and getattr(self, each.name) != each.default:
                warnings.warn(
                    f"{type(self).__name__}.{each.name} does nothing: {instead[each.name]}",
                    stacklevel=2,
                )


def _hints(cls: type) -> dict[str, Any]:
    """Annotations of a class and its bases, but for those with names that only a function knows."""
    hints: dict[str, Any] = {}
    for each in reversed(cls.__mro__):
        try:
            hints |= get_type_hints(each, include_extras=True)
        except NameError:
            continue
    return hints


def _no_field(cls: type, name: str, fields: list[str]) -> str:
    shown = [each for each in fields if not each.startswith("_")]
    near = difflib.get_close_matches(name, shown, 1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return f"a {cls.__name__}: no field '{name}'. Its fields: {', '.join(shown)}.{hint}"
