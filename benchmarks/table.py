"""One row of the results, and the table of all."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any


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
    """

    name: str
    unit: str
    ours: Sequence[float]
    peer: Sequence[float] = field(default_factory=list)
    better: str = "lower"
    note: str = ""

    @property
    def ratio(self) -> float | None:
        """Best of ours over best of the peer's."""
        return self.best(self.ours) / self.best(self.peer) if self.peer else None

    def best(self, values: Sequence[float]) -> float:
        """The value that was disturbed least."""
        return min(values) if self.better == "lower" else max(values)

    def to_json(self) -> dict[str, Any]:
        """All values."""
        return {**asdict(self), "ratio": self.ratio}


def markdown(rows: Sequence[Row]) -> str:
    """A Markdown table: best / median of both sides, and the ratio of the best."""
    lines = [
        "| what | unit | robocell best / median | peer best / median | ratio | note |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        ratio = "" if row.ratio is None else f"{row.ratio:.3f}"
        cells = [row.name, row.unit, _pair(row, row.ours), _pair(row, row.peer), ratio, row.note]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _pair(row: Row, values: Sequence[float]) -> str:
    if not values:
        return ""
    return f"{row.best(values):.4g} / {statistics.median(values):.4g}"
