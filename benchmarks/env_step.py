"""P8 and P9: a step of an environment from Python, and its reset, beside what does the same.

The loop in C++ is env_step_bench.cc; all others run in env_side.py, each in a process of its own,
robosuite, gymnasium-robotics and EnvPool in environments of their own with the mujoco that they
work with.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from bench_program import scaled, seconds
from ik import environment
from robots import robot_files
from table import Row

ROOT = Path(__file__).resolve().parents[1]
ROUNDS = 5
# Side -> what is installed for it. Newer versions of mujoco break the first two; EnvPool has one of
# its own.
PEERS = {
    "robosuite": ("robosuite==1.5.2", "mujoco==3.4.0"),
    "gymnasium_robotics": ("gymnasium-robotics==1.4.2", "mujoco==3.4.0"),
    "envpool": ("envpool==1.2.5",),
}
ON_TWO_THREADS = ("vector1", "vector2", "envpool")  # not pinned to a core; vector1 has one
Measured = dict[str, dict[str, list[float]]]  # side -> step, reset, ... -> seconds


def measure(side: str, file: Path, into: Measured, *, one_core: bool = True) -> None:
    """One more round of a side."""
    python = environment(*PEERS[side]) if side in PEERS else Path(sys.executable)
    run = subprocess.run(
        [
            *(("taskset", "--cpu-list", "0") if one_core else ()),
            *(python, Path(__file__).with_name("env_side.py"), side, file),
        ],
        env=os.environ | {"PYTHONPATH": "" if side in PEERS else str(ROOT / "python")},
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode:
        raise RuntimeError(f"{side} failed:\n{run.stdout}{run.stderr}")
    for what, value in json.loads(run.stdout.splitlines()[-1]).items():
        into[side][what].append(value)


def rounds(file: Path, peers: list[str], folder: Path) -> Measured:
    """All sides in turn, several times; C++ as sides ``C++`` and ``mj_step``."""
    measured: Measured = defaultdict(lambda: defaultdict(list))
    for _ in range(ROUNDS):
        for side in ("robocell", "mujoco", "vector1", "vector2", *peers):
            measure(side, file, measured, one_core=side not in ON_TWO_THREADS)
        [sides] = seconds("env_step_bench", [file], folder, repetitions=1).values()
        measured["C++"]["step"] += sides["env"]
        measured["mj_step"]["step"] += sides["mj_step"]
    return measured


def available(peer: str) -> bool:
    """Whether it installs."""
    try:
        environment(*PEERS[peer])
    except subprocess.CalledProcessError:
        print(f"left out: {peer} does not install here")
        return False
    return True


STEP = "step from Python, 33 of the engine"
RESET = "reset from Python"
TWO_THREADS = "step in a vector on two threads"
OF_ENGINE = "step of the engine in a vector on two threads"
# What, side and value of ours, side and value of the peer's, note.
COMPARED = (
    (STEP, "robocell", "step", "C++", "step", "peer: the same in C++, `Env::Step`"),
    (STEP, "robocell", "step", "mj_step", "step", "peer: `mj_step` alone, same controls"),
    (STEP, "robocell", "step", "mujoco", "step", "peer: package mujoco, controls by numpy"),
    (TWO_THREADS, "vector2", "step", "vector1", "step", "peer: one thread; 32 copies, of one"),
    (OF_ENGINE, "vector2", "engine", "envpool", "engine", "peer: EnvPool, FetchPickAndPlace-v4"),
    (STEP, "robocell", "step", "robosuite", "step", "peer: robosuite's Lift, Panda"),
    (RESET, "robocell", "reset", "robosuite", "reset", "peer: robosuite's Lift, soft"),
    (RESET, "robocell", "reset", "robosuite", "hard", "peer: robosuite's Lift, hard"),
    (RESET, "robocell", "reset", "gymnasium_robotics", "reset", "peer: FetchPickAndPlace-v4"),
)


def rows(folder: Path) -> list[Row]:
    """Steps and resets of each robot; the peers' tasks once, beside the first robot."""
    result: list[Row] = []
    peers = [peer for peer in PEERS if available(peer)]
    for file in robot_files():
        measured = rounds(file, peers, folder)
        for what, ours, value, peer, of_peer, note in COMPARED:
            if peer not in measured:
                continue
            sides = (measured[ours][value], measured[peer][of_peer])
            us = [scaled(side, 1e6) for side in sides]
            result.append(Row(f"{what}, {file.stem}", "µs", us[0], us[1], note=note))
        peers = []
    return result
