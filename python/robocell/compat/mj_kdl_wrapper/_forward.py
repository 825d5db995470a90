"""Wrappers that forward unknown attributes to one of robocell's objects."""

from __future__ import annotations

from typing import Any

from robocell._arguments import no_attribute
from robocell._elsewhere import no_such


class Forwarding:
    """Forwards to the object in the slot that `_wraps` names; unknown names are refused."""

    __slots__ = ("__weakref__",)
    _wraps = ""

    def __getattr__(self, name: str) -> Any:
        """Returns an attribute of the wrapped object."""
        if name.startswith("_") or name == self._wraps:
            raise AttributeError(name)
        wrapped = getattr(self, self._wraps)
        if not hasattr(type(wrapped), name):
            raise no_such(no_attribute(type(self), name, type(wrapped)), name)
        self._require_open(name)
        return getattr(wrapped, name)

    def _require_open(self, name: str) -> None:
        """Raises the error of the guide's class if it was closed."""

    def __setattr__(self, name: str, value: object) -> None:
        """Sets a known attribute. Raises AttributeError with the nearest name for any other."""
        if hasattr(type(self), name):
            object.__setattr__(self, name, value)
            return
        wrapped = getattr(self, self._wraps)
        if not hasattr(type(wrapped), name):
            raise AttributeError(no_attribute(type(self), name, type(wrapped)))
        self._require_open(name)
        setattr(wrapped, name, value)
