"""P12: making episodes beside their stages one after the other, and beside a Python pipeline.

What is timed: overlap_bench.cc and serial_pipeline.py.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from bench_program import ROOT, scaled, seconds
from episodes import environment
from table import Row

DEMO = ROOT / "examples" / "demo.yaml"

STAGES = ("acting", "images", "encoding")
PLAIN, GL_IMAGES = "without effects", "images by gl"
# At that commit `gl` drew without effects, one image after the other, on the thread that acted.
# Today's code acts and draws so, which is faster than that commit was; encoding is not counted.
EARLIER = "commit 8206dcb as today's code does its work: acting, then images by `gl`"


def rows(folder: Path, repetitions: int = 5) -> list[Row]:
    """Beside the sum of the stages, the slowest one, a Python pipeline and an earlier robocell."""
    result = []
    programs = seconds("overlap_bench", [DEMO], folder, repetitions=repetitions, one_core=False)
    python_pipeline = pipeline(folder)
    for robot, sides in programs.items():
        times = {side: scaled(values, 1e3) for side, values in sides.items()}
        slowest = max(STAGES, key=lambda stage: min(times[stage]))
        peers = [
            (
                "made",
                one_after_the_other(times, STAGES),
                f"{', '.join(STAGES)} one after the other",
            ),
            ("made", times[slowest], f"the slowest stage alone: {slowest}"),
            ("made", python_pipeline, "a Python pipeline, `mujoco.Renderer`, default"),
        ]
        if GL_IMAGES in times:
            before = one_after_the_other(times, ("acting", GL_IMAGES))
            peers.append((f"made {PLAIN}", before, EARLIER))
        for side, peer, what in peers:
            effects = f" {PLAIN}" if PLAIN in side else ""
            name = f"an image of an episode{effects}, {robot}"
            note = f"two cameras 640x480, one worker, all cores; peer: {what}"
            result.append(Row(name, "ms", times[side], peer, note=note))
    return result


def one_after_the_other(times: dict[str, list[float]], stages: Sequence[str]) -> list[float]:
    """The sum of stages, repetition by repetition."""
    return [sum(each) for each in zip(*(times[stage] for stage in stages), strict=True)]


def pipeline(folder: Path) -> list[float]:
    """Milliseconds of an image of serial_pipeline.py, in each of five episodes like the demo's."""
    dataset, processes = folder / "pipeline", environment(folder / "byte_code")
    commands: list[list[str | Path]] = [
        ["-m", "robocell", "generate", DEMO, "--output", dataset, "--episodes", "5"],
        [Path(__file__).with_name("serial_pipeline.py"), dataset],
    ]
    for command in commands:
        run = subprocess.run(
            [sys.executable, *command],
            capture_output=True,
            text=True,
            env={**processes, "MUJOCO_GL": os.environ.get("MUJOCO_GL", "egl")},
            check=False,
        )
        if run.returncode:
            raise RuntimeError(f"{command[0]} failed:\n{run.stderr}")
    values: list[float] = json.loads(run.stdout.splitlines()[-1])
    return values
