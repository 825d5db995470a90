"""The report of a robot that `robocell check` and `robocell init` print."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from robocell import ArgumentError, EngineError, SpecError
from robocell._cli.common import fail, print_wide
from robocell._cli.robot_picture import draw_robot
from robocell._cli.robot_scene import RobotScene
from robocell._cli.robot_table import actuators_table, frames_table, joints_table, summary_lines
from robocell.diagnose import Severity, check_robot, validate_robot, why_not
from robocell.tasks import expert_kinds


def print_report(
    loaded: RobotScene, picture: Path | None, print_warning: Callable[[str], None]
) -> list[str]:
    """Prints tables, notes and warnings, and tries the robot out; returns the warnings.

    Ends the command if the file contradicts the model.

    Args:
        loaded: The robot in a separate scene.
        picture: Path for a PNG of it; none unless given.
        print_warning: Called with each warning.
    """
    try:
        loaded.scene.reset()
        summary = list(summary_lines(loaded))  # measures the grippers
    except (ArgumentError, EngineError):  # what was found before may be why
        for warning in loaded.scene.warnings:
            print_warning(warning)
        raise
    console = Console(soft_wrap=True)
    for line in summary:
        console.print(line, markup=False, highlight=False)
    for table in (joints_table(loaded), actuators_table(loaded), frames_table(loaded)):
        console.print()
        print_wide(table)
    if picture:
        draw_robot(loaded, picture)
        print(f"\npicture: {picture}")
    wrong = _wrong(loaded)
    unfit = [] if wrong else _unfit(loaded)
    found = check_robot(loaded.robot, beside_warnings=True)
    notes = [str(finding) for finding in found if finding.severity is Severity.NOTE]
    warnings = [
        *loaded.scene.warnings,
        *(str(finding) for finding in found if finding.severity is Severity.WARNING),
    ]
    console.print()
    for note in [*loaded.scene.notes, *notes, *unfit]:
        console.print(f"note: {note}", markup=False, highlight=False)
    for warning in warnings:
        print_warning(warning)
    if wrong:
        fail(wrong)
    if not warnings:
        print("no problems found")
    return warnings


def _unfit(loaded: RobotScene) -> list[str]:
    """Returns the experts that cannot use the robot, by reason."""
    reasons = {kind: why_not(loaded.robot, kind) for kind in expert_kinds()}
    experts: dict[str, list[str]] = {}
    for kind, why in reasons.items():
        for reason in why:
            experts.setdefault(reason, []).append(kind)
    # Who alone asks for another kind of base, and for nothing else, is an expert for other robots.
    others = {
        kind
        for kind, why in reasons.items()
        if len(why) == 1 and "base.kind: " in why[0] and experts[why[0]] == [kind]
    }
    all_kinds = reasons.keys() - others
    experts = {reason: kinds for reason, kinds in experts.items() if not others.issuperset(kinds)}

    def whom(kinds: list[str]) -> str:
        if len(kinds) == len(all_kinds):
            return "no expert can use"
        if len(kinds) == 1:
            return f"the expert {kinds[0]} cannot use"
        return f"the experts {', '.join(kinds[:-1])} and {kinds[-1]} cannot use"

    return [f"{whom(kinds)} this robot: {reason}" for reason, kinds in experts.items()]


def _wrong(loaded: RobotScene) -> str:
    """Returns contradictions between file and model, with which no run is made."""
    try:
        validate_robot(loaded.robot)
    except SpecError as error:
        return str(error)
    return ""
