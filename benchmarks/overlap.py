"""P12: making episodes beside their stages one after the other, and beside a Python pipeline.

What is timed: overlap_bench.cc and serial_pipeline.py.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from bench_program import ROOT, scaled, seconds
from episodes import environment
from table import Row

DEMO = ROOT / "examples" / "demo.yaml"

STAGES = ("acting", "images", "encoding")


def rows(folder: Path) -> list[Row]:
    """Beside the sum of the stages, beside the slowest one, and beside a Python pipeline."""
    result = []
    programs = seconds("overlap_bench", [DEMO], folder, repetitions=5, one_core=False)
    python_pipeline = pipeline(folder)
    for robot, sides in programs.items():
        made = scaled(sides["made"], 1e3)
        stages = {stage: scaled(sides[stage], 1e3) for stage in STAGES}
        slowest = max(STAGES, key=lambda stage: min(stages[stage]))
        serial = [sum(times) for times in zip(*stages.values(), strict=True)]
        for peer, what in (
            (serial, f"{', '.join(STAGES)} one after the other"),
            (stages[slowest], f"the slowest stage alone: {slowest}"),
            (python_pipeline, "a Python pipeline, `mujoco.Renderer`, default"),
        ):
            name = f"an image of an episode, {robot}"
            note = f"two cameras 640x480, one worker, all cores; peer: {what}"
            result.append(Row(name, "ms", made, peer, note=note))
    return result


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
