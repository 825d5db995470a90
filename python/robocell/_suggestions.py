"""Texts of messages: the nearest name of a missing one, names by pattern, counted nouns."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence

from robocell._core import NotFoundError

MOST_LISTED = 12


def did_you_mean(name: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Returns " Did you mean 'joint7'?", or "" if no name is near.

    `cutoff`: how alike the names must be, from 0 to 1.
    """
    near = difflib.get_close_matches(name, list(known), 1, cutoff)
    return f" Did you mean '{near[0]}'?" if near else ""


def shortened(names: Sequence[str]) -> str:
    """Returns "a, b, c and 5 more"."""
    more = len(names) - MOST_LISTED
    return ", ".join(names[:MOST_LISTED]) + (f" and {more} more" if more > 0 else "")


def counted(number: int, noun: str) -> str:
    """'1 worker', '2 workers'."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def is_pattern(name: str) -> bool:
    """Returns True for a pattern: "*sensors/*"."""
    return "*" in name


def fitting(place: str, names: Iterable[str], known: Sequence[str]) -> list[str]:
    """Expands patterns and returns each name once, in order.

    Names that are not patterns stay, known or not. Raises NotFoundError for a pattern without a
    match; `place` begins its message.
    """
    found: dict[str, None] = {}
    for name in names:
        fits = re.compile(".*".join(map(re.escape, name.split("*")))).fullmatch
        fit = [each for each in known if fits(each)] if is_pattern(name) else [name]
        if not fit:
            raise NotFoundError(f"{place}: nothing fits '{name}'. There are: {', '.join(known)}")
        found.update(dict.fromkeys(fit))
    return list(found)
