"""`robocell check`: is this robot file right, and what does the model make of it?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from robocell import ArgumentError, EngineError, SpecError
from robocell.cli.common import fail, print_warning, print_wide, require_png
from robocell.cli.robot_scene import RobotScene, load_robot
from robocell.diagnose import Severity, check_robot, validate_robot, why_no_picks


def check(
    robot_file: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", help="The robot file.")],
    picture: Annotated[
        Path | None, typer.Option(help="Draw the robot with its frames into this PNG.")
    ] = None,
) -> None:
    """Print joints, actuators, frames, reach and gripper of a robot, and try it.

    Errors in the file end with exit code 2. Warnings are valid but probably
    unintended, notes need no change. `generate` makes the same checks, and
    rejects robots that its pick tasks cannot use.
    """
    # With MuJoCo and numpy, which take longer to load than all that the other commands need.
    from robocell.cli.robot_picture import draw_robot
    from robocell.cli.robot_table import actuators_table, frames_table, joints_table, summary_lines

    if picture:
        require_png(picture)
    loaded = load_robot(robot_file, needs_arm=False)
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
    no_picks = [] if wrong else why_no_picks(loaded.robot)
    found = check_robot(loaded.robot, beside_warnings=True)
    notes = [str(finding) for finding in found if finding.severity is Severity.NOTE]
    warnings = [
        *loaded.scene.warnings,
        *(str(finding) for finding in found if finding.severity is Severity.WARNING),
    ]
    console.print()
    unfit = [f"no robot for pick tasks: {reason}" for reason in no_picks]
    for note in [*loaded.scene.notes, *notes, *unfit]:
        console.print(f"note: {note}", markup=False, highlight=False)
    for warning in warnings:
        print_warning(warning)
    if wrong:
        fail(wrong)
    if not warnings:
        print("nothing found wrong")


def _wrong(loaded: RobotScene) -> str:
    """What the file says although the model does otherwise; no run is made with that."""
    try:
        validate_robot(loaded.robot)
    except SpecError as error:
        return str(error)
    return ""
