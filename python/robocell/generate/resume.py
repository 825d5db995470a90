"""Which items of a plan are on the disk already."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

from robocell import Dataset, Error

# With `keep: all` every rollout is kept, as <item>_a<attempt>.
_ATTEMPT = re.compile(r"(?P<item>.+)_a\d+")


class DamagedEpisodesError(Exception):
    """Episodes on the disk are not what was written."""


def made_items(dataset: Path, ids: Collection[str]) -> set[str]:
    """The items among `ids` that have a successful episode in the dataset.

    DamagedEpisodesError names episodes that are there but cannot be opened: they stand in the way.
    """
    episodes = Dataset(dataset)
    made: set[str] = set()
    damaged: list[str] = []
    for name in episodes.ids:
        match = _ATTEMPT.fullmatch(name)
        item = match["item"] if match and name not in ids else name
        if item not in ids or item in made:
            continue
        try:
            if episodes[name].success:  # opening checks that the files are there with their sizes
                made.add(item)
        except (Error, OSError) as error:
            damaged.append(str(error))
    if damaged:
        raise DamagedEpisodesError("\n".join(damaged))
    return made


def is_made(dataset: Path, item_id: str) -> bool:
    """Whether one item has a successful episode; damaged ones count as none."""
    try:
        return bool(made_items(dataset, {item_id}))
    except (DamagedEpisodesError, Error, OSError):
        return False
