"""P7: the control loop beside the bare engine (timed by control_loop_bench.cc), and from Python."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import robocell
from bench_program import scaled, seconds
from robots import arm_files, robot_files
from table import Row

AMPLITUDE, TIMESTEP = 0.2, 0.002  # as in control_loop_bench.cc
# A repetition takes about as long as one of control_loop_bench: short ones find quieter moments.
REPETITIONS, ROUNDS = 5, 20


Second = Callable[[robocell.Scene, robocell.Robot, list[np.ndarray]], None]


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


# As control_loop_bench.cc names them.
LOOPS: dict[str, tuple[str, Second]] = {
    "joint position": ("position", _follow),
    "gravity torques": ("torque", _float),
}


def rows(folder: Path) -> list[Row]:
    """One row per robot and kind of control, and some per robot for the same loops in Python."""
    configs = [robocell.RobotConfig.load(file) for file in robot_files()]
    loops = [(control, config) for control in LOOPS for config in configs]
    before = [_python_loop(*loop) for loop in loops]
    timed = seconds("control_loop_bench", arm_files(), folder, repetitions=1, processes=7)
    after = [_python_loop(*loop) for loop in loops]
    beside_engine = [
        Row(
            f"control tick, {control}",
            "µs",
            scaled(sides["update+step"], 1e6),
            scaled(sides["mj_step"], 1e6),
            note="peer: `mj_step` with the same controls",
        )
        for control, sides in timed.items()
    ]
    return beside_engine + [
        _from_python(f"{control}, {config.name}", one + other, timed)
        for (control, config), one, other in zip(loops, before, after, strict=True)
    ]


def _from_python(name: str, times: list[float], timed: dict[str, dict[str, list[float]]]) -> Row:
    ours = scaled(times, 1e6)
    in_cxx = scaled(timed[name]["update+step"], 1e6)
    more = min(ours) - min(in_cxx)
    return Row(
        f"control tick from Python, {name}",
        "µs",
        ours,
        in_cxx,
        note=f"peer: the same in C++, run in between; Python takes {more:.2f} µs a step more",
    )


def _python_loop(control: str, config: robocell.RobotConfig) -> list[float]:
    """Seconds of a tick in each repetition: a command, update and a step of the engine."""
    mode, second = LOOPS[control]
    config.gravcomp = mode == "position"  # else there is nothing to compensate
    spec = robocell.SceneSpec(name="bench", timestep=TIMESTEP, add_floor=True, add_skybox=False)
    spec.robots.append(robocell.RobotSpec(name="robot", config=config))
    scene = robocell.Scene.build(spec)
    scene.reset()
    robot = scene.robot("robot")
    ticks = round(1 / TIMESTEP)
    swing = AMPLITUDE * np.sin(2 * np.pi * np.arange(ticks) / ticks)
    targets = list(np.array(robot.jnt_pos_cmd) + swing[:, np.newaxis])
    robot.ctrl_mode = mode
    start, ends, times = scene.state(), [], []
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        for _ in range(REPETITIONS):
            fastest = float("inf")
            for _ in range(ROUNDS):
                scene.set_state(start)
                begin = time.perf_counter()
                second(scene, robot, targets)
                fastest = min(fastest, time.perf_counter() - begin)
                ends.append(scene.state())
            times.append(fastest / ticks)
    finally:
        os.sched_setaffinity(0, cores)
    if any((end != ends[0]).any() for end in ends):
        raise RuntimeError("the loop from Python ends elsewhere each time")
    return times
