"""Which items of a plan are on the disk already. The disk is judged in C++; see on_disk.h."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from robocell import Error, RunConfig
from robocell.data import Episode
from robocell.generate import PlanItem, items_on_disk
from robocell.generate.items import ItemResult


class DamagedEpisodesError(Exception):
    """Something on the disk has an episode's name and is no whole episode of the run.

    Attributes:
        made: The ids of the items that are there all the same.
    """

    def __init__(self, text: str, made: Iterable[str] = ()) -> None:
        super().__init__(text)
        self.made = set(made)


def made_items(run: RunConfig, items: Sequence[PlanItem]) -> set[str]:
    """The ids of the items of which nothing is left to be made in the run's dataset.

    DamagedEpisodesError names what stands in the way of the others.
    """
    made, broken = items_on_disk(run, list(items))
    if broken:
        raise DamagedEpisodesError("\n".join(broken), made)
    return set(made)


def result_of(run: RunConfig, item: PlanItem) -> ItemResult | None:
    """What the disk says of an item of which nothing is left to be made; of others None.

    As the worker would have reported it, but for its times and the places tried within attempts.
    What cannot be read counts as none.
    """
    try:
        if item.id not in items_on_disk(run, [item])[0]:
            return None
        return _result(run, item, _success_of(run, item))
    except (Error, OSError):
        return None


def _success_of(run: RunConfig, item: PlanItem) -> Episode:
    """The item's successful episode; with failures kept, the last of its attempts."""
    output = Path(run.output)
    attempts = [file.parent for file in output.glob(f"{item.id}_a*/episode.json")]
    return Episode(max(attempts, key=_number_of_attempt, default=output / item.id))


def _number_of_attempt(folder: Path) -> int:
    """100 of 's0000_e0001_a100', which comes after '..._a99'."""
    number = folder.name.rpartition("_a")[2]
    return int(number) if number.isdecimal() else -1


def _result(run: RunConfig, item: PlanItem, episode: Episode) -> ItemResult:
    metadata: Any = episode.metadata
    kind = next(iter(metadata["object_kinds"]), "")
    earlier: list[dict[str, Any]] = metadata.get("earlier_attempts", [])
    failed = [attempt for attempt in earlier if "failed" in attempt]
    own_failure = [] if episode.success else [str(episode.end_reason)]
    rollouts = [*(attempt["object_kind"] for attempt in failed), kind]
    refused = [attempt for attempt in earlier if "refused" in attempt]
    kinds = [*(attempt["object_kind"] for attempt in refused), *rollouts]
    return ItemResult(
        item.id,
        success=episode.success,
        complete=True,
        attempts=metadata["attempt"] + 1,
        accepted=len(failed) + 1,
        refusals=Counter(attempt["refused"] for attempt in refused),
        failures=Counter([*(attempt["failed"] for attempt in failed), *own_failure]),
        rows=len(episode),
        robot=run.robot.name,
        object_kind=kind,
        kinds=Counter(name for name in kinds if name),
        rollouts=Counter(name for name in rollouts if name),
    )
