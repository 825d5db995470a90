"""One row of the results, and the table of all."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

OF_TURNS = "turns"  # stands in a table beside ratios that are not those of the best


@dataclass(frozen=True)
class Row:
    """What was measured of both sides, one value per repetition.

    Attributes:
        name: What was measured, on what.
        unit: Of the values.
        ours: robocell's.
        peer: The peer's in the same run; empty without a peer.
        better: "lower" or "higher" values are better.
        note: Anything that a reader must know to compare.
        ratios: Ours to the peer's, of neighbouring turns, one value per repetition; empty where the
            sides take no turns that are short enough.
    """

    name: str
    unit: str
    ours: Sequence[float]
    peer: Sequence[float] = field(default_factory=list)
    better: str = "lower"
    note: str = ""
    ratios: Sequence[float] = field(default_factory=list)

    @property
    def ratio(self) -> float | None:
        """Ours to the peer's: the median of neighbouring turns, else best to best."""
        if self.ratios:
            return statistics.median(self.ratios)
        return self.best(self.ours) / self.best(self.peer) if self.peer else None

    @property
    def ratio_of(self) -> str:
        """What the ratio is of."""
        return OF_TURNS if self.ratios else "best" if self.peer else ""

    def best(self, values: Sequence[float]) -> float:
        """The value that was disturbed least."""
        return min(values) if self.better == "lower" else max(values)

    def to_json(self) -> dict[str, Any]:
        """All values."""
        return {**asdict(self), "ratio": self.ratio, "ratio of": self.ratio_of}


def markdown(rows: Sequence[Row]) -> str:
    """A Markdown table: best / median of both sides, and the ratio of the best or of turns."""
    lines = [
        "| what | unit | robocell best / median | peer best / median | ratio | note |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        cells = [
            row.name,
            row.unit,
            _pair(row, row.ours),
            _pair(row, row.peer),
            _ratio(row),
            row.note,
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _ratio(row: Row) -> str:
    if row.ratio is None:
        return ""
    return f"{row.ratio:.3f} {OF_TURNS}" if row.ratios else f"{row.ratio:.3f}"


def _pair(row: Row, values: Sequence[float]) -> str:
    if not values:
        return ""
    return f"{row.best(values):.4g} / {statistics.median(values):.4g}"
