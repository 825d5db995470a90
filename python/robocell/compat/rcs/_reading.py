"""Reads the values of a configuration's fields by their annotations.

Raises TypeError for a value of another form, ArgumentError for one outside its bounds. Both name
the field in the page's words (``robot_cfgs.left.joints[2]``), the expected value and the given one.
``Annotated[float, Above(0)]`` adds a bound; a `Form` in ``Annotated`` replaces the annotation.
"""

from __future__ import annotations

import difflib
import enum
import inspect
import math
import os
import types
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Annotated, Any, Union, get_args, get_origin

import robocell as rc
from robocell._arguments import show


@dataclass(frozen=True)
class Form:
    """Describes an expected value (singular and plural) and reads it."""

    words: str
    many: str
    read: Callable[[Any, str], Any]


@dataclass(frozen=True)
class Above:
    """A bound that is not allowed itself."""

    limit: float

    def holds(self, value: float) -> bool:
        return value > self.limit

    def __str__(self) -> str:
        return f"above {self.limit:g}"


@dataclass(frozen=True)
class AtLeast:
    """A bound that is allowed itself."""

    limit: float

    def holds(self, value: float) -> bool:
        return value >= self.limit

    def __str__(self) -> str:
        return f"of at least {self.limit:g}"


def misfit(place: str, words: str, value: Any, hint: str = "") -> TypeError:
    """Returns the error for a value of the wrong form."""
    return TypeError(f"{place}: expected {words}, found {show(value)}{hint}")


def outside(place: str, words: str, found: Any, hint: str = "") -> rc.ArgumentError:
    """Returns the error for a value out of range."""
    return rc.ArgumentError(f"{place}: expected {words}, found {found}{hint}")


def form_of(kind: Any) -> Form:
    """Returns the form of an annotation; any value for an unknown one."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _annotated(arguments[0], arguments[1:])
    if origin in (Union, types.UnionType) and types.NoneType in arguments:
        others = [each for each in arguments if each is not types.NoneType]
        return _or_none(form_of(others[0])) if len(others) == 1 else ANYTHING
    if origin is not None and issubclass(origin, Mapping) and len(arguments) == 2:
        return _mapping_to(form_of(arguments[1]))
    if origin is not None and issubclass(origin, Sequence) and len(arguments) == 1:
        return list_of(form_of(arguments[0]))
    if isinstance(kind, type) and kind is not Any:
        return PLAIN[kind] if kind in PLAIN else _object_of(kind)
    return ANYTHING


def list_of(item: Form) -> Form:
    """Returns the form of a list of values of one form; a string is not such a list."""
    words = f"a list of {item.many}"

    def read(value: Any, place: str) -> list[Any]:
        unlike = isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable)
        if unlike or getattr(value, "shape", None) == ():
            is_item = isinstance(value, str) and item is TEXT
            raise misfit(place, words, value, f"; of one it is [{value!r}]" if is_item else "")
        return [item.read(each, f"{place}[{i}]") for i, each in enumerate(value)]

    return Form(words, "lists", read)


def _annotated(kind: Any, notes: tuple[Any, ...]) -> Form:
    for note in notes:
        if isinstance(note, Form):
            return note
    form = form_of(kind)
    for note in notes:
        if isinstance(note, Above | AtLeast):
            form = _bounded(form, note)
    return form


def _bounded(form: Form, bound: Above | AtLeast) -> Form:
    words = f"{form.words} {bound}"

    def read(value: Any, place: str) -> Any:
        number = form.read(value, place)
        if not bound.holds(number):
            raise outside(place, words, f"{number:g}")
        return number

    return Form(words, f"{form.many} {bound}", read)


def _or_none(form: Form) -> Form:
    def read(value: Any, place: str) -> Any:
        return None if value is None else form.read(value, place)

    return Form(f"{form.words} or None", form.many, read)


def _mapping_to(item: Form) -> Form:
    words = f"a dictionary from names to {item.many}"

    def read(value: Any, place: str) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            raise misfit(place, words, value)
        for key in value:
            if not isinstance(key, str):
                raise misfit(place, "texts as its keys", key)
        return {str(key): item.read(each, f"{place}.{key}") for key, each in value.items()}

    return Form(words, "dictionaries", read)


def _object_of(kind: type) -> Form:
    if issubclass(kind, enum.Enum):
        return _member_of(kind)
    name = kind.__name__
    words = f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"

    def read(value: Any, place: str) -> Any:
        if isinstance(value, kind):
            return value.as_read(place) if hasattr(value, "as_read") else value
        if isinstance(value, Mapping) and kind in FROM_DICTIONARIES:
            try:
                return kind(**value)
            except (TypeError, rc.Error) as error:
                raise type(error)(f"{place}: {error}") from None
        is_class = inspect.isclass(value) and issubclass(value, kind)
        hint = f"; make one of the class: {value.__name__}(...)" if is_class else ""
        raise misfit(place, words, value, hint)

    return Form(words, f"{name} objects", read)


def _member_of(kind: type[enum.Enum]) -> Form:
    """Returns the form of a member of an enumeration, or its name."""
    members = {name.lower(): member for name, member in kind.__members__.items()}
    words = f"a {kind.__name__} ({', '.join(kind.__members__)})"

    def read(value: Any, place: str) -> enum.Enum:
        if isinstance(value, kind):
            return value
        if not isinstance(value, str):
            raise misfit(place, words, value)
        if value.lower() not in members:
            near = difflib.get_close_matches(value.lower(), list(members), 1)
            hint = f". Did you mean '{members[near[0]].name}'?" if near else ""
            raise outside(place, words, repr(value), hint)
        return members[value.lower()]

    return Form(words, f"{kind.__name__} members", read)


def _plain(value: Any) -> Any:
    """Converts a number of numpy or torch to Python's."""
    is_number = getattr(value, "shape", None) == () and hasattr(value, "item")
    return value.item() if is_number else value


def _number(value: Any, place: str) -> float:
    number = _plain(value)
    if not isinstance(number, Real) or isinstance(number, bool):
        raise misfit(place, "a number", value)
    try:
        number = float(number)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise outside(place, "a finite number", number)
    return number


def _whole(value: Any, place: str) -> int:
    number = _plain(value)
    if isinstance(number, Integral) and not isinstance(number, bool):
        return int(number)
    if isinstance(number, float) and number.is_integer():
        return int(number)
    raise misfit(place, "a whole number", value)


def _truth(value: Any, place: str) -> bool:
    truth = _plain(value)
    if not isinstance(truth, bool):
        raise misfit(place, "True or False", value)
    return truth


def _text(value: Any, place: str) -> str:
    if not isinstance(value, str):
        raise misfit(place, "a text", value)
    return str(value)


def _path(value: Any, place: str) -> str:
    path = os.fspath(value) if isinstance(value, os.PathLike) else value
    if not isinstance(path, str):
        raise misfit(place, "a path or a model's name", value)
    if not path:
        raise outside(place, "a path or a model's name", "an empty text")
    return str(path)


def _pose(value: Any, place: str) -> rc.Pose:
    if not isinstance(value, rc.Pose):
        hint = "; write Pose(translation=[x, y, z], quaternion=[x, y, z, w])"
        raise misfit(place, "a Pose", value, hint)
    return value


ANYTHING = Form("a value", "values", lambda value, _: value)
NUMBER = Form("a number", "numbers", _number)
TEXT = Form("a text", "texts", _text)
PATH = Form("a path or a model's name", "paths", _path)
PLAIN: dict[type, Form] = {
    bool: Form("True or False", "True or False", _truth),
    int: Form("a whole number", "whole numbers", _whole),
    float: NUMBER,
    str: TEXT,
    rc.Pose: Form("a Pose", "Poses", _pose),
}
FROM_DICTIONARIES = (rc.envs.WrapperConfig, rc.envs.CameraAdderConfig)

Path = Annotated[str | os.PathLike[str], PATH]
