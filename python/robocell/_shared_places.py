"""Finds containers and arrays that two places in the attributes of an object share."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Attributes = Iterable[tuple[str, Any]]


@dataclass(frozen=True)
class Place:
    """Where a value is: `text` is 'seen['poses'][0]' in the attribute 'seen'."""

    attribute: str
    text: str

    def __str__(self) -> str:
        return self.text

    def inner(self, part: str) -> Place:
        """Returns the place of a part, such as '[0]' or '.best'."""
        return Place(self.attribute, f"{self.text}{part}")


def shared_places(
    attributes: Attributes,
    owner: object,
    is_object: Callable[[Any], bool],
    attributes_of: Callable[[Any], Attributes],
) -> Iterator[tuple[Place, Place]]:
    """Yields pairs of places that share a list, a dict, a set or the numbers of an array.

    Objects are entered once: a restored state keeps them, so their second places are no copies.

    Args:
        attributes: Name and value of each attribute.
        owner: The object that has them.
        is_object: Whether a value is an object whose attributes are looked through.
        attributes_of: Returns the attributes of such an object.
    """
    finder = _Finder(owner, is_object, attributes_of)
    for name, value in attributes:
        yield from finder.visit(Place(name, name), value)


class _Finder:
    def __init__(
        self,
        owner: object,
        is_object: Callable[[Any], bool],
        attributes_of: Callable[[Any], Attributes],
    ) -> None:
        self._entered = {id(owner)}
        self._containers: dict[int, Place] = {}
        self._arrays: dict[int, list[tuple[Place, npt.NDArray[Any]]]] = {}  # by their base
        self._is_object, self._attributes_of = is_object, attributes_of

    def visit(self, place: Place, value: Any) -> Iterator[tuple[Place, Place]]:
        if type(value) in (list, dict, set):
            first = self._containers.setdefault(id(value), place)
            if first is not place:
                yield first, place
                return
        if type(value) is dict:
            for key, each in value.items():
                yield from self.visit(place.inner(f"[{key!r}]"), each)
        elif type(value) in (list, tuple):
            for index, each in enumerate(value):
                yield from self.visit(place.inner(f"[{index}]"), each)
        elif isinstance(value, np.ndarray):
            yield from self._visit_array(place, value)
        elif id(value) not in self._entered and self._is_object(value):
            self._entered.add(id(value))
            for name, each in self._attributes_of(value):
                yield from self.visit(place.inner(f".{name}"), each)

    def _visit_array(self, place: Place, value: npt.NDArray[Any]) -> Iterator[tuple[Place, Place]]:
        alike = self._arrays.setdefault(id(_base_of(value)), [])
        for other, array in alike:
            if np.shares_memory(value, array):
                yield other, place
                return
        alike.append((place, value))


def _base_of(value: npt.NDArray[Any]) -> object:
    """Returns the object that owns the memory of an array."""
    base: Any = value
    while isinstance(base, np.ndarray) and base.base is not None:
        base = base.base
    return base
