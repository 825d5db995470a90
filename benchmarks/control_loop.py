"""P7: the control loop beside the bare engine. What is timed: control_loop_bench.cc."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from pathlib import Path

from robots import robot_files
from table import Row

ROOT = Path(__file__).resolve().parents[1]
REPETITIONS = 9


def rows(folder: Path) -> list[Row]:
    """One row per robot."""
    result = folder / "control_loop.json"
    subprocess.run(
        [
            *("taskset", "--cpu-list", "0"),
            ROOT / "build" / "release" / "control_loop_bench",
            f"--benchmark_repetitions={REPETITIONS}",
            "--benchmark_enable_random_interleaving=true",
            f"--benchmark_out={result}",
            "--benchmark_out_format=json",
            *robot_files(),
        ],
        stdout=subprocess.DEVNULL,
        check=True,
    )
    ticks: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for run in json.loads(result.read_text())["benchmarks"]:
        if run.get("error_occurred"):
            raise RuntimeError(f"{run['name']}: {run['error_message']}")
        if run["run_type"] == "iteration":
            robot, side = run["run_name"].split("/")[:2]
            ticks[robot][side].append(1e6 * run["tick_s"])
    return [
        Row(
            f"control tick, joint position, {robot}",
            "µs",
            sides["update+step"],
            sides["mj_step"],
            note="peer: `mj_step` with the same controls",
        )
        for robot, sides in ticks.items()
    ]
