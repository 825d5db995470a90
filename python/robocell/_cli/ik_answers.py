"""Queries of `robocell ik-test` and the evaluation of the solutions."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from robocell import Pose, Robot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Answers:
    """Errors of B answers, and the seconds each took (one mean for all in a batch).

    Attributes:
        position_error: (B,) metres.
        rotation_error: (B,) radians.
        joints: (B, n) the answers, rad or m.
        claimed: (B,) True if the solver reports a solution.
        seconds: (B,) or (1,).
    """

    joints: Array
    position_error: Array
    rotation_error: Array
    claimed: NDArray[np.bool_]
    seconds: Array

    def solved(self, tolerance: float) -> NDArray[np.bool_]:
        """(B,) claimed and true by forward kinematics."""
        near = (self.position_error <= tolerance) & (self.rotation_error <= tolerance)
        return self.claimed & near


def reachable_poses(robot: Robot, count: int, rng: np.random.Generator) -> list[Pose]:
    """Returns TCP poses in the robot base frame; unlimited joints stay within one turn."""
    limits = np.array(robot.joint_limits)
    limits = np.where(np.isfinite(limits), limits, np.clip(limits, -np.pi, np.pi))
    joints = rng.uniform(limits[:, 0], limits[:, 1], (count, len(limits)))
    return [robot.kinematics.fk(q) for q in joints]


def solve_each(robot: Robot, targets: list[Pose], tolerance: float) -> Answers:
    """Solves the poses one by one, each from the arm's present position."""
    home = robot.arm.joint_pos
    _prepare(robot)
    seconds, results = [], []
    for target in targets:
        begin = time.perf_counter()
        results.append(robot.kinematics.ik(target, seed=home, tolerance=tolerance))
        seconds.append(time.perf_counter() - begin)
    joints = np.array([result.q for result in results])
    claimed = np.array([result.success for result in results])
    return _judge(robot, targets, joints, claimed, np.array(seconds))


def solve_batch(robot: Robot, targets: list[Pose], tolerance: float) -> Answers:
    """Solves all poses in one batch, on all cores."""
    matrices = np.array([target.matrix for target in targets])
    threads = len(os.sched_getaffinity(0))
    _prepare(robot)
    begin = time.perf_counter()
    result: Any = robot.kinematics.ik_batch(matrices, tolerance=tolerance, threads=threads)
    mean = (time.perf_counter() - begin) / len(targets)
    return _judge(robot, targets, result.q, result.success, np.array([mean]))


def _prepare(robot: Robot) -> None:
    """Solves an unreachable pose, so that the chain builds its tables before timing."""
    robot.kinematics.ik(Pose(translation=[1e3, 0, 0]))


def _judge(
    robot: Robot, targets: list[Pose], joints: Array, claimed: NDArray[np.bool_], seconds: Array
) -> Answers:
    """Computes the errors by forward kinematics, independent of the solver's result."""
    errors = [
        pose_error(robot.kinematics.fk(q).matrix, target.matrix)
        for q, target in zip(joints, targets, strict=True)
    ]
    position, rotation = np.array(errors).T
    return Answers(joints, position, rotation, claimed, seconds)


def pose_error(X_WA: Array, X_WB: Array) -> tuple[float, float]:
    """Returns distance in metres and angle in radians between two poses (4, 4)."""
    position = float(np.linalg.norm(X_WA[:3, 3] - X_WB[:3, 3]))
    R_AB = X_WA[:3, :3].T @ X_WB[:3, :3]
    # By the sine: the cosine loses small angles.
    skew = np.array([R_AB[2, 1] - R_AB[1, 2], R_AB[0, 2] - R_AB[2, 0], R_AB[1, 0] - R_AB[0, 1]])
    angle = np.arctan2(float(np.linalg.norm(skew)), float(np.trace(R_AB)) - 1)
    return position, float(angle)


def answers_table(robot: Robot, answers: Answers, tolerance: float) -> Table:
    """Returns a table of success rate, largest errors and times."""
    solved = answers.solved(tolerance)
    micro = 1e6 * answers.seconds
    table = Table(title=f"IK of '{robot.name}'", show_header=False, box=None, title_justify="left")
    table.add_row("solved", f"{100 * solved.mean():.2f} % of {len(solved)} at {tolerance:g} m, rad")
    if solved.any():
        worst = answers.position_error[solved].max(), answers.rotation_error[solved].max()
        table.add_row("largest error", f"{worst[0]:.1e} m, {worst[1]:.1e} rad")
    if len(micro) == 1:
        table.add_row("time", f"{micro[0]:.1f} us a pose in one batch")
    else:
        median, late = np.percentile(micro, [50, 99])
        table.add_row("time", f"mean {micro.mean():.0f}, median {median:.0f}, p99 {late:.0f} us")
    return table
