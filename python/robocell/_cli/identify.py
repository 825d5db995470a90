"""`robocell identify`: fits a robot's model to a recorded motion. See docs/identify.md."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robocell._cli.common import print_wide
from robocell._cli.robot_scene import load_robot

if TYPE_CHECKING:
    from rich.table import Table

    from robocell.identify import Identified


def identify(
    robot_file: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", help="The robot file.")],
    trajectory_file: Annotated[
        Path,
        typer.Argument(
            metavar="TRAJECTORY",
            help="A .npz with time, command and measured, or an episode: DATASET/EPISODE.",
        ),
    ],
    fit: Annotated[
        list[str] | None,
        typer.Option(
            "--fit", metavar="NAME", help="Fit only these; repeat it. Default: all of them."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="NAME", help="Write NAME.json and NAME.html."),
    ] = None,
) -> None:
    """Fit joint damping, friction loss, armature, gains and delay to a recorded motion.

    The arm is simulated with the motion's commands, and what it does differently
    from what was measured is made small by least squares. Prints each value
    with its 95 % interval, and the edits for the robot file.
    """
    from robocell.identify import PARAMETERS, ArmTrajectory
    from robocell.identify import identify as run

    robot = load_robot(robot_file).robot
    found = run(robot, ArmTrajectory.load(trajectory_file, robot), fit or PARAMETERS)
    print_wide(_table(found))
    print(
        f"residuals: {found.rms_before:.3g} with the model's values, {found.rms:.3g} fitted (RMS)"
    )
    print(found.edits(), end="")
    if output:
        from robocell._identify.page import write_page

        found.save(output.with_name(output.name + ".json"))
        write_page(found, output.with_name(output.name + ".html"))


def _table(found: Identified) -> Table:
    from rich.table import Table

    table = Table("value", "joint", "model", "fitted", "95 %", "unit")
    for each in found.parameters:
        error = f"± {each.error:.2g}" if each.is_shown else "not shown by the motion"
        table.add_row(
            each.name, each.joint, f"{each.before:.4g}", f"{each.value:.4g}", error, each.unit
        )
    return table
