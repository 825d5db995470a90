"""Runs one of our google-benchmark programs on every robot and reads a counter of its rows."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from pathlib import Path

from robots import robot_files

ROOT = Path(__file__).resolve().parents[1]
REPETITIONS = 9


def microseconds(program: str, counter: str, folder: Path) -> dict[str, dict[str, list[float]]]:
    """Robot -> side -> the counter (seconds) of every repetition, in microseconds."""
    result = folder / f"{program}.json"
    subprocess.run(
        [
            *("taskset", "--cpu-list", "0"),
            ROOT / "build" / "release" / program,
            f"--benchmark_repetitions={REPETITIONS}",
            "--benchmark_enable_random_interleaving=true",
            f"--benchmark_out={result}",
            "--benchmark_out_format=json",
            *robot_files(),
        ],
        stdout=subprocess.DEVNULL,
        check=True,
    )
    values: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for run in json.loads(result.read_text())["benchmarks"]:
        if run.get("error_occurred"):
            raise RuntimeError(f"{run['name']}: {run['error_message']}")
        if run["run_type"] == "iteration":
            robot, side = run["run_name"].split("/")[:2]
            values[robot][side].append(1e6 * run[counter])
    return values
