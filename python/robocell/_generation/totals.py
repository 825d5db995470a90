"""The counts of a run, during and after it."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from robocell._generation.items import ItemRecord

# These fields are summed; they have the same names in `Totals`, `ItemRecord` and records.
NUMBERS = ("attempts", "accepted", "undecided", "rows")
COUNTERS = ("refusals", "redrawn", "failures", "seconds", "kinds", "rollouts", "made_of")
TIMEOUT = "timeout"  # why a rollout failed that used up `rates.max_steps`


@dataclass(frozen=True)
class Unmade:
    """An item that could not be made, why, and the command that tries it alone."""

    id: str
    reason: str
    reproduce: str


@dataclass(frozen=True)
class Again:
    """An item that was taken up again, and why."""

    id: str
    reason: str


@dataclass(frozen=True)
class Death:
    """A worker that ended when it should not have.

    Attributes:
        worker: Its number.
        pid: Its process.
        item: What it was making, or None.
        reason: 'was killed by SIGKILL (out of memory?)'.
        after_s: Seconds after the start of the run.
    """

    worker: int
    pid: int
    item: str | None
    reason: str
    after_s: float


@dataclass
class Totals:
    """Counts of one run of the command; episodes of earlier runs are in `already` only.

    Attributes:
        planned: Items of the plan (of this shard).
        already: Planned items that were on the disk before the start.
        workers: Worker processes.
        made: Episodes made now.
        attempts: Starts sampled.
        accepted: Starts accepted by the sampler, that is rollouts.
        undecided: Attempts that a stop request ended; no other count includes them.
        rows: Rows of the episodes made now.
        refusals: Reason -> rejected starts.
        redrawn: Reason -> placements of objects and robot rejected within the attempts.
        failures: Reason -> failed rollouts.
        seconds: Stage -> seconds, summed over the workers.
        advice: Reason and remedy of rejected starts, for an item without an accepted one.
        kinds: Object kind -> attempts.
        rollouts: Object kind -> rollouts.
        made_of: Object kind -> episodes made now.
        again: Items retried after a worker died or failed.
        deaths: Workers that died.
        unmade: Items given up.
    """

    planned: int
    already: int = 0
    workers: int = 1
    made: int = 0
    attempts: int = 0
    accepted: int = 0
    undecided: int = 0
    rows: int = 0
    refusals: Counter[str] = field(default_factory=Counter)
    redrawn: Counter[str] = field(default_factory=Counter)
    failures: Counter[str] = field(default_factory=Counter)
    seconds: Counter[str] = field(default_factory=Counter)
    advice: str = ""
    kinds: Counter[str] = field(default_factory=Counter)
    rollouts: Counter[str] = field(default_factory=Counter)
    made_of: Counter[str] = field(default_factory=Counter)
    again: list[Again] = field(default_factory=list)
    deaths: list[Death] = field(default_factory=list)
    unmade: list[Unmade] = field(default_factory=list)
    started: float = field(default_factory=time.monotonic)
    ended: float | None = None

    def add(self, result: ItemRecord) -> None:
        """Counts a result.

        For a stopped item, counts only time and undecided attempts; the next command repeats it and
        counts it fully.
        """
        if result.stopped:
            self.undecided += result.undecided
            self.seconds.update(result.seconds)
            return
        self.made += result.success
        self.advice = self.advice or result.advice
        _add(self, result, NUMBERS)

    @property
    def retries(self) -> int:
        """Number of retries."""
        return len(self.again)

    @property
    def done(self) -> int:
        """Episodes on the disk."""
        return self.already + self.made

    @property
    def elapsed_s(self) -> float:
        """Since the start, until the end if it is over."""
        return (time.monotonic() if self.ended is None else self.ended) - self.started

    @property
    def success_rate(self) -> float | None:
        """Successes per accepted rollout, 0 to 1; None before the first."""
        return self.made / self.accepted if self.accepted else None

    @property
    def acceptance_rate(self) -> float | None:
        """Starts accepted per start sampled, 0 to 1; None before the first."""
        return self.accepted / self.attempts if self.attempts else None

    @property
    def tried(self) -> int:
        """Places for objects and robot that the sampler tried."""
        return self.attempts + self.redrawn.total()

    @property
    def placement_rate(self) -> float | None:
        """Starts accepted per place tried, 0 to 1; None before the first."""
        return self.accepted / self.tried if self.tried else None

    @property
    def per_hour(self) -> float:
        """Episodes made per hour."""
        return 3600 * self.made / self.elapsed_s if self.elapsed_s > 0 else 0.0

    @property
    def eta_s(self) -> float | None:
        """Seconds to go at the rate so far; None before the first episode."""
        left = self.planned - self.done - len(self.unmade)
        return left * self.elapsed_s / self.made if self.made else None

    def to_json(self) -> dict[str, Any]:
        """Returns the JSON object for programs."""
        return {
            "planned": self.planned,
            "already": self.already,
            "made": self.made,
            "unmade": len(self.unmade),
            "attempts": self.attempts,
            "accepted": self.accepted,
            "undecided": self.undecided,
            "success_rate": self.success_rate,
            "acceptance_rate": self.acceptance_rate,
            "tried": self.tried,
            "placement_rate": self.placement_rate,
            "refusals": dict(self.refusals),
            "redrawn": dict(self.redrawn),
            "failures": dict(self.failures),
            "kinds": dict(self.kinds),
            "rollouts": dict(self.rollouts),
            "made_of": dict(self.made_of),
            "retries": self.retries,
            "deaths": len(self.deaths),
            "elapsed_s": round(self.elapsed_s, 3),
            "per_hour": round(self.per_hour, 1),
        }

    def record(self) -> dict[str, Any]:
        """Returns all counts, for `from_record`."""
        return {
            "counts": self.to_json(),
            "workers": self.workers,
            "rows": self.rows,
            "advice": self.advice,
            "seconds": {stage: round(spent, 3) for stage, spent in self.seconds.items()},
            "deaths": [asdict(death) for death in self.deaths],
            "again": [asdict(again) for again in self.again],
            "unmade": [asdict(unmade) for unmade in self.unmade],
        }

    @classmethod
    def from_record(cls, values: Mapping[str, Any]) -> Totals:
        """Reads the result of `record`. Raises KeyError, TypeError or ValueError otherwise."""
        # Lists go before their lengths; the first reports did not have all counts.
        later: dict[str, Any] = {name: {} for name in ("redrawn", "kinds", "rollouts", "made_of")}
        every = {"undecided": 0, **later, **values["counts"], **values}
        numbers = ("planned", "already", "workers", "made", *NUMBERS)
        counts: dict[str, Any] = {name: int(every[name]) for name in numbers}
        counts.update({name: Counter(every[name]) for name in COUNTERS})
        return cls(
            **counts,
            advice=str(every.get("advice", "")),
            again=[Again(**again) for again in every["again"]],
            deaths=[Death(**death) for death in every["deaths"]],
            unmade=[Unmade(**unmade) for unmade in every["unmade"]],
            started=0.0,
            ended=float(every["elapsed_s"]),
        )


def one_after_the_other(runs: Sequence[Totals]) -> Totals:
    """Returns the sum over commands that continued the same items; the last has the unmade ones."""
    whole = _sum(runs)
    whole.planned, whole.unmade = runs[-1].planned, list(runs[-1].unmade)
    whole.workers = max(totals.workers for totals in runs)
    whole.ended = sum(totals.elapsed_s for totals in runs)
    return whole


def side_by_side(shards: Sequence[Totals]) -> Totals:
    """Returns the sum over shards that ran at the same time."""
    whole = _sum(shards)
    whole.ended = max(totals.elapsed_s for totals in shards)
    return whole


def _sum(parts: Sequence[Totals]) -> Totals:
    """Counts and lists added up; none of them was there `already`."""
    whole = Totals(planned=0, workers=0, started=0.0)
    whole.advice = next((part.advice for part in parts if part.advice), "")
    for part in parts:
        _add(whole, part, ("planned", "workers", "made", *NUMBERS))
        for listed in ("again", "deaths", "unmade"):
            getattr(whole, listed).extend(getattr(part, listed))
    return whole


def _add(totals: Totals, part: Totals | ItemRecord, numbers: Sequence[str]) -> None:
    """Adds these numbers and all counters."""
    for name in numbers:
        setattr(totals, name, getattr(totals, name) + getattr(part, name))
    for name in COUNTERS:
        getattr(totals, name).update(getattr(part, name))


def time_hint(failures: Mapping[str, int]) -> str:
    """Returns a hint if most failed rollouts ran out of actions; else ""."""
    if 2 * failures.get(TIMEOUT, 0) <= sum(failures.values()):
        return ""
    return "most failures are rollouts that ran out of actions: raise `rates.max_steps`"


def agreeing(number: int, one: str, several: str) -> str:
    """Returns the verb that agrees with a count: 'is' of 'is' and 'are' for 1."""
    return one if number == 1 else several


def percent(share: float | None) -> str:
    """Returns '95 %', or '-' for None."""
    return "-" if share is None else f"{100 * share:.0f} %"


def duration(seconds: float | None) -> str:
    """Returns '1 h 05 min', '3 min 20 s', '12 s'; '-' for None."""
    if seconds is None:
        return "-"
    whole = round(seconds)
    if whole >= 3600:
        return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
    return f"{whole // 60} min {whole % 60:02d} s" if whole >= 60 else f"{whole} s"


def size(number: float) -> str:
    """Returns '512 B', '3.4 MB'."""
    if round(number) < 1000:
        return f"{number:.0f} B"
    for unit in ("kB", "MB", "GB"):
        number /= 1000
        if float(shown := f"{number:.3g}") < 1000:
            return f"{shown} {unit}"
    number /= 1000
    return f"{number:.3g} TB" if number < 999.5 else f"{number:.0f} TB"
