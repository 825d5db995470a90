"""P11: colour, depth and segmentation on one core, beside mujoco.Renderer.

What is timed: render_side.py. The view is the worse of two.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from bench_program import on_one_core
from embree import embree_peer
from render_side import SIDES, VIEWS
from robots import arm_files
from table import Row

HERE = Path(__file__).resolve().parent
ROUNDS = 3  # processes of each side, in turns
ARMS = ("rc7", "xarm7", "panda")
COMPARED = (
    ("soft", "mujoco", "peer: `mujoco.Renderer`, default"),
    ("soft", "mujoco_off", "peer: `mujoco.Renderer`, effects off"),
    ("gl", "mujoco_off", "peer: `mujoco.Renderer`, effects off"),
    ("soft_standard", "mujoco", "peer: `mujoco.Renderer`, default"),
    ("soft_standard", "embree", "peer: rays on Embree with hard shadows"),
)
NAMES = {
    "soft": "image of `soft`",
    "gl": "image of `gl`",
    "soft_standard": "image of `soft`, shadows and 4 samples",
}
Times = dict[str, list[float]]


def rows(_: Path) -> list[Row]:
    """Of each robot, in the view in which the ratio is worse."""
    found = []
    with_embree = embree_peer() is not None
    sides_here = [*SIDES, "embree"] if with_embree else list(SIDES)
    for file in arm_files():
        if file.stem not in ARMS:
            continue
        measured = {view: rounds(file, view, sides_here) for view in VIEWS}
        for ours, peer, note in COMPARED:
            if peer not in sides_here:
                continue
            of_views = [
                Row(
                    f"{NAMES[ours]}, {file.stem}",
                    "ms",
                    sides[ours],
                    sides[peer],
                    note=f"{note}; view '{view}'",
                )
                for view, sides in measured.items()
            ]
            found.append(max(of_views, key=lambda row: row.ratio or 0))
    return found


def rounds(file: Path, view: str, sides: list[str]) -> Times:
    """Milliseconds of each image of each side."""
    times: Times = {side: [] for side in sides}
    for _ in range(ROUNDS):
        for side, values in times.items():
            values += one(side, file, view)
    return times


def one(side: str, file: Path, view: str) -> list[float]:
    """In a process of its own, which has one core and draws with one thread."""
    said = subprocess.run(
        [*on_one_core(), sys.executable, HERE / "render_side.py", side, file, view],
        env={**os.environ, "LP_NUM_THREADS": "1", "MUJOCO_GL": "egl"},
        capture_output=True,
        text=True,
        check=False,
    )
    if said.returncode != 0:
        raise RuntimeError(f"{side} failed:\n{said.stderr}")
    values: list[float] = json.loads(said.stdout.splitlines()[-1])
    return values
