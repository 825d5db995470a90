"""P1 to P5: inverse kinematics beside its peers, each in a process and an environment of its own.

The same reachable targets for all, tip poses of random joint values in the limits; seeds are the
middle of the limits (cold) or 0.1 rad away from the solution (warm). Answers of all are judged by
robocell's scalar forward kinematics: position and rotation within 1e-5 as norms, inside the limits.
"""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import robocell
from ik_side import TOLERANCE
from ik_urdf import urdf
from robocell.cli.robot_scene import load_robot
from robots import is_available
from table import Row

ROOT = Path(__file__).resolve().parents[1]
ROBOTS = (
    "models/robots/rc7/rc7.yaml",
    "examples/xarm7.yaml",
    "examples/panda.yaml",
    "examples/gen3_2f85.yaml",
)
REPETITIONS = 5
# What is installed for a side that is not ours; None: nothing.
PACKAGES = {"TRAC-IK": "pytracik==0.0.3", "roboplan": "roboplan==0.7.0"}
BATCH, ONE = 20_000, 500  # targets

Array = NDArray[np.float64]


@dataclass
class Side:
    """A side and what was measured of it.

    Attributes:
        name: In ik_side.SIDES.
        count: How many of the targets it gets.
        rates: Answers a second, one value per repetition.
        p99: 99th percentile of one call, microseconds.
        solved: Share that the judge takes.
    """

    name: str
    count: int
    rates: list[float] = field(default_factory=list)
    p99: float = 0
    solved: float = 0

    @property
    def python(self) -> Path:
        """The interpreter that has the side's package."""
        package = PACKAGES.get(self.name)
        return environment(package) if package else Path(sys.executable)


def environment(package: str, *more: str) -> Path:
    """The interpreter of an environment with a package, and others; made when it is not there."""
    folder = ROOT / "build" / "bench" / "peers" / package.split("==")[0].replace("-", "_")
    python = folder / "bin" / "python"
    if not (folder / "ready").exists():
        venv.create(folder, with_pip=True, clear=True)
        subprocess.run(
            [python, "-m", "pip", "install", "--quiet", package, *more, "numpy"], check=True
        )
        (folder / "ready").touch()
    return python


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
        self.targets = np.array([self.robot.kinematics.fk(q).matrix for q in self.solutions])
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
            robot=str(self.file),
            urdf=str(description),
        )
        return file

    def share_solved(self, answers: Array) -> float:
        """Of answers to the first targets."""
        return float(np.mean([self.is_solved(b, q) for b, q in enumerate(answers)]))

    def is_solved(self, b: int, q: Array) -> bool:
        """Whether an answer is a solution inside the limits."""
        low, high = self.limits.T
        if not np.all((q >= low - 1e-9) & (q <= high + 1e-9)):  # also when it is NaN
            return False
        error = robocell.Pose(self.targets[b]).inverse() * self.robot.kinematics.fk(q)
        turn = float(np.linalg.norm(error.rotvec))
        return float(np.linalg.norm(error.translation)) <= TOLERANCE * 1.0001 and (
            turn <= TOLERANCE * 1.0001
        )


def measure(arm: Arm, side: Side, questions: Path, folder: Path) -> None:
    """One more repetition, in a process on one core."""
    with np.load(questions) as file:
        part = {name: file[name] for name in file.files}
    for name in ("targets", "seeds"):
        part[name] = part[name][: side.count]
    asked, answered = folder / "asked.npz", folder / "answered.npz"
    np.savez(asked, **part)
    script = Path(__file__).with_name("ik_side.py")
    subprocess.run(
        ["taskset", "--cpu-list", "0", side.python, script, side.name, asked, answered],
        env=os.environ | {"PYTHONPATH": str(ROOT / "python")},
        check=True,
    )
    with np.load(answered) as file:
        side.rates.append(1 / float(np.mean(file["seconds"])))
        side.p99 = 1e6 * float(np.percentile(file["seconds"], 99))
        side.solved = arm.share_solved(file["q"])


def compare(arm: Arm, ours: Side, peers: list[Side], folder: Path, *, warm: bool) -> list[Row]:
    """A row per peer; all sides in turn, several times."""
    questions = arm.questions(folder, warm=warm)
    for _ in range(REPETITIONS):
        for side in (ours, *peers):
            measure(arm, side, questions, folder)
    how = "in one batch" if ours.name.endswith("batch") else "one by one"
    start = "warm" if warm else "cold"
    return [
        Row(
            f"inverse kinematics {how}, {start}, {arm.robot.name}",
            "1/s",
            ours.rates,
            peer.rates,
            better="higher",
            note=f"peer: {peer.name}; solved {ours.solved:.2%} / {peer.solved:.2%}"
            + ("" if how == "in one batch" else f"; p99 {ours.p99:.0f} / {peer.p99:.0f} µs"),
        )
        for peer in peers
    ]


def rows(folder: Path) -> list[Row]:
    """Three questions to each robot: a batch, single poses cold, single poses warm."""
    result: list[Row] = []
    for name in ROBOTS:
        if not is_available(ROOT / name):
            continue
        arm = Arm(ROOT / name)
        for ours, warm in (("robocell batch", False), ("robocell", False), ("robocell", True)):
            peers = [Side("KDL", ONE)]
            if not warm:
                peers += [Side(peer, ONE) for peer in PACKAGES]
            count = BATCH if ours == "robocell batch" else ONE
            result += compare(arm, Side(ours, count), peers, folder, warm=warm)
    return result
