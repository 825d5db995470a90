"""Canaries: the items that a run makes first, spread over the plan. If all fail, the run ends.

    canaries = Canaries(items)
    pending = deque(canaries.first(items))
    canaries.lost(unmade, "other")  # for each item that failed with an error
    if verdict := canaries.verdict():
        ...

A robot that crashes the engine, or a field that no scene can satisfy, would otherwise cost some
processes for each of ten thousand items. One bad scene among many, though, must not end a run.
The decision follows from the plan and the results of these items, not from the speed of workers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from robocell._generation.items import Item
from robocell._generation.protocol import FailureKind
from robocell._generation.totals import Unmade
from robocell._suggestions import counted

MOST = 5


@dataclass(frozen=True)
class Verdict:
    """Why a run ends.

    Attributes:
        kind: Kind of the errors.
        message: The first of them, and what it means for the run.
        summary: The same for a reader who has seen the errors of the items.
    """

    kind: FailureKind
    message: str
    summary: str


class Canaries:
    """The first items of a run; see above.

    Args:
        items: All of them.
        any_made: Others of the plan were made before, so that the run works and needs no canaries.
    """

    def __init__(self, items: Sequence[Item], *, any_made: bool = False) -> None:
        count = 0 if any_made else min(MOST, len(items))
        self._items = [items[index * len(items) // count] for index in range(count)]
        self._all = count == len(items)
        self._losses: dict[str, tuple[FailureKind, Unmade]] = {}

    def first(self, items: Sequence[Item]) -> list[Item]:
        """Returns the items with the canaries first."""
        return [*self._items, *(item for item in items if item not in self._items)]

    def lost(self, unmade: Unmade, kind: FailureKind) -> None:
        """Notes that an item was given up because of an error."""
        self._losses[unmade.id] = (kind, unmade)

    def verdict(self) -> Verdict | None:
        """Returns the failures that end the run, or None while a canary succeeded or is undecided.

        If the canaries are all items, ending early saves nothing: then only wrong specs, which the
        user can fix, are reported as one failure.
        """
        if not self._items or any(item.id not in self._losses for item in self._items):
            return None
        kinds, lost = zip(*(self._losses[item.id] for item in self._items), strict=True)
        wrong_spec = all(kind == "spec" for kind in kinds)
        if self._all and not wrong_spec:
            return None
        message = lost[0].reason
        if self._all:
            summary = f"{counted(len(lost), 'episode')} could not be made, see above"
        else:
            summary = (
                f"None of the {len(lost)} items that were tried first, spread over the plan, "
                "could be made for such errors, and the run ends."
            )
            message += f"\n{summary}"
        if lost[0].reproduce:
            message += f"\nTry one alone: {lost[0].reproduce}"
        return Verdict("spec" if wrong_spec else "other", message, summary)
