"""Values that the files of another dataset say, checked when they are read.

info = Entries(parsed(file), f"'{file}'")
info.whole("chunks_size", least=1)  # IoError naming file, entry, value and what is expected
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

from robocell._core import ArgumentError, IoError
from robocell.importer._foreign_files import ADVICE

SHOWN = 60  # characters of a value in a message
LARGEST = 1 << 53
RATES = (1e-3, 1e5)
LARGEST_NUMERATOR = (1 << 31) // 512 - 1  # of a rate, so that 512 ticks a frame fit into MP4 files
LARGEST_DENOMINATOR = 100_000


class Entries:
    """A table of a file.

    Attributes:
        content: The table.
        place: Where it is, which begins messages.
    """

    def __init__(self, content: Any, place: str) -> None:
        self.place = place
        if not isinstance(content, dict):
            raise IoError(f"{place} is {_shown(content)}; expected a table: {ADVICE}")
        self.content = content

    def __contains__(self, name: str) -> bool:
        return self.content.get(name) is not None

    def text(self, name: str, default: str | None = None) -> str:
        """Returns a text; `default` if there is no entry."""
        if default is not None and name not in self:
            return default
        value = self.content.get(name)
        if not is_text(value):
            raise self.wrong(name, "a text")
        return str(value)

    def whole(self, name: str, least: int = 0) -> int:
        """Returns a whole number, which may be stored as a float."""
        value = self.content.get(name)
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if type(value) is not int or not least <= value <= LARGEST:
            raise self.wrong(name, f"a whole number of at least {least}")
        return value

    def number(self, name: str, default: float) -> float:
        """Returns a number from 0 on; `default` if there is no entry."""
        value = self.content.get(name, default)
        if type(value) not in (int, float) or not 0 <= value <= LARGEST:
            raise self.wrong(name, "a number of at least 0")
        return float(value)

    def table(self, name: str) -> Entries:
        """Returns a table."""
        return Entries(self.content.get(name), f"{self.place}: '{name}'")

    def texts(self, name: str) -> list[str]:
        """Returns a list of texts; empty if there is no entry."""
        value = self.content.get(name)
        if value is None:
            return []
        if not isinstance(value, list) or not all(map(is_text, value)):
            raise self.wrong(name, "a list of texts")
        return value

    def wrong(self, name: str, expected: str) -> IoError:
        """Returns the error for an entry."""
        found = _shown(self.content[name]) if name in self.content else "missing"
        return IoError(f"{self.place}: '{name}' is {found}; expected {expected}: {ADVICE}")


def is_text(value: Any) -> bool:
    """Whether a value is a text that UTF-8 and HDF5 can store."""
    if not isinstance(value, str) or "\0" in value:
        return False
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


def rate_of(value: Any, what: str) -> Fraction:
    """Returns rows per second as a fraction that videos can have.

    Raises:
        ArgumentError: It is no number, or outside of `RATES`.
    """
    hertz = math.nan
    if isinstance(value, int | float) and not isinstance(value, bool):
        hertz = float(min(value, 2 * RATES[1]))
    if not RATES[0] <= hertz <= RATES[1]:
        raise ArgumentError(
            f"{what} is {_shown(value)}; rows per second, from {RATES[0]:g} to {RATES[1]:g}"
        )
    return Fraction(hertz).limit_denominator(
        min(LARGEST_DENOMINATOR, max(1, int(LARGEST_NUMERATOR / hertz)))
    )


def _shown(value: Any) -> str:
    text = ascii(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
