"""What floors and aims are about: a number of a recorded row, which way it is better, its text."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from recorded import Recorded


@dataclass(frozen=True)
class Measure:
    """A kind of number.

    Attributes:
        of: Reads it from a row; None where the row has none.
        text: Writes it.
        higher_is_better: Whether floor and aim are the least; else they are the most.
    """

    of: Callable[[Recorded], float | None]
    text: Callable[[float], str]
    higher_is_better: bool = True

    def meets(self, value: float, bound: float) -> bool:
        """Whether a value is at the bound or better."""
        return value >= bound if self.higher_is_better else value <= bound

    def worst(self, values: dict[str, float]) -> str:
        """The name of the worst."""
        order = min if self.higher_is_better else max
        return order(values, key=lambda name: values[name])

    def best(self, values: dict[str, float]) -> str:
        """The name of the best."""
        order = max if self.higher_is_better else min
        return order(values, key=lambda name: values[name])


def _found(pattern: str) -> Callable[[Recorded], float | None]:
    def read(row: Recorded) -> float | None:
        found = re.search(pattern, row.note)
        return float(found[1]) if found else None

    return read


def _longer(row: Recorded) -> float | None:
    return row.speed and 1 / row.speed


def _times(value: float) -> str:
    return f"{value:,.0f}×" if value >= 100 else f"{value:.3g}×"


def _percent(value: float) -> str:
    return f"{value:.3f}".removesuffix("0") + " %"  # 19 999 of 20 000 are no 100.00 %


# Ours are the first of "solved ... / ..." and "p50, p99 ..., ... / ..., ...".
TIMES_AS_FAST = Measure(lambda row: row.speed, _times)
TIMES_AS_LONG = Measure(_longer, lambda value: f"{value:.5g} times", higher_is_better=False)
MORE_TIME = Measure(_longer, lambda value: f"{100 * (value - 1):+.1f} %", higher_is_better=False)
RATE = Measure(lambda row: row.ours, lambda value: f"{value:,.0f}")
MILLISECONDS = Measure(
    lambda row: row.ours, lambda value: f"{value:.3g} ms", higher_is_better=False
)
SOLVED = Measure(_found(r"solved ([\d.]+)%"), _percent)
P50 = Measure(_found(r"p50, p99 ([\d.]+),"), lambda value: f"{value:g} µs", higher_is_better=False)
P99 = Measure(
    _found(r"p50, p99 [\d.]+, ([\d.]+)"), lambda value: f"{value:g} µs", higher_is_better=False
)
