"""`robocell ik-test`: inverse kinematics on random poses that the robot can reach."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import Pose
from robocell._cli.common import ExitCode, print_wide
from robocell._cli.robot_scene import RobotScene, load_robot

# The share that any sensible arm reaches; below it the command fails.
EXPECTED_SHARE = 0.99
# Of --view: how long each solution is shown, and how long the axes of its pose are.
SECONDS_PER_POSE = 1.0
AXIS_M = 0.1


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
        bool, typer.Option("--view", help="Show the poses and their solutions in a window.")
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
        _show(loaded, targets, tolerance)
    if share < EXPECTED_SHARE:
        raise typer.Exit(ExitCode.INCOMPLETE)


def _show(loaded: RobotScene, targets: list[Pose], tolerance: float) -> None:
    """Moves the arm from solution to solution, each with its target's axes, in a window."""
    from robocell.viewer import Viewer

    robot, scene = loaded.robot, loaded.scene
    with Viewer.open(robot, f"ik-test: {loaded.config.name}") as viewer:
        viewer.show_frame("tcp", robot.name)
        steps = max(1, round(SECONDS_PER_POSE / scene.timestep()))
        for target in targets:
            result = robot.kinematics.ik(target, seed=robot.arm.joint_pos, tolerance=tolerance)
            viewer.clear_trace()
            pose = robot.base_in_world * target
            for axis in range(3):
                tip = pose.translation + AXIS_M * pose.rotation[:, axis]
                colour = [0.0, 0.0, 0.0, 1.0]
                colour[axis] = 1.0
                viewer.add_trace_segment(pose.translation, tip, colour)
            if result.success:
                robot.set_joint_pos(result.q)
            for _ in range(steps):
                robot.update()
                if not viewer.step():
                    return
