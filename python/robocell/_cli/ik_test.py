"""`robocell ik-test`: inverse kinematics on random poses that the robot can reach."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell._cli.common import ExitCode, print_wide
from robocell._cli.robot_scene import load_robot

# The share that any sensible arm reaches; below it the command fails.
EXPECTED_SHARE = 0.99


def ik_test(
    robot_file: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", help="The robot file.")],
    samples: Annotated[int, typer.Option(min=1, help="Number of poses.")] = 1000,
    parallel: Annotated[
        bool, typer.Option("--parallel", help="All poses in one batch, on all cores.")
    ] = False,
    tolerance: Annotated[
        float, typer.Option(min=1e-12, help="Largest error of a solution: norms, m and rad.")
    ] = 1e-5,
    seed: Annotated[int, typer.Option(help="Seed of the random poses.")] = 0,
    view: Annotated[
        bool,
        typer.Option(
            "--view", help="Show the poses and their answers in a window; N and P go on and back."
        ),
    ] = False,
) -> None:
    """Solve inverse kinematics for random reachable poses; print success, errors and times.

    Each pose is that of random joint positions within the limits. Forward
    kinematics judges the answers. Exit code 1 if less than 99 % are solved.
    """
    # With numpy, which takes longer to load than all that the other commands need.
    import numpy as np

    from robocell._cli.ik_answers import answers_table, reachable_poses, solve_batch, solve_each

    loaded = load_robot(robot_file)
    robot = loaded.robot
    targets = reachable_poses(robot, samples, np.random.default_rng(seed))
    solve = solve_batch if parallel else solve_each
    answers = solve(robot, targets, tolerance)
    share = float(np.mean(answers.solved(tolerance)))
    print_wide(answers_table(robot, answers, tolerance))
    if view:
        from robocell._cli.ik_window import show_answers

        show_answers(loaded, targets, answers, tolerance)
    if share < EXPECTED_SHARE:
        raise typer.Exit(ExitCode.INCOMPLETE)
