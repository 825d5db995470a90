"""P7: the control loop beside the bare engine (timed by control_loop_bench.cc), and from Python.

`control_loop.py CONTROL ROBOT.yaml` is one process of the latter: what it says are the seconds of
Python, those of C++ and their ratio.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import robocell
from bench_program import ROOT, OtherProcess, Turns, on_one_core, scaled, turns
from robots import arm_files, robot_files
from table import Row

AMPLITUDE, TIMESTEP, PARTS = 0.2, 0.002, 10  # as in control_loop_bench.cc
PROCESSES, ROUNDS = 9, 100  # of Python and C++


Part = Callable[[robocell.Scene, robocell.Robot, list[np.ndarray]], None]


def _follow(scene: robocell.Scene, robot: robocell.Robot, targets: list[np.ndarray]) -> None:
    """Joint position: a target each tick."""
    for target in targets:
        robot.jnt_pos_cmd = target
        robot.update()
        robot.step()


def _float(scene: robocell.Scene, robot: robocell.Robot, targets: list[np.ndarray]) -> None:
    """Gravity torques, the loop of mj_kdl_wrapper's guide."""
    for _ in targets:
        robot.jnt_trq_cmd = robot.gravity_torques()
        robot.update()
        scene.step()


# The names are those of control_loop_bench.cc.
LOOPS: dict[str, tuple[str, Part]] = {
    "joint position": ("position", _follow),
    "gravity torques": ("torque", _float),
}


def rows(folder: Path) -> list[Row]:
    """One row per robot and kind of control, and some per robot for the same loops in Python."""
    timed = turns("control_loop_bench", arm_files(), folder)
    beside_engine = [
        _row(f"control tick, {what}", timed[what], "peer: `mj_step` with the same controls")
        for what in sorted(timed)
    ]
    return beside_engine + [
        _from_python(control, file) for control in LOOPS for file in robot_files()
    ]


def _row(name: str, timed: Turns, note: str) -> Row:
    ours, peer = scaled(timed.ours, 1e6), scaled(timed.peer, 1e6)
    return Row(name, "µs", ours, peer, note=f"{note}; {timed.spread()}", ratios=timed.ratios)


def _from_python(control: str, file: Path) -> Row:
    timed = Turns()
    for _ in range(PROCESSES):
        timed.add(*_one_process(control, file))
    more = 1e6 * (statistics.median(timed.ratios) - 1) * statistics.median(timed.peer)
    note = f"peer: the same in C++; Python takes {more:.2f} µs a step more"
    return _row(f"control tick from Python, {_name(control, file)}", timed, note)


def _one_process(control: str, file: Path) -> tuple[float, float, float]:
    run = subprocess.run(
        [*on_one_core(), sys.executable, __file__, control, file],
        env=os.environ | {"PYTHONPATH": str(ROOT / "python")},
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode:
        raise RuntimeError(f"{control} from Python failed:\n{run.stdout}{run.stderr}")
    ours, peer, ratio = map(float, run.stdout.splitlines()[-1].split())
    return ours, peer, ratio


def _name(control: str, file: Path) -> str:
    return f"{control}, {robocell.RobotConfig.load(file).name}"


class _InPython:
    """A command, update and a step of the engine, as control_loop_bench.cc has it."""

    def __init__(self, control: str, file: Path) -> None:
        """In a scene of its own."""
        mode, self.part = LOOPS[control]
        config = robocell.RobotConfig.load(file)
        config.gravcomp = mode == "position"  # else there is nothing to compensate
        spec = robocell.SceneSpec(name="bench", timestep=TIMESTEP, add_floor=True, add_skybox=False)
        spec.robots.append(robocell.RobotSpec(name="robot", config=config))
        self.scene = robocell.Scene.build(spec)
        self.scene.reset()
        self.robot = self.scene.robot("robot")
        ticks = round(1 / TIMESTEP)
        swing = AMPLITUDE * np.sin(2 * np.pi * np.arange(ticks) / ticks)
        targets = np.array(self.robot.jnt_pos_cmd) + swing[:, np.newaxis]
        self.parts = [list(part) for part in np.split(targets, PARTS)]
        self.robot.ctrl_mode = mode
        self.states = [self.scene.state()]  # where parts begin, and the last one ends
        for part in self.parts:
            self.part(self.scene, self.robot, part)
            self.states.append(self.scene.state())
        self.at = 0

    def turn(self) -> float:
        """Seconds of a tick; the first run finds the caches full of the other process."""
        self.at = (self.at + 1) % PARTS
        self._seconds()
        return self._seconds() / len(self.parts[self.at])

    def _seconds(self) -> float:
        self.scene.set_state(self.states[self.at])
        begin = time.perf_counter()
        self.part(self.scene, self.robot, self.parts[self.at])
        seconds = time.perf_counter() - begin
        if (self.scene.state() != self.states[self.at + 1]).any():
            raise RuntimeError("the loop from Python ends elsewhere each time")
        return seconds


def main() -> None:
    """Lets Python and C++ take turns, each in a scene of its own."""
    control, file = sys.argv[1], Path(sys.argv[2])
    timed = Turns()
    with OtherProcess("control_loop_bench", _name(control, file), file) as in_cxx:
        timed.take(_InPython(control, file).turn, in_cxx.turn, ROUNDS)
    print(*timed.ours, *timed.peer, *timed.ratios)


if __name__ == "__main__":
    main()
