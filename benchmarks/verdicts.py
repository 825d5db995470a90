"""Makes the table at the top of RESULTS.md: which floors and aims its figures reach."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from floor import Floor
from floors import BARE, FLOORS
from recorded import Recorded, circumstance, rows

BEGIN, END = "<!-- verdicts: begin -->", "<!-- verdicts: end -->"
NONE = "–"
LIMITS = """\
What limits the rest, against the core's peak of fused multiply-adds: of inverse kinematics
[decision 013](../docs/decisions/013-inverse-kinematics-stays-in-double.md),
of dynamics [decision 012](../docs/decisions/012-dynamics-in-lanes.md#consequences)."""


@dataclass(frozen=True)
class Verdict:
    """A floor, and what was measured of it.

    Attributes:
        floor: What was to be reached.
        values: Of each robot; empty where nothing was measured.
        instruction_set: What the section says; None where it says nothing.
    """

    floor: Floor
    values: dict[str, float]
    instruction_set: str | None

    @property
    def aim(self) -> float | None:
        """The aim on the section's instruction set; the hardest where there is none for it."""
        aims, measure = self.floor.aims, self.floor.measure
        if not aims:
            return self.floor.aim
        if self.instruction_set is not None and self.instruction_set in aims:
            return aims[self.instruction_set]
        return max(aims.values()) if measure.higher_is_better else min(aims.values())

    @property
    def worst(self) -> float:
        """What is judged."""
        return self.values[self.floor.measure.worst(self.values)]

    def meets(self, bound: float | None) -> bool | None:
        """Whether all robots do; None without a bound or values."""
        if bound is None or not self.values:
            return None
        return self.floor.measure.meets(self.worst, bound)

    @property
    def says(self) -> str:
        """In words."""
        floor, aim = self.meets(self.floor.floor), self.meets(self.aim)
        if not self.values:
            return "not measured"
        if floor is False:
            return "**floor missed**"
        if aim is not None:
            return "aim met" if aim else "aim missed" if floor is None else "floor met"
        return NONE if floor is None else "floor met"


def judge(floor: Floor, sections: Mapping[str, str]) -> Verdict:
    """What the sections say of a floor."""
    section = sections.get(floor.section, "")
    values: dict[str, float] = {}
    for row in rows(section):
        robot = _robot(floor, row)
        value = None if robot is None else floor.measure.of(row)
        if robot is not None and value is not None and robot not in floor.not_meant:
            values[robot] = value
    return Verdict(floor, values, circumstance(section, "instruction set"))


def warnings(sections: Mapping[str, str]) -> list[str]:
    """Rows in which we are faster than what only does a part of our work."""
    return [
        f"- [`{name}`](#{name}), {row.name}: {1 / row.speed:.3f} of the time ({row.note})"
        for name, section in sections.items()
        for row in rows(section)
        if row.speed is not None and row.speed > 1 and any(map(row.has_peer, BARE))
    ]


def summary(sections: Mapping[str, str], floors: Sequence[Floor] = FLOORS) -> str:
    """The table, between its marks, with what is suspicious below."""
    verdicts = [judge(floor, sections) for floor in floors]
    lines = [
        BEGIN,
        "## Floors and aims",
        "",
        _counts(verdicts),
        "",
        LIMITS,
        "",
        "| row | what | floor | aim | worst robot | best robot | verdict | section |",
        "|---|---|---|---|---|---|---|---|",
        *map(_line, verdicts),
    ]
    if odd := warnings(sections):
        lines += ["", "**Disturbed runs, or not the same work**: faster than a part of the work:"]
        lines += ["", *odd]
    return "\n".join([*lines, END, ""])


def _robot(floor: Floor, row: Recorded) -> str | None:
    """The robot of a row that the floor is about; None for other rows."""
    if floor.peer is not None and not row.has_peer(floor.peer):
        return None
    before, _, after = floor.name.partition("{robot}")
    found = re.fullmatch(rf"{re.escape(before)}(\w+){re.escape(after)}", row.name)
    return found[1] if found else None


def _counts(verdicts: Sequence[Verdict]) -> str:
    floors = [
        met for verdict in verdicts if (met := verdict.meets(verdict.floor.floor)) is not None
    ]
    aims = [met for verdict in verdicts if (met := verdict.meets(verdict.aim)) is not None]
    missing = sum(not verdict.values for verdict in verdicts)
    return (
        f"Computed from the sections below. Of {len(floors)} floors every robot meets\n"
        f"{sum(floors)}, of {len(aims)} aims {sum(aims)}; {missing} rows are not measured.\n"
        "The worst robot counts. P1 to P21: [README](README.md#rows). Where an aim depends\n"
        "on the instruction set and the section does not say which it was, the hardest counts."
    )


def _line(verdict: Verdict) -> str:
    floor = verdict.floor
    text = floor.measure.text
    where = f"[`{floor.section}`](#{floor.section})" if verdict.values else NONE
    if verdict.values and verdict.instruction_set:
        where += f", {verdict.instruction_set}"
    aim = ", ".join(f"{text(aim)} ({name})" for name, aim in floor.aims.items())
    cells = [
        floor.row,
        floor.what,
        NONE if floor.floor is None else text(floor.floor),
        aim or (NONE if floor.aim is None else text(floor.aim)),
        _of(verdict, floor.measure.worst),
        _of(verdict, floor.measure.best),
        verdict.says,
        where,
    ]
    return f"| {' | '.join(cells)} |"


def _of(verdict: Verdict, which: Callable[[dict[str, float]], str]) -> str:
    if not verdict.values:
        return NONE
    robot = which(verdict.values)
    return f"{verdict.floor.measure.text(verdict.values[robot])} ({robot})"
