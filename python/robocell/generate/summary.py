"""The table at the end of a run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rich.box import SIMPLE
from rich.table import Table
from rich.text import Text

from robocell.generate.items import STAGES, counts_text
from robocell.generate.totals import Totals, counted, duration, percent, time_hint


@dataclass(frozen=True)
class Summary:
    """What the table is made from.

    Attributes:
        run: The run's name.
        dataset: Folder.
        on_disk: Episodes of the plan that are on the disk, counted there.
        totals: What this command did.
        more: Further rows.
    """

    run: str
    dataset: Path
    on_disk: int
    totals: Totals
    more: Mapping[str, str] = field(default_factory=dict)

    def rows(self) -> dict[str, str]:
        """Label -> text, in order."""
        totals = self.totals
        rows = {
            "episodes": self._episodes() if totals.planned else "",
            **self._tried(),
            "refusals": counts_text(totals.refusals),
            "placed again": counts_text(totals.redrawn),
            "failures": counts_text(totals.failures),
            "hint": time_hint(totals.failures) or (totals.advice if totals.unmade else ""),
            "dropped": _dropped(totals),
            "workers died": counts_text(Counter(death.reason for death in totals.deaths)),
            "made again": str(totals.retries) if totals.retries else "",
            "given up": ", ".join(unmade.id for unmade in totals.unmade),
            "time": stages_text(totals.seconds),
            **self.more,
            "dataset": str(self.dataset.absolute()),
        }
        return {label: text for label, text in rows.items() if text}

    def _episodes(self) -> str:
        """'16 of 20'; when earlier commands asked for more '16, the last command asked for 14'."""
        totals = self.totals
        if self.on_disk > totals.planned:
            return f"{self.on_disk}, the last command asked for {totals.planned}"
        before = f" ({totals.already} made before)" if totals.already else ""
        return f"{self.on_disk} of {totals.planned}{before}"

    def _tried(self) -> dict[str, str]:
        """Nothing when all was there before."""
        totals = self.totals
        if not totals.attempts:
            return {}
        return {
            "success": f"{percent(totals.success_rate)} of {counted(totals.accepted, 'rollout')}",
            "success by object": _by_kind(totals),
            "starts accepted": f"{percent(totals.acceptance_rate)} of {totals.attempts} sampled",
            "places accepted": f"{percent(totals.placement_rate)} of {totals.tried} tried",
            "rate": f"{totals.per_hour:.0f} episodes/h: {totals.made} in "
            f"{duration(totals.elapsed_s)} on {counted(totals.workers, 'worker')}",
        }

    def table(self) -> Table:
        """For a rich console."""
        table = Table(title=self.run, box=SIMPLE, show_header=False, title_justify="left")
        table.add_column(style="bold", no_wrap=True)
        table.add_column(overflow="fold")
        for label, text in self.rows().items():
            table.add_row(label, Text(text))
        return table


def _by_kind(totals: Totals) -> str:
    """'box 50 % of 4, mug 90 % of 10', rollouts; nothing for objects of one kind."""
    if len(totals.kinds) < 2:
        return ""
    shares = ((kind, totals.rollouts[kind], totals.made_of[kind]) for kind in sorted(totals.kinds))
    return ", ".join(
        f"{kind} {percent(made / rollouts if rollouts else None)} of {rollouts}"
        for kind, rollouts, made in shares
    )


def _dropped(totals: Totals) -> str:
    """What the end of a run, by a stop request or a failure, left undecided."""
    if not totals.undecided:
        return ""
    attempts = counted(totals.undecided, "attempt")
    return f"{attempts} under way when the run stopped; made again by the next command"


def stages_text(seconds: Mapping[str, float]) -> str:
    """'acting 41 s (62 %), rendering 20 s (30 %)', the stages in order; empty without any."""
    total = sum(seconds.values())
    if total <= 0:
        return ""
    return ", ".join(
        f"{stage} {seconds.get(stage, 0):.1f} s ({percent(seconds.get(stage, 0) / total)})"
        for stage in STAGES
    )
