"""Run the benchmarks and print their tables: run.py [--record] [--only NAME ...] [--judge].

Method: benchmarks/README.md. Raw values go to build/bench/results.json.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import add_remove
import augment
import control_loop
import dataset_writer
import dynamics
import env_step
import episodes
import evaluation_rate
import export_lerobot
import graphics_card
import houses
import ik
import motion
import overlap
import policy_round_trip
import read_frames
import render
import reset
import scene_again
from instruction_set import instruction_set, with_avx2
from record import record
from table import Row, markdown
from verdicts import summary

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "RESULTS.md"
BENCHMARKS: dict[str, Callable[[Path], list[Row]]] = {
    "control_loop": control_loop.rows,
    "dynamics": dynamics.rows,
    "reset": reset.rows,
    "env_step": env_step.rows,
    "dynamics_avx2": with_avx2(dynamics.rows),
    "ik": ik.rows,
    "ik_avx2": with_avx2(ik.rows),
    "add_remove": add_remove.rows,
    "scene_again": scene_again.rows,
    "dataset_writer": dataset_writer.rows,
    "read_frames": read_frames.rows,
    "render": render.rows,
    "overlap": overlap.rows,
    "episodes": episodes.rows,
    "augment": augment.rows,
    "houses": houses.rows,
    "graphics_card": graphics_card.rows,
    "policy_round_trip": policy_round_trip.rows,
    "motion": motion.rows,
    "evaluation_rate": evaluation_rate.rows,
    "export_lerobot": export_lerobot.rows,
}


def command_output(*command: str) -> str:
    """Standard output of a command, stripped; '' when it fails."""
    run = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    return run.stdout.strip()


def cpu_name() -> str:
    """The processor as the system names it."""
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def has_changes() -> bool:
    """Whether the files are others than those of the commit."""
    return bool(command_output("git", "status", "--porcelain"))


def circumstances(name: str, commit: str) -> str:
    """Machine, instruction set of the kernels, compiler and commit, one per line."""
    kernels = "AVX2" if name.endswith("_avx2") else instruction_set()
    return "\n".join(
        [
            f"- machine: {cpu_name()}, {os.cpu_count()} cores seen, {platform.system()}",
            f"- instruction set: {kernels}",
            f"- compiler: {command_output('c++', '--version').splitlines()[0]}",
            f"- commit: {commit}",
            f"- date: {datetime.now(UTC):%Y-%m-%d}",
        ]
    )


def main() -> None:
    """Run what was asked for, print the table and keep the values."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--record", action="store_true", help="write what ran to RESULTS.md")
    parser.add_argument("--only", nargs="+", choices=sorted(BENCHMARKS), help="only these")
    parser.add_argument(
        "--judge", action="store_true", help="only write RESULTS.md's verdicts anew"
    )
    options = parser.parse_args()
    if options.judge:
        record(RESULTS, {}, BENCHMARKS, summary)
        return

    commit = command_output("git", "rev-parse", "--short", "HEAD")
    if has_changes():
        if options.record:
            parser.error("files differ from the commit that would be recorded: commit them first")
        commit += " with changes"
    folder = ROOT / "build" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    values: list[dict[str, Any]] = []
    for name, run in BENCHMARKS.items():
        if options.only and name not in options.only:
            continue
        print(f"running {name} ...", flush=True)
        rows = run(folder)
        if not rows:
            print(f"left out: {name}: nothing can be measured on this machine")
            continue
        values += [row.to_json() for row in rows]
        (folder / "results.json").write_text(json.dumps(values, indent=1))
        text = f"{circumstances(name, commit)}\n\n{markdown(rows)}"
        print(f"\n{text}", flush=True)
        if options.record:  # at once: what comes later may fail
            record(RESULTS, {name: text}, BENCHMARKS, summary)


if __name__ == "__main__":
    main()
