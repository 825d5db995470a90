"""`robocell check`: checks a robot file, prints the robot, and tests it in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell._cli.common import print_warning, require_png
from robocell._cli.robot_scene import load_robot


def check(
    robot_file: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", help="The robot file.")],
    picture: Annotated[
        Path | None, typer.Option(help="Draw the robot with its frames into this PNG.")
    ] = None,
    view: Annotated[
        bool, typer.Option("--view", help="Show the robot in a window afterwards.")
    ] = False,
) -> None:
    """Check a robot file: print its joints, frames and reach, and test it in simulation.

    Errors in the file end with exit code 2. Warnings are valid but probably
    unintended, notes need no change. `generate` makes the same checks, and
    rejects robots that its pick tasks cannot use.
    """
    # With MuJoCo and numpy, which take longer to load than all that the other commands need.
    from robocell._cli.robot_report import print_report

    if picture:
        require_png(picture)
    loaded = load_robot(robot_file, needs_arm=False)
    print_report(loaded, picture, print_warning)
    if view:
        from robocell._cli.view import show

        loaded.scene.reset()
        show(loaded.scene, loaded.config.name)
