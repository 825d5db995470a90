"""A goal: its floor, its aim, and the place of the measured figure in RESULTS.md."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from measures import TIMES_AS_FAST, Measure


@dataclass(frozen=True)
class Floor:
    """One thing to reach.

    Attributes:
        row: P1 to P21.
        what: What is measured, against whom.
        section: Of RESULTS.md; "" where no benchmark measures it.
        name: Of the rows there, with {robot} for the robot.
        peer: As the rows' notes call it; None for rows with any peer or none.
        measure: The number that is judged.
        floor: What the worst robot must reach; None where nothing is demanded.
        aim: What it should reach; None where nothing more is wanted.
        aims: The same on an instruction set, where it depends on it.
        not_meant: Robots that are left out, which `what` explains.
    """

    row: str
    what: str
    section: str = ""
    name: str = ""
    peer: str | None = None
    measure: Measure = TIMES_AS_FAST
    floor: float | None = None
    aim: float | None = None
    aims: Mapping[str, float] = field(default_factory=dict)
    not_meant: tuple[str, ...] = ()
