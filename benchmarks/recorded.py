"""Reads sections of RESULTS.md back: under which circumstances, and the rows of the table."""

from __future__ import annotations

import re
from dataclasses import dataclass

from table import OF_TURNS


@dataclass(frozen=True)
class Recorded:
    """A row of a table as it was written.

    Attributes:
        name: What was measured, on what.
        unit: Of the values.
        ours: robocell's best.
        peer: The peer's best; None without a peer.
        note: Peer and what else a reader must know.
        ratio_of_turns: Ours to the peer's where that is not best to best.
    """

    name: str
    unit: str
    ours: float
    peer: float | None
    note: str
    ratio_of_turns: float | None = None

    @property
    def ratio(self) -> float | None:
        """Ours to the peer's."""
        if self.ratio_of_turns is not None or self.peer is None:
            return self.ratio_of_turns
        return self.ours / self.peer

    @property
    def speed(self) -> float | None:
        """How many times as fast as the peer."""
        if self.ratio is None:
            return None
        return self.ratio if self.unit.startswith("1/") else 1 / self.ratio

    def has_peer(self, name: str) -> bool:
        """Whether the peer is called this, or this and more after a comma or semicolon."""
        return re.search(rf"peer: {re.escape(name)}(?=[,;: ]|$)", self.note) is not None


def rows(section: str) -> list[Recorded]:
    """The rows of a section; not its head."""
    found = []
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and len(cells) == 6 and cells[0] not in ("what", "---"):
            name, unit, ours, peer, ratio, note = cells
            bests = _best(ours), _best(peer) if peer else None
            found.append(Recorded(name, unit, *bests, note, _of_turns(ratio)))
    return found


def circumstance(section: str, what: str) -> str | None:
    """What a section says after "- what:"; None where it says nothing of it."""
    line = re.search(rf"^- {re.escape(what)}: (.+)$", section, re.MULTILINE)
    return line[1].strip() if line else None


def _best(cell: str) -> float:
    return float(cell.split("/")[0])


def _of_turns(cell: str) -> float | None:
    ratio, _, of = cell.partition(" ")
    return float(ratio) if of == OF_TURNS else None
