"""P1 to P5: inverse kinematics beside its peers, each in a process and an environment of its own.

The same reachable targets for all, tip poses of random joint values in the limits, of which slow
sides get the first; seeds are the middle of the limits (cold) or 0.1 rad away from the solution
(warm). Answers of all are judged by
robocell's scalar forward kinematics: position and rotation within 1e-5 as norms, inside the limits.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
import venv
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import robocell
from bench_program import Turns
from ik_side import READY, TOLERANCE
from ik_urdf import urdf
from robocell._cli.robot_scene import load_robot
from robots import is_available
from table import Row

ROOT = Path(__file__).resolve().parents[1]
ROBOTS = (
    "models/robots/rc7/rc7.yaml",
    "examples/xarm7.yaml",
    "examples/panda.yaml",
    "examples/gen3_2f85.yaml",
    "examples/desk6/desk6.yaml",
)
ROUNDS = 16  # turns of each side
# Rows of small batches take part in more processes, because two percent count.
PROCESSES_OF_SMALL, ROUNDS_OF_SMALL = 7, 16
# Packages of each other side, installed in an environment of its own.
PACKAGES = {
    "TRAC-IK": "pytracik==0.0.3",
    "roboplan": "roboplan==0.7.0",
    "EAIK": "EAIK==1.2.2",
    "mink": "mink==1.3.0 mujoco==4.0.0 qpsolvers[daqp]",
    "placo": "placo==0.10.2",
    "Pinocchio": "pin==4.1.0",
}
BATCH, SMALL = 20_000, 1_000  # targets
# Single calls: fifty of ours are slower than the 99th percentile. Peers take longer.
ONE, ONE_OF_PEERS = 5_000, 500

Array = NDArray[np.float64]


@dataclass
class Side:
    """A side and what was measured of it.

    Attributes:
        name: In ik_side.SIDES or ik_peers.PEERS.
        count: How many of the targets it gets.
        rates: Answers a second, the mean of each turn; none when it cannot solve this arm.
        p50: Median of one call, microseconds; of the turns' the median.
        p99: 99th percentile of it; of the turns' the median.
        reached: Share of the answers in the fastest turn that put the tip where it shall be.
        solved: Share that the judge takes: these, inside the limits.
    """

    name: str
    count: int
    rates: list[float] = field(default_factory=list)
    p50: float = 0
    p99: float = 0
    reached: float = 0
    solved: float = 0

    def take(self, arm: Arm, answered: Path) -> None:
        """What its process wrote down."""
        with np.load(answered) as file:
            self.rates = list(1 / file["means"])
            self.p50, self.p99 = (1e6 * float(np.median(file[name])) for name in ("p50s", "p99s"))
            self.reached, self.solved = arm.judge(file["q"])

    @property
    def python(self) -> Path | None:
        """The interpreter that has the side's package; None when it cannot be installed."""
        return interpreter(self.name) if self.name in PACKAGES else Path(sys.executable)

    def shares(self) -> str:
        """What it solved, and what it only reached: of thousands of targets to the last of them."""
        outside = f" (beyond limits too: {self.reached:.3%})"
        return f"{self.solved:.3%}" + (outside if self.reached > self.solved + 5e-4 else "")


def environment(package: str, *more: str) -> Path:
    """The interpreter of an environment with a package, and others; made when it is not there."""
    folder = ROOT / "build" / "bench" / "peers" / package.split("==")[0].replace("-", "_")
    python = folder / "bin" / "python"
    ready = folder / "ready"
    if not ready.exists():
        venv.create(folder, with_pip=True, clear=True)
        subprocess.run(
            [python, "-m", "pip", "install", "--quiet", package, *more, "numpy"], check=True
        )
        ready.touch()
    return python


def interpreter(peer: str) -> Path | None:
    """That of a peer's environment; None, having said so, when its packages cannot be installed."""
    try:
        return environment(*PACKAGES[peer].split())
    except subprocess.CalledProcessError:
        print(f"left out: {peer}: it cannot be installed")
        return None


class Arm:
    """A robot's arm with its targets."""

    def __init__(self, file: Path) -> None:
        """Takes the robot from its file."""
        self.file = file
        self.robot = load_robot(file).robot
        limits = np.array(self.robot.joint_limits)
        self.limits = np.where(np.isfinite(limits), limits, np.sign(limits) * np.pi)
        rng = np.random.default_rng(1)
        low, high = self.limits.T
        self.solutions = rng.uniform(low, high, (BATCH, len(limits)))
        self.targets = self.robot.kinematics.fk(self.solutions)
        self.nearby = np.clip(
            self.solutions + rng.uniform(-0.1, 0.1, self.solutions.shape), low, high
        )

    def questions(self, folder: Path, *, warm: bool) -> Path:
        """A file for the sides."""
        description = folder / f"{self.robot.name}.urdf"
        description.write_text(urdf(self.robot.kdl_chain(), self.limits.tolist()))
        file = folder / f"{self.robot.name}_{'warm' if warm else 'cold'}.npz"
        middle = np.broadcast_to(self.limits.mean(axis=1), self.nearby.shape)
        np.savez(
            file,
            targets=self.targets,
            seeds=self.nearby if warm else middle,
            limits=self.limits,
            example=self.solutions[0],
            robot=str(self.file),
            urdf=str(description),
        )
        return file

    def judge(self, answers: Array) -> tuple[float, float]:
        """Shares of answers to the first targets that reach them, and that do so in the limits."""
        reached = np.array([self.is_reached(b, q) for b, q in enumerate(answers)])
        low, high = np.array(self.robot.joint_limits).T
        inside = ((answers >= low - 1e-9) & (answers <= high + 1e-9)).all(axis=1)
        return float(reached.mean()), float((reached & inside).mean())

    def is_reached(self, b: int, q: Array) -> bool:
        """Whether joint values put the tip at a target."""
        if not np.isfinite(q).all():
            return False
        error = robocell.Pose(self.targets[b]).inverse() * self.robot.kinematics.fk(q)
        off = max(np.linalg.norm(error.translation), np.linalg.norm(error.rotvec))
        return bool(off <= TOLERANCE * 1.0001)


class Process:
    """That of a side, on one core (on as many as it has threads); it waits for its turns."""

    def __init__(self, side: Side, python: Path, questions: Path, folder: Path) -> None:
        """Starts the process of a side with its targets."""
        self.side = side
        with np.load(questions) as file:
            part = {name: file[name] for name in file.files}
        for name in ("targets", "seeds"):
            part[name] = part[name][: side.count]
        asked = folder / f"{side.name} asked.npz"
        np.savez(asked, **part)
        self.answered = folder / f"{side.name} answered.npz"
        self.answered.unlink(missing_ok=True)
        cores = "0,1" if "2 threads" in side.name else "0"
        script = Path(__file__).with_name("ik_side.py")
        self.process = subprocess.Popen(
            ["taskset", "--cpu-list", cores, python, script, side.name, asked, self.answered],
            env=os.environ | {"PYTHONPATH": str(ROOT / "python"), "OMP_NUM_THREADS": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def is_ready(self) -> bool:
        """Waits until it is; False when it has ended."""
        assert self.process.stdout is not None
        # A package may print its own text in the same line.
        return any(line.endswith(READY) for line in self.process.stdout)

    def turn(self) -> None:
        """The process has a turn."""
        assert self.process.stdin is not None
        print(file=self.process.stdin, flush=True)
        if not self.is_ready():
            raise RuntimeError(f"{self.side.name} ended within its turn")

    def end(self, arm: Arm) -> None:
        """Lets it write down its answers, if it has some, and takes them."""
        self.process.communicate()
        if self.process.returncode:
            raise RuntimeError(f"{self.side.name} failed")
        if self.answered.exists():
            self.side.take(arm, self.answered)


def measure(
    arm: Arm, sides: Sequence[Side], questions: Path, folder: Path, rounds: int = ROUNDS
) -> None:
    """Turns of all sides, in each round in another order: they see the same moments."""
    with ExitStack() as stack:
        asked = [
            Process(side, python, questions, folder) for side in sides if (python := side.python)
        ]
        for each in asked:
            stack.enter_context(each.process)
        able = [each for each in asked if each.is_ready()]
        for _ in range(rounds):
            for each in random.sample(able, len(able)):
                each.turn()
        for each in asked:
            each.end(arm)


def compare(
    arm: Arm, ours: Sequence[Side], peers: Sequence[Side], folder: Path, *, warm: bool = False
) -> list[Row]:
    """A row for each of ours beside each peer that can solve the arm."""
    measure(arm, [*ours, *peers], arm.questions(folder, warm=warm), folder)
    return [
        row(arm, side, peer, "warm" if warm else "cold")
        for side in ours
        for peer in peers
        if peer.rates
    ]


def row(arm: Arm, ours: Side, peer: Side, start: str) -> Row:
    """One of ours beside a peer."""
    together = "batch" in ours.name
    note = f"peer: {peer.name}; solved {ours.shares()} / {peer.shares()}"
    if not together:
        note += f"; p50, p99 {ours.p50:.1f}, {ours.p99:.1f} / {peer.p50:.1f}, {peer.p99:.1f} µs"
    how = "in one batch" if together else "one by one"
    language = ", C++" if "C++" in ours.name else ""
    return Row(
        f"inverse kinematics {how}, {start}{language}, {arm.robot.name}",
        "1/s",
        ours.rates,
        peer.rates,
        better="higher",
        note=note,
    )


def two_threads(arm: Arm, folder: Path) -> Row:
    """Two threads beside one."""
    one, two = Side("robocell batch", BATCH), Side("robocell batch, 2 threads", BATCH)
    measure(arm, [one, two], arm.questions(folder, warm=False), folder)
    return Row(
        f"inverse kinematics in one batch, 2 threads, {arm.robot.name}",
        "1/s",
        two.rates,
        one.rates,
        better="higher",
        note="peer: ours on 1 thread",
    )


def from_python(arm: Arm, folder: Path) -> Row:
    """Python beside C++, with a small batch: the ratio is that of neighbouring turns."""
    questions = arm.questions(folder, warm=False)
    timed = Turns()
    for _ in range(PROCESSES_OF_SMALL):
        python, cpp = Side("robocell batch", SMALL), Side("robocell batch, C++", SMALL)
        measure(arm, [python, cpp], questions, folder, ROUNDS_OF_SMALL)
        timed.add_turns(zip(python.rates, cpp.rates, strict=True))
    return Row(
        f"inverse kinematics in one batch, {SMALL} targets, Python, {arm.robot.name}",
        "1/s",
        timed.ours,
        timed.peer,
        better="higher",
        note=f"peer: ours from C++; {timed.spread()}",
        ratios=timed.ratios,
    )


def rows(folder: Path) -> list[Row]:
    """Of each robot: batches and single poses cold, single poses warm, and ours beside ours."""
    result: list[Row] = []
    for name in ROBOTS:
        if not is_available(ROOT / name):
            continue
        arm = Arm(ROOT / name)
        kdl = ["KDL-LMA", "KDL-NR"]
        singles = ["robocell, C++", "robocell"]
        cold = [Side(peer, ONE_OF_PEERS) for peer in (*kdl, *PACKAGES)]
        ours = [Side("robocell batch", BATCH), *(Side(side, ONE) for side in singles)]
        result += compare(arm, ours, cold, folder)
        warm = [Side(side, ONE) for side in singles]
        result += compare(arm, warm, [Side("KDL-LMA", ONE_OF_PEERS)], folder, warm=True)
        result += [two_threads(arm, folder), from_python(arm, folder)]
    return result
