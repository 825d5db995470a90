"""Finds plan items that are already on the disk. C++ judges the disk; see on_disk.h."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from robocell import Error, RunConfig
from robocell._generation.items import ItemRecord
from robocell.data import Episode
from robocell.generate import PlanItem, items_on_disk


class DamagedEpisodesError(Exception):
    """A file or folder has an episode's name but is not a complete episode of the run.

    Attributes:
        made: Ids of the completed items.
    """

    def __init__(self, text: str, made: Iterable[str] = ()) -> None:
        super().__init__(text)
        self.made = set(made)


def made_items(run: RunConfig, items: Sequence[PlanItem]) -> set[str]:
    """Returns the ids of the completed items in the run's dataset.

    Raises DamagedEpisodesError with the entries that block the others.
    """
    made, broken = items_on_disk(run, list(items))
    if broken:
        raise DamagedEpisodesError("\n".join(broken), made)
    return set(made)


def result_of(run: RunConfig, item: PlanItem) -> ItemRecord | None:
    """Returns the result of a completed item as read from the disk; None for others.

    It equals the worker's result, but has no times and no placements within attempts. Unreadable
    items count as missing.
    """
    try:
        if item.id not in items_on_disk(run, [item])[0]:
            return None
        return _result(run, item, _success_of(run, item))
    except (Error, OSError):
        return None


def _success_of(run: RunConfig, item: PlanItem) -> Episode:
    """Returns the item's successful episode; with stored failures, the last attempt's."""
    output = Path(run.output)
    attempts = [file.parent for file in output.glob(f"{item.id}_a*/episode.json")]
    return Episode(max(attempts, key=_number_of_attempt, default=output / item.id))


def _number_of_attempt(folder: Path) -> int:
    """Returns 100 for 's0000_e0001_a100', which comes after '..._a99'."""
    number = folder.name.rpartition("_a")[2]
    return int(number) if number.isdecimal() else -1


def _result(run: RunConfig, item: PlanItem, episode: Episode) -> ItemRecord:
    metadata: Any = episode.metadata
    kind = next(iter(metadata["object_kinds"]), "")
    earlier: list[dict[str, Any]] = metadata.get("earlier_attempts", [])
    failed = [attempt for attempt in earlier if "failed" in attempt]
    ended = [attempt for attempt in failed if not attempt.get("raised", False)]
    own_failure = [] if episode.success else [str(episode.end_reason)]
    rollouts = [*(attempt["object_kind"] for attempt in ended), kind]
    refused = [attempt for attempt in earlier if "refused" in attempt]
    kinds = [*(attempt["object_kind"] for attempt in refused), *rollouts]
    return ItemRecord(
        item.id,
        success=episode.success,
        complete=True,
        attempts=metadata["attempt"] + 1,
        accepted=len(ended) + 1,
        refusals=Counter(attempt["refused"] for attempt in refused),
        failures=Counter([*(attempt["failed"] for attempt in failed), *own_failure]),
        rows=len(episode),
        robot=run.robot.name,
        object_kind=kind,
        kinds=Counter(name for name in kinds if name),
        rollouts=Counter(name for name in rollouts if name),
    )
