"""One side of the inverse kinematics rows: ik_side.py SIDE QUESTIONS.npz ANSWERS.npz.

Runs in the environment of the side's own package (ik.py makes it). Questions: targets (B, 4, 4) of
the tip in the base frame, seeds (B, n), limits (n, 2), `urdf` and `robot` (files). Answers: q
(B, n), NaN where the side found nothing, and the seconds of each call.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Questions = Mapping[str, Any]
Solve = Callable[[int], Array | None]

# Norms, in metres and radians.
TOLERANCE = 1e-5


def one_by_one(questions: Questions, solve: Solve) -> tuple[Array, Array]:
    """Answers and seconds of one call per target."""
    answers = np.full_like(questions["seeds"], np.nan)
    seconds = np.empty(len(answers))
    for b in range(len(answers)):
        begin = time.perf_counter()
        q = solve(b)
        seconds[b] = time.perf_counter() - begin
        if q is not None:
            answers[b] = q
    return answers, seconds


def robocell_kinematics(questions: Questions) -> Any:
    """The robot's, from its file."""
    from robocell.cli.robot_scene import load_robot

    return load_robot(Path(str(questions["robot"]))).robot.kinematics


def robocell_batch(questions: Questions) -> tuple[Array, Array]:
    """All targets in one call, no seeds."""
    kinematics = robocell_kinematics(questions)
    targets = questions["targets"]
    kinematics.ik_batch(targets[:1])  # makes what a chain keeps
    begin = time.perf_counter()
    found = kinematics.ik_batch(targets, tolerance=TOLERANCE)
    seconds = (time.perf_counter() - begin) / len(targets)
    answers = np.where(found.success[:, None], found.q, np.nan)
    return answers, np.array([seconds])


def robocell_one(questions: Questions) -> tuple[Array, Array]:
    """One call per target, from the seed."""
    import robocell

    kinematics = robocell_kinematics(questions)
    targets = [robocell.Pose(target) for target in questions["targets"]]
    seeds = questions["seeds"]

    def solve(b: int) -> Array | None:
        found = kinematics.ik(targets[b], seed=seeds[b], tolerance=TOLERANCE)
        return np.asarray(found.q) if found.success else None

    return one_by_one(questions, solve)


def kdl_lma(questions: Questions) -> tuple[Array, Array]:
    """KDL's Levenberg-Marquardt solver, one try; what it ends with is judged, whatever it says.

    It weighs rotations with 0.01, so its tolerance is a hundred times tighter.
    """
    import PyKDL

    chain = robocell_kdl_chain(questions)
    solver = PyKDL.ChainIkSolverPos_LMA(chain, TOLERANCE / 100)
    frames = [kdl_frame(target) for target in questions["targets"]]
    seeds = [kdl_joints(seed) for seed in questions["seeds"]]
    out = PyKDL.JntArray(chain.getNrOfJoints())

    def solve(b: int) -> Array | None:
        solver.CartToJnt(seeds[b], frames[b], out)
        return np.array([out[i] for i in range(out.rows())])

    return one_by_one(questions, solve)


def robocell_kdl_chain(questions: Questions) -> Any:
    """The arm as PyKDL.Chain."""
    from robocell.cli.robot_scene import load_robot

    return load_robot(Path(str(questions["robot"]))).robot.kdl_chain()


def kdl_frame(matrix: Array) -> Any:
    """A 4x4 matrix as PyKDL.Frame."""
    import PyKDL

    return PyKDL.Frame(PyKDL.Rotation(*matrix[:3, :3].ravel()), PyKDL.Vector(*matrix[:3, 3]))


def kdl_joints(values: Array) -> Any:
    """Joint values as PyKDL.JntArray."""
    import PyKDL

    joints = PyKDL.JntArray(len(values))
    for i, value in enumerate(values):
        joints[i] = value
    return joints


def trac_ik(questions: Questions) -> tuple[Array, Array]:
    """TRAC-IK, its published protocol: Speed, 5 ms, bounds of 1e-5 per axis."""
    from trac_ik import TracIK

    solver = TracIK(
        "base", "tip", str(questions["urdf"]), timeout=0.005, epsilon=TOLERANCE, solver_type="Speed"
    )
    targets, seeds = questions["targets"], questions["seeds"]
    rotations = [np.ascontiguousarray(target[:3, :3]) for target in targets]
    positions = [target[:3, 3].copy() for target in targets]
    return one_by_one(questions, lambda b: solver.ik(positions[b], rotations[b], seeds[b]))


def roboplan(questions: Questions) -> tuple[Array, Array]:
    """Roboplan's SimpleIk with the options that solve the most: full steps, many restarts."""
    import roboplan.core as core
    import roboplan.simple_ik as simple_ik

    scene = core.Scene("arm", core.loadUrdfSceneDescription(str(questions["urdf"])))
    scene.addGroupFromChain("arm", "base", "tip")
    names = scene.getJointNames()
    solver = simple_ik.SimpleIk(
        scene,
        simple_ik.SimpleIkOptions(
            group_name="arm",
            check_collisions=False,
            max_linear_error_norm=TOLERANCE,
            max_angular_error_norm=TOLERANCE,
            step_size=1.0,
            max_iters=25,
            max_restarts=200,
            max_time=0.05,
            damping=1e-5,
        ),
    )
    solver.setRngSeed(1)
    goals = [
        core.CartesianConfiguration("base", "tip", np.asfortranarray(target))
        for target in questions["targets"]
    ]
    starts = [core.JointConfiguration(names, seed) for seed in questions["seeds"]]

    def solve(b: int) -> Array | None:
        found = core.JointConfiguration()
        return found.positions if solver.solveIk(goals[b], starts[b], found) else None

    return one_by_one(questions, solve)


SIDES: dict[str, Callable[[Questions], tuple[Array, Array]]] = {
    "robocell batch": robocell_batch,
    "robocell": robocell_one,
    "KDL": kdl_lma,
    "TRAC-IK": trac_ik,
    "roboplan": roboplan,
}

if __name__ == "__main__":
    side, questions_file, answers_file = sys.argv[1:]
    with np.load(questions_file) as file:
        answers, seconds = SIDES[side]({name: file[name] for name in file.files})
    np.savez(answers_file, q=answers, seconds=seconds)
