"""One side of the inverse kinematics rows: ik_side.py SIDE QUESTIONS.npz ANSWERS.npz.

Runs in the environment of the side's own package (ik.py makes it). Questions: targets (B, 4, 4) of
the tip in the base frame, seeds (B, n), limits (n, 2), `example` (n,), joint values that put the
tip at the first target, `urdf` and `robot` (files). Answers: q (B, n), NaN where the side found
nothing, and the seconds of each call; both empty when the side cannot solve this arm. Of two sides
that take turns: q (2, B, n), seconds (2, calls).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Questions = Mapping[str, Any]
Solve = Callable[[int], Array | None]
Side = Callable[[Questions], tuple[Array, Array] | None]

ROOT = Path(__file__).resolve().parents[1]
# Norms, in metres and radians.
TOLERANCE = 1e-5
TURNS, CALLS_A_TURN = 60, 10  # of each of two sides that take turns


def one_by_one(questions: Questions, solve: Solve) -> tuple[Array, Array]:
    """Answers and seconds of one call per target."""
    answers = np.full_like(questions["seeds"], np.nan)
    seconds = np.empty(len(answers))
    clock = time.perf_counter
    for b in range(len(answers)):
        begin = clock()
        q = solve(b)
        seconds[b] = clock() - begin
        if q is not None:
            answers[b] = q
    return answers, seconds


def load(questions: Questions) -> Any:
    """The robot, from its file."""
    from robocell.cli.robot_scene import load_robot

    return load_robot(Path(str(questions["robot"]))).robot


def batch(threads: int) -> Side:
    """All targets in one call, no seeds; the seconds per target."""

    def run(questions: Questions) -> tuple[Array, Array]:
        answers, seconds = batches(questions, threads, [None])
        return answers, np.array(seconds)

    return run


def batches(questions: Questions, threads: int, turns: Iterable[None]) -> tuple[Array, list[float]]:
    """All targets in one call for each turn; answers, and the seconds of each call, per target."""
    kinematics = load(questions).kinematics
    targets = questions["targets"]
    kinematics.ik_batch(targets[:1])  # makes what a chain keeps
    seconds = []
    for _ in turns:
        begin = time.perf_counter()
        found = kinematics.ik_batch(targets, tolerance=TOLERANCE, threads=threads)
        seconds.append((time.perf_counter() - begin) / len(targets))
    return np.where(found.success[:, None], found.q, np.nan), seconds


def batches_by_turns(questions: Questions) -> tuple[Array, Array]:
    """All targets in one call, ten times from Python, ten from C++ and so on: disturbances of both.

    Two processes one after the other differ by more than what a call from Python costs.
    """

    def turns(cpp: Popen[str]) -> Iterator[None]:
        assert cpp.stdin is not None
        assert cpp.stdout is not None
        cpp.stdout.readline()
        for _ in range(TURNS):
            yield from [None] * CALLS_A_TURN
            cpp.stdin.write("\n")
            cpp.stdin.flush()
            cpp.stdout.readline()

    with tempfile.TemporaryDirectory() as folder:
        command = cpp_command(questions, "turns", Path(folder))
        with Popen(command, stdin=PIPE, stdout=PIPE, text=True) as cpp:
            answers, seconds = batches(questions, 1, turns(cpp))
        its_answers, its_seconds = cpp_answers(questions, Path(folder))
    return np.stack([answers, its_answers]), np.stack([seconds, its_seconds])


def robocell_one(questions: Questions) -> tuple[Array, Array]:
    """One call per target, from the seed."""
    import robocell

    kinematics = load(questions).kinematics
    targets = [robocell.Pose(target) for target in questions["targets"]]
    seeds = list(questions["seeds"])
    kinematics.ik(robocell.Pose(translation=[9, 9, 9]))  # makes what a chain keeps

    def solve(b: int) -> Array | None:
        found = kinematics.ik(targets[b], seed=seeds[b], tolerance=TOLERANCE)
        return found.q if found.success else None

    return one_by_one(questions, solve)


def one_in_cpp(questions: Questions) -> tuple[Array, Array]:
    """The same from C++."""
    with tempfile.TemporaryDirectory() as folder:
        command = cpp_command(questions, "one", Path(folder))
        subprocess.run(command, check=True)
        return cpp_answers(questions, Path(folder))


def cpp_command(questions: Questions, how: str, folder: Path) -> list[str]:
    """That of ik_bench.cc, with the questions in a folder."""
    targets, seeds = questions["targets"], questions["seeds"]
    np.concatenate([seeds.shape, targets.ravel(), seeds.ravel()]).tofile(folder / "asked")
    program = ROOT / "build" / "release" / "ik_bench"
    robot, asked, answered = questions["robot"], folder / "asked", folder / "answered"
    return [str(word) for word in (program, robot, how, asked, answered)]


def cpp_answers(questions: Questions, folder: Path) -> tuple[Array, Array]:
    """What it left there."""
    numbers, shape = np.fromfile(folder / "answered"), questions["seeds"].shape
    return numbers[: np.prod(shape)].reshape(shape), numbers[np.prod(shape) :]


def kdl_lma(questions: Questions) -> tuple[Array, Array]:
    """KDL's Levenberg-Marquardt solver, one try; what it ends with is judged, whatever it says.

    It weighs rotations with 0.01, so its tolerance is a hundred times tighter.
    """
    import PyKDL

    chain = load(questions).kdl_chain()
    return kdl(questions, chain, PyKDL.ChainIkSolverPos_LMA(chain, TOLERANCE / 100))


def kdl_nr(questions: Questions) -> tuple[Array, Array]:
    """KDL's Newton-Raphson solver that clamps to the limits, one try of 100 steps."""
    import PyKDL

    chain = load(questions).kdl_chain()
    low, high = (kdl_joints(limit) for limit in questions["limits"].T)
    fk = PyKDL.ChainFkSolverPos_recursive(chain)
    velocities = PyKDL.ChainIkSolverVel_pinv(chain)
    # Its tolerance is one of each axis.
    solver = PyKDL.ChainIkSolverPos_NR_JL(chain, low, high, fk, velocities, 100, TOLERANCE / 2)
    return kdl(questions, chain, solver)


def kdl(questions: Questions, chain: Any, solver: Any) -> tuple[Array, Array]:
    """One call of a KDL solver per target."""
    import PyKDL

    frames = [kdl_frame(target) for target in questions["targets"]]
    seeds = [kdl_joints(seed) for seed in questions["seeds"]]
    out = PyKDL.JntArray(chain.getNrOfJoints())

    def solve(b: int) -> Array | None:
        solver.CartToJnt(seeds[b], frames[b], out)
        return np.array([out[i] for i in range(out.rows())])

    return one_by_one(questions, solve)


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
    "robocell small batch, by turns": batches_by_turns,
    "robocell": robocell_one,
    "robocell, C++": one_in_cpp,
    "KDL-LMA": kdl_lma,
    "KDL-NR": kdl_nr,
}


def main() -> None:
    """Solves the questions of the command line."""
    side, questions_file, answers_file = sys.argv[1:]
    if side not in SIDES:
        from ik_peers import PEERS

        SIDES.update(PEERS)
    with np.load(questions_file) as file:
        answers, seconds = SIDES[side]({name: file[name] for name in file.files}) or ([], [])
    np.savez(answers_file, q=answers, seconds=seconds)


if __name__ == "__main__":
    main()
