"""Which items of a plan are on the disk already. The disk is judged in C++; see on_disk.h."""

from __future__ import annotations

from collections.abc import Sequence

from robocell import Error, PlanItem, RunConfig, items_on_disk


class DamagedEpisodesError(Exception):
    """Something on the disk has an episode's name and is no whole episode."""


def made_items(run: RunConfig, items: Sequence[PlanItem]) -> set[str]:
    """The ids of the items that have a successful episode in the run's dataset.

    DamagedEpisodesError names what stands in the way of the others.
    """
    made, broken = items_on_disk(run, list(items))
    if broken:
        raise DamagedEpisodesError("\n".join(broken))
    return set(made)


def is_made(run: RunConfig, item: PlanItem) -> bool:
    """Whether one item has a successful episode; what cannot be read counts as none."""
    try:
        return item.id in items_on_disk(run, [item])[0]
    except (Error, OSError):
        return False
