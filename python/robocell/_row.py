"""Row: what an expert sees of a state. Its images are drawn when one of them is first read.

Arrays are made when they are read: most code reads a few of many names.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import Error, NotFoundError
from robocell._suggestions import did_you_mean, shortened

Array = NDArray[Any]
_LATER: Array = np.empty(0)  # stands for an array that is not made yet


class MissingNameError(NotFoundError, KeyError):
    """A name that a row lacks: the KeyError of a dict, with robocell's text."""

    __str__ = Exception.__str__  # a KeyError shows its text in quotes


class Layout:
    """Where the numbers of each name are in an array of all numbers.

    Args:
        places: Name -> begin, end and shape.
    """

    def __init__(self, places: dict[str, tuple[int, int, tuple[int, ...]]]) -> None:
        self.places = places
        self.placeholders: dict[str, Array] = dict.fromkeys(places, _LATER)


class Row(dict[str, Array]):
    """A dict of numbers and images. Its keys and numbers can be read without drawing anything.

    Args:
        numbers: Name -> numbers.
        images: Names of the images.
        read: Returns name -> image, or None once the row is no longer the present one.

    Images have to be read in see() or act(), while their row is the present one. After the first
    image of a row was read, all of them are kept.
    """

    title = "the row"  # in messages
    without_images = ""  # what to do about images that are not drawn

    def __init__(
        self,
        numbers: dict[str, Array],
        images: Sequence[str],
        read: Callable[[], dict[str, Array] | None],
    ) -> None:
        # Placeholders for images: so keys(), len() and `in` need no code here.
        super().__init__({**numbers, **dict.fromkeys(images, _LATER)})
        self._unread, self._read = frozenset(images), read
        self._places: dict[str, tuple[int, int, tuple[int, ...]]] = {}
        self._all = _LATER

    @classmethod
    def of(
        cls,
        numbers: Array,
        layout: Layout,
        images: Sequence[str],
        read: Callable[[], dict[str, Array] | None] | None,
    ) -> Row:
        """Returns a row whose numbers are parts of one array. Without images it needs no `read`."""
        row = cls(layout.placeholders, images, read or dict)
        row._places, row._all = layout.places, numbers
        return row

    def _make(self, name: str) -> Array:
        """Returns the numbers of a name, and keeps them."""
        begin, end, shape = self._places[name]
        made = self._all[begin:end].reshape(shape)
        super().__setitem__(name, made)
        return made

    def _make_all(self) -> None:
        for name in self._places:
            if super().get(name) is _LATER:
                self._make(name)
        self._places = {}

    def _fetch(self) -> None:
        self._make_all()
        if not self._unread:
            return
        images = self._read()
        if images is None:
            raise Error(
                f"image '{min(self._unread)}' of an earlier row was not read in time: read images "
                "in see() or act(), while their row is the present one"
            )
        self._unread = frozenset()
        self.update(images)

    def __getitem__(self, name: str) -> Array:
        value = super().__getitem__(name)
        if value is not _LATER:
            return value
        if name in self._places:
            return self._make(name)
        self._fetch()
        return super().__getitem__(name)

    def __missing__(self, name: str) -> Array:
        near = did_you_mean(str(name), self)
        images = "" if near or "/" in str(name) else self.without_images
        raise MissingNameError(
            f"{self.title} has no '{name}'.{near or images} It has: {shortened(sorted(self))}"
        )

    def __iter__(self) -> Iterator[str]:
        # Also lets dict(row) and {**row} ask for each value, instead of copying placeholders.
        return super().__iter__()

    def __setitem__(self, name: str, value: Array) -> None:
        if name in self._unread:
            self._fetch()
        super().__setitem__(name, value)

    def get(self, name: str, default: Any = None) -> Any:
        """Returns the value, or `default` for an unknown name."""
        if name not in self:
            return default
        return self[name]

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)


def _fetching(name: str) -> Callable[..., Any]:
    method = getattr(dict, name)

    @functools.wraps(method)
    def call(self: Row, *arguments: Any, **named: Any) -> Any:
        self._fetch()
        return method(self, *arguments, **named)

    return call


_READING = ("values", "items", "copy", "__eq__", "__ne__", "__or__", "__ror__", "__repr__")
_CHANGING = ("__delitem__", "__ior__", "clear", "pop", "popitem", "setdefault", "update")
for _name in (*_READING, *_CHANGING):
    setattr(Row, _name, _fetching(_name))


class NamedColumns(dict[str, Array]):
    """The state of an environment by the names of columns; `Env.row` returns it."""

    def __missing__(self, name: str) -> Array:
        raise MissingNameError(
            f"the row has no '{name}'.{did_you_mean(str(name), self)} It has: "
            f"{shortened(sorted(self))}"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)
