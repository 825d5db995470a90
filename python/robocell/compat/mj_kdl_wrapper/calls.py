"""Calls with names of arguments that there are not, told as robocell's own classes tell them."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from robocell._arguments import Form, Parameter, name_problem

P = ParamSpec("P")
T = TypeVar("T")


def told(function: Callable[P, T]) -> Callable[P, T]:
    """The same function; a misspelt name is a TypeError with the nearest that there is."""
    known = [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]
    form = Form([Parameter(name, None, None) for name in known], [], False, False)

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> T:
        for name in kwargs:
            if name not in known:
                raise TypeError(f"{function.__qualname__}(): {name_problem(form, name)}")
        return function(*args, **kwargs)

    return call
