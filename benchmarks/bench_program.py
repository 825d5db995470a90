"""Runs one of our google-benchmark programs and reads its rows."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def seconds(
    program: str | Path,
    files: Sequence[Path],
    folder: Path,
    *,
    repetitions: int = 9,
    processes: int = 1,
    one_core: bool = True,
) -> dict[str, dict[str, list[float]]]:
    """Row -> side -> seconds of each repetition, of one of what the program counts.

    A program is one of build/release, or has a path of its own. In several processes, one after
    the other, stacks and heaps lie elsewhere each time, which moves what takes a few microseconds
    by a few percent.
    """
    values: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for _ in range(processes):
        for row, side, each in _run(program, files, folder, repetitions, one_core):
            values[row][side].append(each)
    return values


def _run(
    program: str | Path, files: Sequence[Path], folder: Path, repetitions: int, one_core: bool
) -> Iterator[tuple[str, str, float]]:
    """Row, side and seconds of each repetition in one process."""
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
    for measured in json.loads(result.read_text())["benchmarks"]:
        if measured.get("error_occurred"):
            raise RuntimeError(f"{measured['name']}: {measured['error_message']}")
        if measured["run_type"] == "iteration":
            row, side = measured["run_name"].split("/")[:2]
            yield row, side, measured["each_s"]


def scaled(values: Sequence[float], factor: float) -> list[float]:
    """In another unit."""
    return [factor * value for value in values]
