"""One side of the inverse kinematics rows: ik_side.py SIDE QUESTIONS.npz ANSWERS.npz.

Runs in the environment of the side's own package (ik.py makes it). Questions: targets (B, 4, 4) of
the tip in the base frame, seeds (B, n), limits (n, 2), `example` (n,), joint values that put the
tip at the first target, `urdf` and `robot` (files).

Sides take turns: each waits, having said so, for a line on stdin, then answers all questions, again
and again for TURN seconds. Where there are no more lines it writes down its answers: q (B, n) of
its fastest turn, NaN where it found nothing; and of each turn the mean of its calls' seconds (or
seconds per target), their median and their 99th percentile. A side that cannot solve this arm ends
before its first turn.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Questions = Mapping[str, Any]
Pass = tuple[Any, Array]  # answers of a package to all queries, the seconds of each call


class Answers(NamedTuple):
    """What a side writes down."""

    q: Array
    means: Array
    p50s: Array
    p99s: Array


Side = Callable[[Questions], Answers | None]

ROOT = Path(__file__).resolve().parents[1]
# Norms, in metres and radians.
TOLERANCE = 1e-5
# At least this and one pass over the queries: the same for all sides, as what is short finds faster
# moments of a machine. As in ik_bench.cc.
TURN = 0.05
READY = "ready\n"  # ends a line on stdout: the side waits for its turn


def turns() -> Iterator[None]:
    """The turns of this side."""
    while True:
        print(READY, end="", flush=True)
        if not sys.stdin.readline():
            return
        yield None


def by_turns(one_pass: Callable[[], Pass], read: Callable[[Any], Array]) -> Answers:
    """What the fastest turn answered, as `read` reads it, and what all of them took."""
    fastest: Array = np.empty(0)
    means: list[float] = []
    percentiles: list[Array] = []
    for _ in turns():
        end = time.perf_counter() + TURN
        answered, first = one_pass()
        passes = [first]
        while time.perf_counter() < end:
            answered, one = one_pass()  # in the place of those before, as in a loop of anybody's
            passes.append(one)
        seconds = np.concatenate(passes)
        means.append(float(seconds.mean()))
        percentiles.append(np.percentile(seconds, (50, 99)))
        if means[-1] == min(means):
            fastest = read(answered)
    return Answers(fastest, np.array(means), *np.transpose(percentiles))


def one_by_one(
    questions: Questions,
    solve: Callable[[int], Any],
    *,
    read: Callable[[Any], Array] = np.asarray,
    begin_pass: Callable[[], None] = lambda: None,
) -> Answers:
    """One call per target: it returns joint values, of which `read` makes an array, or None.

    Neither that nor `begin_pass` is timed; the clock is, and Python's call of `solve`: 60 ns, of
    all sides.
    """
    clock = time.perf_counter

    def one_pass() -> Pass:
        begin_pass()
        answers = np.full_like(questions["seeds"], np.nan)
        seconds = np.empty(len(answers))
        for b in range(len(answers)):
            begin = clock()
            q = solve(b)
            seconds[b] = clock() - begin
            if q is not None:
                answers[b] = read(q)
        return answers, seconds

    return by_turns(one_pass, np.asarray)


def load(questions: Questions) -> Any:
    """The robot, from its file."""
    from robocell._cli.robot_scene import load_robot

    return load_robot(Path(str(questions["robot"]))).robot


def batch(threads: int) -> Side:
    """All targets in one call, no seeds; the seconds per target."""

    def run(questions: Questions) -> Answers:
        kinematics = load(questions).kinematics
        targets = questions["targets"]
        kinematics.ik_batch(targets[:1])  # makes what a chain keeps

        def one_pass() -> Pass:
            begin = time.perf_counter()
            found = kinematics.ik_batch(targets, tolerance=TOLERANCE, threads=threads)
            seconds = time.perf_counter() - begin
            return found, np.array([seconds / len(targets)])

        return by_turns(one_pass, lambda found: np.where(found.success[:, None], found.q, np.nan))

    return run


def robocell_one(questions: Questions) -> Answers:
    """One call per target, from the seed."""
    import robocell

    kinematics = load(questions).kinematics
    targets = [robocell.Pose(target) for target in questions["targets"]]
    seeds = list(questions["seeds"])
    kinematics.ik(robocell.Pose(translation=[9, 9, 9]))  # makes what a chain keeps
    solver = kinematics.ik_solver(tolerance=TOLERANCE)
    q = np.empty(len(seeds[0]))  # read before the next call

    def solve(b: int) -> Array | None:
        return q if solver.solve(targets[b], seeds[b], q) else None

    return one_by_one(questions, solve)


def in_cpp(how: str) -> Side:
    """The same from C++, by ik_bench.cc."""

    def run(questions: Questions) -> Answers:
        targets, seeds = questions["targets"], questions["seeds"]
        with tempfile.TemporaryDirectory() as folder:
            asked, answered = Path(folder) / "asked", Path(folder) / "answered"
            np.concatenate([seeds.shape, targets.ravel(), seeds.ravel()]).tofile(asked)
            program = ROOT / "build" / "release" / "ik_bench"
            subprocess.run([program, str(questions["robot"]), how, asked, answered], check=True)
            numbers = np.fromfile(answered)
        turns = int(numbers[0])
        q, *of_turns = np.split(numbers[1:], seeds.size + turns * np.arange(3))
        return Answers(q.reshape(seeds.shape), *of_turns)

    return run


def kdl_lma(questions: Questions) -> Answers:
    """KDL's Levenberg-Marquardt solver, one try; what it ends with is judged, whatever it says.

    It weighs rotations with 0.01, so its tolerance is a hundred times tighter.
    """
    import PyKDL

    chain = load(questions).kdl_chain()
    return kdl(questions, chain, PyKDL.ChainIkSolverPos_LMA(chain, TOLERANCE / 100))


def kdl_nr(questions: Questions) -> Answers:
    """KDL's Newton-Raphson solver that clamps to the limits, one try of 100 steps."""
    import PyKDL

    chain = load(questions).kdl_chain()
    low, high = (kdl_joints(limit) for limit in questions["limits"].T)
    fk = PyKDL.ChainFkSolverPos_recursive(chain)
    velocities = PyKDL.ChainIkSolverVel_pinv(chain)
    # Its tolerance is one of each axis.
    solver = PyKDL.ChainIkSolverPos_NR_JL(chain, low, high, fk, velocities, 100, TOLERANCE / 2)
    return kdl(questions, chain, solver)


def kdl(questions: Questions, chain: Any, solver: Any) -> Answers:
    """One call of a KDL solver per target."""
    import PyKDL

    frames = [kdl_frame(target) for target in questions["targets"]]
    seeds = [kdl_joints(seed) for seed in questions["seeds"]]
    out = PyKDL.JntArray(chain.getNrOfJoints())

    def solve(b: int) -> Any:
        solver.CartToJnt(seeds[b], frames[b], out)
        return out

    return one_by_one(questions, solve, read=lambda q: np.array([q[i] for i in range(q.rows())]))


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


SIDES: dict[str, Side] = {
    "robocell batch": batch(threads=1),
    "robocell batch, 2 threads": batch(threads=2),
    "robocell batch, C++": in_cpp("batch"),
    "robocell": robocell_one,
    "robocell, C++": in_cpp("one"),
    "KDL-LMA": kdl_lma,
    "KDL-NR": kdl_nr,
}


def main() -> None:
    """Solves the queries of the command line."""
    side, questions_file, answers_file = sys.argv[1:]
    if side not in SIDES:
        from ik_peers import PEERS

        SIDES.update(PEERS)
    with np.load(questions_file) as file:
        answers = SIDES[side]({name: file[name] for name in file.files})
    if answers is not None:
        np.savez(answers_file, **answers._asdict())


if __name__ == "__main__":
    main()
