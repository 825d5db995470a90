"""The table at the end of a run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.box import SIMPLE
from rich.table import Table
from rich.text import Text

from robocell._generation.items import STAGES, counts_text
from robocell._generation.totals import Totals, duration, percent, time_hint
from robocell._suggestions import counted


@dataclass(frozen=True)
class Summary:
    """Content of the final table.

    Attributes:
        run: The run's name.
        dataset: Folder of the dataset.
        on_disk: Episodes of the plan, counted on the disk.
        totals: Counts of this command.
        more: Further rows.
        reports: Number of reports that `totals` sums: one for the run, or one for each shard.
        unreported: Shards without a report, such as '1/4'; nobody knows what they planned.
    """

    run: str
    dataset: Path
    on_disk: int
    totals: Totals
    more: Mapping[str, str] = field(default_factory=dict)
    reports: int = 1
    unreported: Sequence[str] = ()

    def rows(self) -> dict[str, str]:
        """Returns label -> text, in order."""
        totals = self.totals
        rows = {
            "episodes": self._episodes() if totals.planned else "",
            **self._tried(),
            "refusals": counts_text(totals.refusals),
            "placements rejected": counts_text(totals.redrawn),
            "failures": counts_text(totals.failures),
            "hint": time_hint(totals.failures) or (totals.advice if totals.unmade else ""),
            "dropped": _dropped(totals),
            "workers lost": _lost(totals),
            "made again": str(totals.retries) if totals.retries else "",
            "given up": ", ".join(unmade.id for unmade in totals.unmade),
            "time": stages_text(totals.seconds),
            **self.more,
            "dataset": str(self.dataset.absolute()),
        }
        return {label: text for label, text in rows.items() if text}

    def _episodes(self) -> str:
        """Returns '16 of 20', or '16 (the last command requested 14)' if earlier ones made more.

        Without the report of a shard it is '16 on the disk (no report of shard 1/2; the others
        requested 10)': the number of episodes of the whole run is unknown.
        """
        totals = self.totals
        if self.unreported:
            shards = f"shard{'s' if len(self.unreported) > 1 else ''} {', '.join(self.unreported)}"
            return (
                f"{self.on_disk} on the disk (no report of {shards}; the others requested "
                f"{totals.planned})"
            )
        if self.on_disk > totals.planned:
            last = "last command" if self.reports == 1 else "last commands of the shards"
            return f"{self.on_disk} (the {last} requested {totals.planned})"
        before = f" ({totals.already} made before)" if totals.already else ""
        return f"{self.on_disk} of {totals.planned}{before}"

    def _tried(self) -> dict[str, str]:
        """Returns the rows about attempts; none if all episodes existed before."""
        totals = self.totals
        if not totals.attempts:
            return {}
        return {
            "success": f"{percent(totals.success_rate)} of {counted(totals.accepted, 'rollout')}",
            "success by object": _by_kind(totals),
            "starts accepted": f"{percent(totals.acceptance_rate)} of {totals.attempts} sampled",
            "placements": f"{percent(totals.placement_rate)} of {totals.tried} accepted",
            "rate": f"{totals.per_hour:.0f} episodes/h: {totals.made} in "
            f"{duration(totals.elapsed_s)} on {counted(totals.workers, 'worker')}",
        }

    def table(self) -> Table:
        """Returns a table for a rich console."""
        table = Table(title=self.run, box=SIMPLE, show_header=False, title_justify="left")
        table.add_column(style="bold", no_wrap=True)
        table.add_column(overflow="fold")
        for label, text in self.rows().items():
            table.add_row(label, Text(text))
        return table


def _by_kind(totals: Totals) -> str:
    """Returns 'box 50 % of 4, mug 90 % of 10', rollouts; "" for objects of one kind."""
    if len(totals.kinds) < 2:
        return ""
    shares = ((kind, totals.rollouts[kind], totals.made_of[kind]) for kind in sorted(totals.kinds))
    return ", ".join(
        f"{kind} {percent(made / rollouts if rollouts else None)} of {rollouts}"
        for kind, rollouts, made in shares
    )


def _dropped(totals: Totals) -> str:
    """Describes attempts that the end of the run left undecided."""
    if not totals.undecided:
        return ""
    attempts = counted(totals.undecided, "attempt")
    return f"{attempts} interrupted by the end of the run; repeated by the next command"


def _lost(totals: Totals) -> str:
    """Returns '2 killed by SIGSEGV (tasks.py:12, in judge), 1 ended with exit code 3'."""
    reasons = Counter(death.reason.removeprefix("was ") for death in totals.deaths)
    return ", ".join(f"{number} {reason}" for reason, number in reasons.items())


def stages_text(seconds: Mapping[str, float]) -> str:
    """Returns 'acting 41 s (62 %), rendering 20 s (30 %)', the stages in order; "" without any."""
    total = sum(seconds.values())
    if total <= 0:
        return ""
    return ", ".join(
        f"{stage} {seconds.get(stage, 0):.1f} s ({percent(seconds.get(stage, 0) / total)})"
        for stage in STAGES
    )
