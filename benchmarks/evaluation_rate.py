"""P18, its second half: rollouts of a policy that costs nothing, beside the environment alone.

Both sides step the same cell from the same starts with the same actions: the arm holds its targets
until the steps are used up. One side does it as `robocell evaluate` does, which reads the whole row
for the policy, checks its action and keeps the episode's rows, or with `--no-rollouts` only the
result; the other calls `RunEnv.act` alone.
"""

from __future__ import annotations

import shutil
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from table import Row

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))

from robocell._core import RunEnv  # noqa: E402

import robocell as rc  # noqa: E402
from robocell.policy import Policy, register_policy  # noqa: E402

REPETITIONS = 5
ROLLOUTS = 4
KIND = "benchmark: holds"
ARM, GRIPPER = "robots/rc7/action/arm", "robots/rc7/action/gripper"


class Holds(Policy):
    """Returns the same action each time."""

    action: dict[str, Any]

    def __init__(self, run: Any) -> None:
        self.action = {ARM: np.array(run.robot.home["arm"]), GRIPPER: np.ones(1)}

    def act(self, observation: Any) -> Any:
        """The action."""
        return self.action


def rows(folder: Path, repetitions: int = REPETITIONS, rollouts: int = ROLLOUTS) -> list[Row]:
    """Actions per second of all sides."""
    register_policy(KIND, Holds)
    kept: list[float] = []
    ours: list[float] = []
    peer: list[float] = []
    out = folder / "evaluation_rate"
    for number in range(repetitions):
        sides = [
            lambda: kept.append(evaluated_per_s(out, rollouts, stores=True)),
            lambda: ours.append(evaluated_per_s(out, rollouts, stores=False)),
            lambda: peer.append(alone_per_s(rollouts)),
        ]
        for side in sides if number % 2 == 0 else reversed(sides):
            side()
    note = "peer: the environment alone; one worker, 66 ms an action, no images"
    name = "actions of a policy that costs nothing"
    return [
        Row(f"{name}, {what}, rc7", "1/s", values, peer, better="higher", note=note)
        for what, values in (("no rollouts kept", ours), ("rollouts kept", kept))
    ]


def cell(output: Path | str, rollouts: int) -> rc.RunConfig:
    """The demo without cameras."""
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml")
    run.cameras.streams.clear()
    run.cameras.draw = False
    run.episodes, run.output = rollouts, str(output)
    run.rates.max_steps = 200
    return run


def evaluated_per_s(folder: Path, rollouts: int, stores: bool) -> float:
    """Actions per second of rollouts, starts and files included."""
    shutil.rmtree(folder, ignore_errors=True)
    run = cell(folder, rollouts)
    run.expert, run.keep = KIND, "first"
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run, stores=stores)
    plan = rc.generate.make_plan(run)[:rollouts]
    runner.run(plan[0])  # compiles
    began = time.perf_counter()
    steps = sum(runner.run(item).rows for item in plan[1:])
    elapsed = time.perf_counter() - began
    if steps != (rollouts - 1) * run.rates.max_steps:
        raise RuntimeError(f"{steps} actions, expected {(rollouts - 1) * run.rates.max_steps}")
    return steps / elapsed


def alone_per_s(rollouts: int) -> float:
    """Actions per second of the environment alone, starts included."""
    run = cell("nowhere", rollouts)
    env = RunEnv(run)
    action = Holds(run).action
    plan = rc.generate.make_plan(run)[:rollouts]
    env.reset(plan[0].index)
    began = time.perf_counter()
    for item in plan[1:]:
        env.reset(item.index)
        for _ in range(run.rates.max_steps):
            env.act(action)
    return (rollouts - 1) * run.rates.max_steps / (time.perf_counter() - began)
