"""Runs one of our google-benchmark programs and reads its rows."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def seconds(
    program: str,
    files: Sequence[Path],
    folder: Path,
    *,
    repetitions: int = 9,
    one_core: bool = True,
) -> dict[str, dict[str, list[float]]]:
    """Row -> side -> seconds of each repetition, of one of what the program counts."""
    result = folder / f"{program}.json"
    subprocess.run(
        [
            *(("taskset", "--cpu-list", "0") if one_core else ()),
            ROOT / "build" / "release" / program,
            f"--benchmark_repetitions={repetitions}",
            "--benchmark_enable_random_interleaving=true",
            f"--benchmark_out={result}",
            "--benchmark_out_format=json",
            *files,
        ],
        stdout=subprocess.DEVNULL,
        check=True,
        cwd=ROOT,
    )
    values: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for run in json.loads(result.read_text())["benchmarks"]:
        if run.get("error_occurred"):
            raise RuntimeError(f"{run['name']}: {run['error_message']}")
        if run["run_type"] == "iteration":
            row, side = run["run_name"].split("/")[:2]
            values[row][side].append(run["each_s"])
    return values


def scaled(values: Sequence[float], factor: float) -> list[float]:
    """In another unit."""
    return [factor * value for value in values]
