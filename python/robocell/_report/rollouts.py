"""Counts rollouts and refusals of a dataset, also of those that left no episode.

`report.json` knows every attempt of the items that it lists. Other items, made by commands that
were killed or by a Runner, are counted from their episodes, which list the attempts before them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from robocell._generation.items import ItemRecord
from robocell._report.facts import EpisodeFacts
from robocell.evaluate import wilson_interval


@dataclass(frozen=True)
class Rate:
    """Successes of a group of rollouts.

    Attributes:
        name: The group.
        successes: Those that succeeded.
        rollouts: All of them.
    """

    name: str
    successes: int
    rollouts: int

    @property
    def share(self) -> float:
        """The success rate, 0 to 1."""
        return self.successes / self.rollouts if self.rollouts else 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % Wilson interval of the success rate."""
        return wilson_interval(self.successes, self.rollouts)


PARTS = ("task", "object", "robot")


@dataclass(frozen=True)
class Rollouts:
    """All rollouts of a dataset.

    Attributes:
        by: 'task', 'object', 'robot' -> rates of its values; the largest groups first.
        whole: The rate of all rollouts.
        failures: Reason -> failed rollouts, and attempts in which a user's code raised.
        refusals: Reason -> rejected starts.
    """

    by: dict[str, list[Rate]]
    whole: Rate
    failures: Counter[str]
    refusals: Counter[str]

    @property
    def sampled(self) -> int:
        """Starts sampled: accepted ones and refusals."""
        return self.whole.rollouts + self.refusals.total()


def count(episodes: Sequence[EpisodeFacts], records: Iterable[ItemRecord]) -> Rollouts:
    """Counts them.

    Args:
        episodes: The episodes on the disk.
        records: Results of items, as `report.json` lists them.
    """
    failures: Counter[str] = Counter()
    refusals: Counter[str] = Counter()
    tried: Counter[tuple[str, str, str]] = Counter()  # (task, object, robot) -> rollouts
    done: Counter[tuple[str, str, str]] = Counter()
    of_item = {episode.item: episode for episode in episodes}
    tasks = {episode.task for episode in episodes}
    only_task = next(iter(tasks)) if len(tasks) == 1 else ""
    known = set()
    for result in records:
        if result.stopped or result.resumed:
            continue
        known.add(result.id)
        episode = of_item.get(result.id)
        task = episode.task if episode else only_task
        robot = result.robot or (", ".join(episode.robots) if episode else "")
        failures.update(result.failures)
        refusals.update(result.refusals)
        made = result.made_of or ({"": 1} if result.success else {})
        rollouts = Counter(result.rollouts)
        rollouts[""] += max(0, result.accepted - rollouts.total())
        for kind in {*rollouts, *made}:
            # A success is a rollout even where an older report did not list rollouts by kind.
            tried[task, kind, robot] += max(rollouts[kind], made.get(kind, 0))
            done[task, kind, robot] += made.get(kind, 0)
    for episode in episodes:
        if episode.item in known:
            continue
        robot = ", ".join(episode.robots)
        tried[episode.task, episode.object_kind, robot] += 1
        done[episode.task, episode.object_kind, robot] += episode.success
        if not episode.success:
            failures[episode.end_reason] += 1
        # Each episode of an item lists all attempts before it; the last one has the whole list.
        for attempt in episode.earlier if of_item[episode.item] is episode else ():
            if attempt.refused:
                refusals[attempt.reason] += 1
            elif attempt.raised:  # no rollout, and no episode either, as in `report.json`
                failures[attempt.reason] += 1
            elif episode.keep not in ("all", "first"):  # there it is an episode of its own
                tried[episode.task, attempt.object_kind or episode.object_kind, robot] += 1
                failures[attempt.reason] += 1
    whole = Rate("all", done.total(), tried.total())
    by = {name: _grouped(tried, done, place) for place, name in enumerate(PARTS)}
    return Rollouts(by, whole, failures, refusals)


def rates(pairs: Iterable[tuple[str, bool]]) -> list[Rate]:
    """Returns the rate of each name, of (name, success) pairs; names in order of appearance."""
    tried: Counter[str] = Counter()
    done: Counter[str] = Counter()
    for name, success in pairs:
        tried[name] += 1
        done[name] += success
    return [Rate(name, done[name], number) for name, number in tried.items()]


def _grouped(
    tried: Counter[tuple[str, str, str]], done: Counter[tuple[str, str, str]], place: int
) -> list[Rate]:
    """Returns the rates by one part of the keys; without any if no rollout has that part."""
    rollouts: Counter[str] = Counter()
    successes: Counter[str] = Counter()
    for key, number in tried.items():
        rollouts[key[place]] += number
        successes[key[place]] += done[key]
    if not any(rollouts):
        return []
    return [
        Rate(name or "unknown", successes[name], number)
        for name, number in rollouts.most_common()
        if number
    ]
