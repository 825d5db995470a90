"""Calls as the guide describes them: closed objects raise errors."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

from robocell import ClosedError

T = TypeVar("T")


def closed_as(kind: str, base: type) -> Callable[[type[T]], type[T]]:
    """Makes a subclass of `base` raise "<kind> is closed: ..." where robocell names the object.

    Programs written for the guide look for these words in the message.
    """

    def decorate(cls: type[T]) -> type[T]:
        for name, attribute in (vars(base) | vars(cls)).items():
            if name.startswith("_") or isinstance(attribute, staticmethod):
                continue
            if isinstance(attribute, property):
                fget, fset = attribute.fget, attribute.fset
                getter = fget and _translated(fget, kind)
                setter = fset and _translated(fset, kind)
                setattr(cls, name, property(getter, setter, None, attribute.__doc__))
            elif callable(attribute) and hasattr(attribute, "__get__"):
                setattr(cls, name, _translated(attribute, kind))
        return cls

    return decorate


def _translated(function: Callable[..., Any], kind: str) -> Callable[..., Any]:
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except ClosedError as error:
            if str(error).startswith(f"{kind} is closed"):
                raise
            raise ClosedError(f"{kind} is closed: {error}") from None

    # Getters of the core have no qualified name, which functools.wraps would refuse.
    for name in functools.WRAPPER_ASSIGNMENTS:
        if (value := getattr(function, name, None)) is not None:
            setattr(call, name, value)
    call.__wrapped__ = function  # type: ignore[attr-defined]
    return call
