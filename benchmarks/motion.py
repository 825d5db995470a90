"""P15: collision-aware planning over five arms and eight kinds of scenes. motion_bench.cc plans."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from bench_program import CORE, PROGRAMS
from robots import arm_files
from table import Row

PROBLEMS = 50  # of each arm and kind of scene
REPETITIONS = 3


def rows(folder: Path) -> list[Row]:
    """Milliseconds of a plan: the median of each repetition, and the 99th percentile."""
    runs = [measured(arm_files()) for _ in range(REPETITIONS)]
    found = []
    for number, first in enumerate(runs[0]):
        each = [run[number] for run in runs]
        what = f"{first['family']}, {Path(first['robot']).stem}"
        note = (
            f"solved {first['solved']} of {first['problems']}, {first['straight']} of them "
            f"straight; {first['collisions']} nearer than 1 mm at the check"
        )
        for name, key in (("median", "p50"), ("99th percentile", "p99")):
            found.append(Row(f"plan, {name}, {what}", "ms", [run[key] for run in each], note=note))
    return found


def measured(files: list[Path]) -> list[dict[str, Any]]:
    """What the program prints, on one core."""
    program = str(PROGRAMS / "motion_bench")
    command = ["taskset", "-c", str(CORE), program, str(PROBLEMS), *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]
