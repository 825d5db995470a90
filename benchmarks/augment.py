"""P19: kept episodes per hour of `robocell augment`, and its yield, on two workers without cameras.

The sources are a few episodes of the scripted expert; making them is not counted.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

from episodes import ROOT, environment
from table import Row

REPETITIONS = 5
SOURCES = 10
EPISODES = 200
TASKS = {
    "stack": [str(ROOT / "examples" / "tasks" / "stack.yaml"), "--set", "task.cubes=2"],
    "open": [
        str(ROOT / "examples" / "tasks" / "open.yaml"),
        *("--set", "task.objects=[drawer_unit]"),
    ],
}


def rows(folder: Path) -> list[Row]:
    """Rate and yield of two cubes that are stacked, and of a drawer that is opened."""
    table: list[Row] = []
    for name, options in TASKS.items():
        source = folder / "augment" / f"{name}_source"
        shutil.rmtree(source, ignore_errors=True)
        _robocell(
            folder,
            *("generate", *options, "--set", "cameras.streams=[]"),
            *("--episodes", str(SOURCES), "--output", str(source)),
        )
        ends = [_augment(folder, name, source, seed) for seed in range(REPETITIONS)]
        rates = [end["made"] / end["elapsed_s"] * 3600 for end in ends]
        yields = [100 * end["success_rate"] for end in ends]
        note = f"{SOURCES} source episodes, two workers, start-up included"
        table.append(
            Row(f"augmented {name} episodes, rc7", "1/h", rates, better="higher", note=note)
        )
        table.append(
            Row(f"yield of augmented {name}, rc7", "%", yields, better="higher", note=note)
        )
    return table


def _augment(folder: Path, name: str, source: Path, seed: int) -> dict[str, float]:
    """Returns the totals of one command."""
    output = folder / "augment" / f"{name}_made"
    shutil.rmtree(output, ignore_errors=True)
    lines = _robocell(
        folder,
        *("augment", str(source), "--episodes", str(EPISODES), "--output", str(output)),
        *("--workers", "2", "--seed", str(1000 + seed), "--progress", "jsonl"),
    )
    events = [json.loads(line) for line in lines.splitlines()]
    totals: dict[str, float] = events[-1]["totals"]
    return totals


def _robocell(folder: Path, *arguments: str) -> str:
    """Returns the output of a command."""
    run = subprocess.run(
        [sys.executable, "-m", "robocell", *arguments],
        capture_output=True,
        text=True,
        env=environment(folder / "byte_code"),
        check=False,
    )
    if run.returncode:
        sys.exit(f"robocell {' '.join(arguments)} failed:\n{run.stderr}")
    return run.stdout
