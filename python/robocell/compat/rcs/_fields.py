"""Configurations in which a misspelt field is an error that names the right one."""

from __future__ import annotations

import difflib
import inspect
from typing import Any


class NamedFields:
    """Base of dataclasses: what is no field is refused, where Python would keep it unread.

    TypeError for an argument, AttributeError for an attribute. Attributes that begin with an
    underscore are a subclass's own.
    """

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


def _no_field(cls: type, name: str, fields: list[str]) -> str:
    shown = [each for each in fields if not each.startswith("_")]
    near = difflib.get_close_matches(name, shown, 1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return f"a {cls.__name__}: no field '{name}'. Its fields: {', '.join(shown)}.{hint}"
