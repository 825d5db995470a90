"""P7: the control loop beside the bare engine (timed by control_loop_bench.cc), and from Python."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np

import robocell
from bench_program import scaled, seconds
from robots import robot_files
from table import Row

AMPLITUDE, TIMESTEP = 0.2, 0.002  # as in control_loop_bench.cc
# A repetition takes about as long as one of control_loop_bench: short ones find quieter moments.
REPETITIONS, ROUNDS = 5, 20


def rows(folder: Path) -> list[Row]:
    """One row per robot and kind of control, and one per robot for the same loop in Python."""
    files = robot_files()
    configs = [robocell.RobotConfig.load(file) for file in files]
    before = [_python_loop(config) for config in configs]
    timed = seconds("control_loop_bench", files, folder)
    after = [_python_loop(config) for config in configs]
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
        _from_python(f"joint position, {config.name}", one + other, timed)
        for config, one, other in zip(configs, before, after, strict=True)
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


def _python_loop(config: robocell.RobotConfig) -> list[float]:
    """Seconds of a tick in each repetition: a command, update and a step of the engine."""
    config.gravcomp = True
    spec = robocell.SceneSpec(name="bench", timestep=TIMESTEP, add_floor=True, add_skybox=False)
    spec.robots.append(robocell.RobotSpec(name="robot", config=config))
    scene = robocell.Scene.build(spec)
    scene.reset()
    robot = scene.robot("robot")
    ticks = round(1 / TIMESTEP)
    swing = AMPLITUDE * np.sin(2 * np.pi * np.arange(ticks) / ticks)
    targets = list(np.array(robot.jnt_pos_cmd) + swing[:, np.newaxis])
    start, ends, times = scene.state(), [], []
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        for _ in range(REPETITIONS):
            elapsed = 0.0
            for _ in range(ROUNDS):
                scene.set_state(start)
                begin = time.perf_counter()
                for target in targets:
                    robot.jnt_pos_cmd = target
                    robot.update()
                    robot.step()
                elapsed += time.perf_counter() - begin
                ends.append(scene.state())
            times.append(elapsed / (ROUNDS * ticks))
    finally:
        os.sched_setaffinity(0, cores)
    if any((end != ends[0]).any() for end in ends):
        raise RuntimeError("the loop from Python ends elsewhere each time")
    return times
