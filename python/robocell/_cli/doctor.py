"""`robocell doctor`: checks what robocell can use on this machine."""

from __future__ import annotations

import typer
from rich.table import Table
from rich.text import Text

from robocell._cli.common import ExitCode, print_wide
from robocell._cli.probes import PROBES, PURPOSES, Finding, State

STYLES = {
    State.OK: "green",
    State.SLOW: "yellow",
    State.MISSING: "yellow",
    State.KNOWN: "yellow",
    State.BROKEN: "bold red",
}


def doctor() -> None:
    """Check versions, graphics, encoder, robot models, KDL and disk.

    Exit code 1 if a needed part is broken.
    """
    findings = [finding for probe in PROBES for finding in probe()]
    print_wide(_table(findings))
    for line in advice(findings):
        print(line)
    if any(finding.state is State.BROKEN for finding in findings):
        raise typer.Exit(ExitCode.INCOMPLETE)


def advice(findings: list[Finding]) -> list[str]:
    """Returns the advice: fixes, optional installs with their commands, and the verdict."""
    broken = [finding for finding in findings if finding.state is State.BROKEN]
    slow = [finding for finding in findings if finding.state is State.SLOW]
    missing = [finding for finding in findings if finding.state is State.MISSING]
    lines = [""]
    for finding in broken:
        lines.append(f"{finding.what} is broken: {finding.remedy}")
    for finding in slow:
        lines.append(f"{finding.what} is slow: {finding.remedy}")
    for finding in missing:
        purpose = PURPOSES.get(finding.what)
        what = f"{finding.what} ({purpose})" if purpose else finding.what
        remedy = finding.remedy or "nothing to do"
        lines.append(f"{what} is optional: {remedy}")
    lines.append(
        "parts of robocell will not work until this is fixed"
        if broken
        else "this machine can generate datasets"
    )
    return lines


def _table(findings: list[Finding]) -> Table:
    table = Table(box=None, show_header=False)
    for finding in findings:
        state = Text(finding.state.value, style=STYLES[finding.state])
        table.add_row(state, finding.what, Text(finding.detail))
    return table
