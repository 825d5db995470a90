"""Peers of the inverse kinematics rows that come from PyPI; each runs in an environment of its own.

A side takes the questions of ik_side.py and takes its turns; None when it cannot solve this arm.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ik_side import TOLERANCE, Answers, one_by_one

Array = NDArray[np.float64]
Questions = Mapping[str, Any]

# With these, solvers that only take steps solve most targets soonest (tried on Panda, Gen3).
RESTARTS, STEPS = 25, 30
LOCKED = 32  # values at which EAIK's seventh joint is held in turn


class Starts:
    """Where a search begins: at the seed, then anywhere in the limits."""

    def __init__(self, questions: Questions) -> None:
        """Begins with the seeds and limits of the queries."""
        self._seeds = questions["seeds"]
        self._low, self._high = questions["limits"].T
        self.begin_pass()

    def begin_pass(self) -> None:
        """The same again."""
        self._rng = np.random.default_rng(0)

    def of(self, b: int) -> Iterator[Array]:
        """For a target."""
        yield self._seeds[b].copy()
        for _ in range(RESTARTS):
            yield self._rng.uniform(self._low, self._high)


def trac_ik(questions: Questions) -> Answers:
    """TRAC-IK, its published protocol: Speed, 5 ms.

    Its tolerance is one of each axis.
    """
    from trac_ik import TracIK

    solver = TracIK(
        "base",
        "tip",
        str(questions["urdf"]),
        timeout=0.005,
        epsilon=float(TOLERANCE / np.sqrt(3)),
        solver_type="Speed",
    )
    targets, seeds = questions["targets"], list(questions["seeds"])
    rotations = [np.ascontiguousarray(target[:3, :3]) for target in targets]
    positions = [target[:3, 3].copy() for target in targets]
    return one_by_one(questions, lambda b: solver.ik(positions[b], rotations[b], seeds[b]))


def roboplan(questions: Questions) -> Answers:
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
    goals = [
        core.CartesianConfiguration("base", "tip", np.asfortranarray(target))
        for target in questions["targets"]
    ]
    seeds = [core.JointConfiguration(names, seed) for seed in questions["seeds"]]

    def solve(b: int) -> Array | None:
        found = core.JointConfiguration()
        return found.positions if solver.solveIk(goals[b], seeds[b], found) else None

    return one_by_one(questions, solve, begin_pass=lambda: solver.setRngSeed(1))


def eaik(questions: Questions) -> Answers | None:
    """EAIK, all solutions in closed form: the first in the limits.

    Of a seventh joint it knows nothing: it is held at 32 values in turn, those in the middle of
    its range first.
    """
    from eaik.IK_URDF import UrdfRobot

    low, high = questions["limits"].T
    middle = (low + high) / 2
    held: Array = np.array([0.0])
    if len(low) == 7:
        held = np.linspace(low[6], high[6], LOCKED, endpoint=False) + (high[6] - low[6]) / 64
        held = held[np.argsort(np.abs(held - middle[6]))]
    elif len(low) != 6:
        return None

    def robot(value: float) -> Any:
        return UrdfRobot(str(questions["urdf"]), [(6, value)] if len(low) == 7 else [])

    robots = [robot(float(value)) for value in held]
    if not robots[0].hasKnownDecomposition():
        return None
    # Its tip is the last joint's frame: found from one known configuration.
    known = questions["example"]
    calibrated = robot(float(known[6])) if len(low) == 7 else robots[0]
    offset = np.linalg.inv(questions["targets"][0]) @ calibrated.fwdKin(known)
    goals = [np.ascontiguousarray(target @ offset) for target in questions["targets"]]

    def solve(b: int) -> Array | None:
        for each in robots:
            found = each.IK(goals[b])
            rows = np.asarray(found.Q)
            if len(rows) == 0:
                continue
            rows = middle + (rows - middle + np.pi) % (2 * np.pi) - np.pi
            good = ((rows >= low) & (rows <= high)).all(axis=1) & ~np.asarray(found.is_LS, bool)
            if good.any():
                return np.asarray(rows[np.argmax(good)])
        return None

    return one_by_one(questions, solve)


def mink(questions: Questions) -> Answers:
    """Mink with daqp: full steps within the limits, 25 restarts of 30 steps."""
    import mink
    import mujoco

    spec = mujoco.MjSpec.from_file(str(questions["urdf"]))
    spec.compiler.fusestatic = False  # the tip is a link of its own
    for body in spec.bodies[1:]:
        body.mass, body.inertia, body.explicitinertial = 1, [1, 1, 1], True
    model = spec.compile()
    now = mink.Configuration(model)
    task = mink.FrameTask("tip", "body", position_cost=1, orientation_cost=1, lm_damping=1e-3)
    bounds = [mink.ConfigurationLimit(model)]
    goals = [mink.SE3.from_matrix(target) for target in questions["targets"]]
    starts = Starts(questions)

    def solve(b: int) -> Array | None:
        task.set_target(goals[b])
        for start in starts.of(b):
            now.update(start)
            for _ in range(STEPS):
                error = task.compute_error(now)
                if max(np.linalg.norm(error[:3]), np.linalg.norm(error[3:])) <= TOLERANCE:
                    return np.array(now.q)
                speed = mink.solve_ik(now, [task], 1.0, "daqp", damping=1e-9, limits=bounds)
                now.integrate_inplace(speed, 1.0)
        return None

    return one_by_one(questions, solve, begin_pass=starts.begin_pass)


def placo(questions: Questions) -> Answers:
    """Placo's kinematics solver: 25 restarts of 30 steps within the limits."""
    import placo

    robot = placo.RobotWrapper(str(questions["urdf"]), placo.Flags.ignore_collisions)
    solver = placo.KinematicsSolver(robot)
    solver.mask_fbase(True)
    solver.enable_joint_limits(True)
    solver.enable_velocity_limits(False)
    task = solver.add_frame_task("tip", questions["targets"][0])
    task.configure("tip", "soft", 1.0, 1.0)
    solver.add_regularization_task(1e-9)
    base = robot.state.q.copy()  # position and quaternion come first
    starts = Starts(questions)

    def arrived(target: Array) -> bool:
        tip = robot.get_T_world_frame("tip")
        turn = target[:3, :3].T @ tip[:3, :3]
        sine = 0.5 * np.array(
            [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
        way = tip[:3, 3] - target[:3, 3]
        return bool(max(way @ way, sine @ sine) <= TOLERANCE**2 and np.trace(turn) > 1)

    def solve(b: int) -> Array | None:
        target = questions["targets"][b]
        task.T_world_frame = target
        for start in starts.of(b):
            robot.state.q = np.r_[base[:7], start]
            robot.update_kinematics()
            for _ in range(STEPS):
                if arrived(target):
                    return np.array(robot.state.q[7:])
                try:
                    solver.solve(True)
                except RuntimeError:  # no solution of its quadratic program
                    break
                robot.update_kinematics()
        return None

    return one_by_one(questions, solve, begin_pass=starts.begin_pass)


def pinocchio(questions: Questions) -> Answers:
    """Damped least squares on Pinocchio, as its examples have it, clipped: 25 restarts."""
    import pinocchio as pin

    model = pin.buildModelFromUrdf(str(questions["urdf"]))
    data, tip = model.createData(), model.getFrameId("tip")
    goals = [pin.SE3(target) for target in questions["targets"]]
    low, high = questions["limits"].T
    damping = 1e-4 * np.eye(6)
    starts = Starts(questions)

    def solve(b: int) -> Array | None:
        for q in starts.of(b):
            for _ in range(STEPS + 10):
                pin.forwardKinematics(model, data, q)
                left = pin.updateFramePlacement(model, data, tip).actInv(goals[b])
                error = pin.log(left).vector
                if max(np.linalg.norm(error[:3]), np.linalg.norm(error[3:])) <= TOLERANCE:
                    return q
                columns = -pin.Jlog6(left.inverse()) @ pin.computeFrameJacobian(model, data, q, tip)
                step = columns.T @ np.linalg.solve(columns @ columns.T + damping, error)
                q = np.clip(q - step, low, high)
        return None

    return one_by_one(questions, solve, begin_pass=starts.begin_pass)


PEERS: dict[str, Callable[[Questions], Answers | None]] = {
    "TRAC-IK": trac_ik,
    "roboplan": roboplan,
    "EAIK": eaik,
    "mink": mink,
    "placo": placo,
    "Pinocchio": pinocchio,
}
