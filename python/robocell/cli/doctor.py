"""`robocell doctor`: what of this machine robocell can use."""

from __future__ import annotations

import typer
from rich.table import Table
from rich.text import Text

from robocell.cli.common import ExitCode, print_wide
from robocell.cli.probes import PROBES, Finding, State

STYLES = {State.OK: "green", State.MISSING: "yellow", State.BROKEN: "bold red"}


def doctor() -> None:
    """Look at versions, graphics, encoder, robot models, KDL and disk. Exit code 1 when broken."""
    findings = [finding for probe in PROBES for finding in probe()]
    print_wide(_table(findings))
    for finding in findings:
        if finding.state is not State.OK and finding.remedy:
            print(f"{finding.what}: {finding.remedy}")
    if any(finding.state is State.BROKEN for finding in findings):
        raise typer.Exit(ExitCode.INCOMPLETE)


def _table(findings: list[Finding]) -> Table:
    table = Table(box=None, show_header=False)
    for finding in findings:
        state = Text(finding.state.value, style=STYLES[finding.state])
        table.add_row(state, finding.what, Text(finding.detail))
    return table
