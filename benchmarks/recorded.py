"""Reads sections of RESULTS.md back: under which circumstances, and the rows of the table."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Recorded:
    """A row of a table as it was written.

    Attributes:
        name: What was measured, on what.
        unit: Of the values.
        ours: robocell's best.
        peer: The peer's best; None without a peer.
        note: Peer and what else a reader must know.
    """

    name: str
    unit: str
    ours: float
    peer: float | None
    note: str

    @property
    def speed(self) -> float | None:
        """How many times as fast as the peer."""
        if self.peer is None:
            return None
        return self.ours / self.peer if self.unit.startswith("1/") else self.peer / self.ours

    def has_peer(self, name: str) -> bool:
        """Whether the peer is called this, or this and more after a comma or semicolon."""
        return re.search(rf"peer: {re.escape(name)}(?=[,;: ]|$)", self.note) is not None


def rows(section: str) -> list[Recorded]:
    """The rows of a section; not its head."""
    found = []
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and len(cells) == 6 and cells[0] not in ("what", "---"):
            name, unit, ours, peer, _, note = cells
            found.append(Recorded(name, unit, _best(ours), _best(peer) if peer else None, note))
    return found


def circumstance(section: str, what: str) -> str | None:
    """What a section says after "- what:"; None where it says nothing of it."""
    line = re.search(rf"^- {re.escape(what)}: (.+)$", section, re.MULTILINE)
    return line[1].strip() if line else None


def _best(cell: str) -> float:
    return float(cell.split("/")[0])
