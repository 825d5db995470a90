"""Runs one of our google-benchmark programs and reads its rows."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def seconds(
    program: str | Path,
    files: Sequence[Path],
    folder: Path,
    *,
    repetitions: int = 9,
    one_core: bool = True,
) -> dict[str, dict[str, list[float]]]:
    """Row -> side -> seconds of each repetition, of one of what the program counts.

    A program is one of build/release, or has a path of its own.
    """
    result = folder / f"{Path(program).name}.json"
    run = subprocess.run(
        [
            *(("taskset", "--cpu-list", "0") if one_core else ()),
            ROOT / "build" / "release" / program,
            f"--benchmark_repetitions={repetitions}",
            "--benchmark_enable_random_interleaving=true",
            f"--benchmark_out={result}",
            "--benchmark_out_format=json",
            *files,
        ],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    if run.returncode:
        raise RuntimeError(f"{program} failed:\n{run.stdout}{run.stderr}")
    values: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for measured in json.loads(result.read_text())["benchmarks"]:
        if measured.get("error_occurred"):
            raise RuntimeError(f"{measured['name']}: {measured['error_message']}")
        if measured["run_type"] == "iteration":
            row, side = measured["run_name"].split("/")[:2]
            values[row][side].append(measured["each_s"])
    return values


def scaled(values: Sequence[float], factor: float) -> list[float]:
    """In another unit."""
    return [factor * value for value in values]
