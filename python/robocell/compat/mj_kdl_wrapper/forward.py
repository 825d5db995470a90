"""Wrappers of one of robocell's objects: what they do not have themselves is the object's."""

from __future__ import annotations

from typing import Any

from robocell._arguments import no_attribute
from robocell._elsewhere import no_such


class Forwarding:
    """Forwards to the object in the slot that `_wraps` names; unknown names are refused."""

    __slots__ = ("__weakref__",)
    _wraps = ""

    def __getattr__(self, name: str) -> Any:
        """The wrapped object's."""
        if name.startswith("_") or name == self._wraps:
            raise AttributeError(name)
        wrapped = getattr(self, self._wraps)
        if not hasattr(type(wrapped), name):
            raise no_such(no_attribute(type(self), name, type(wrapped)), name)
        self._require_open(name)
        return getattr(wrapped, name)

    def _require_open(self, name: str) -> None:
        """Raises what the guide's class raises when it was closed."""

    def __setattr__(self, name: str, value: object) -> None:
        """Of what there is; AttributeError with the nearest name for what there is not."""
        if hasattr(type(self), name):
            object.__setattr__(self, name, value)
            return
        wrapped = getattr(self, self._wraps)
        if not hasattr(type(wrapped), name):
            raise AttributeError(no_attribute(type(self), name, type(wrapped)))
        self._require_open(name)
        setattr(wrapped, name, value)
