"""Pick episodes per hour on one worker, without and with cameras: all of `robocell generate`."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from table import Row

ROOT = Path(__file__).resolve().parents[1]
RUN = ROOT / "examples" / "demo.yaml"
REPETITIONS = 5
WITHOUT_CAMERAS = ["--set", "cameras.streams=[]"]


def rows(folder: Path) -> list[Row]:
    """Without and with the demo's two cameras."""
    variants = {
        "without cameras": [*WITHOUT_CAMERAS, "--episodes", "100"],
        "with two cameras 320x240": ["--episodes", "10"],
    }
    values: dict[str, list[float]] = {name: [] for name in variants}
    for repetition in range(REPETITIONS):
        for name, options in variants.items():
            values[name].append(episodes_per_hour(folder / "episodes", repetition, options))
    return [
        Row(
            f"pick episodes, rc7, {name}",
            "1/h",
            rates,
            better="higher",
            note="one worker, one core, start-up included",
        )
        for name, rates in values.items()
    ]


def environment(byte_code: Path) -> dict[str, str]:
    """Variables of the command: it keeps byte code, as a package does, whatever the shell says.

    Without it each of the command's processes would compile all modules first.
    """
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"PYTHONPATH": str(ROOT / "python"), "PYTHONPYCACHEPREFIX": str(byte_code)}


def episodes_per_hour(output: Path, seed: int, options: list[str]) -> float:
    """Successful episodes of the demo on the disk per hour of the whole command."""
    return episodes_of(RUN, output, seed, options)


def episodes_of(run_file: Path, output: Path, seed: int, options: list[str]) -> float:
    """Successful episodes of a run on the disk per hour of the whole command."""
    shutil.rmtree(output, ignore_errors=True)
    command = [sys.executable, "-m", "robocell", "generate", str(run_file), "--workers", "1"]
    command += ["--output", str(output), "--seed", str(seed), "--progress", "jsonl", *options]
    run = subprocess.run(
        ["taskset", "--cpu-list", "0", *command],
        capture_output=True,
        text=True,
        env=environment(output.with_name("byte_code")),
        check=False,
    )
    if run.returncode:
        raise RuntimeError(f"{' '.join(command)} failed:\n{run.stderr}")
    events = [json.loads(line) for line in run.stdout.splitlines()]
    totals = events[-1]["totals"]
    on_disk = len(list(output.glob("*/episode.json")))
    if on_disk != totals["made"]:
        raise RuntimeError(f"{totals['made']} episodes reported, {on_disk} on the disk")
    return float(totals["per_hour"])
