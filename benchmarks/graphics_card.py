"""P21: images on a graphics card, in one process and in many. Needs a card that draws.

What is timed: graphics_card_side.py. Processes on one card draw each for itself, or all with the
drawing service (ROBOCELL_GL_SERVICE=1).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from episodes import environment
from robots import arm_files
from table import Row

HERE = Path(__file__).resolve().parent
DEMO = HERE.parent / "examples" / "demo.yaml"
ARMS = ("rc7", "xarm7")
REPETITIONS = 5
PROCESSES = (1, 4, 16)
SECONDS = 3.0  # of a measurement of many processes
MODES = {"each for itself": "0", "drawing service": "1"}


def rows(folder: Path) -> list[Row]:
    """Nothing where software draws."""
    if reason := why_no_card():
        print(f"left out: graphics_card: {reason}", flush=True)
        return []
    found = []
    for file in arm_files():
        if file.stem in ARMS:
            found += [alone(file), *(together(file, n, mode) for n in PROCESSES for mode in MODES)]
    return found + [demo(folder, mode) for mode in MODES]


def why_no_card() -> str:
    """Why no graphics card draws in this environment; "" where one does."""
    import robocell as rc

    try:
        description = rc.diagnose.describe_gl()
    except rc.Error as error:
        return f"no OpenGL: {error}"
    if any(software in description for software in ("llvmpipe", "softpipe", "swrast")):
        return f"software draws, not a graphics card: {description}"
    return ""


def alone(file: Path) -> Row:
    """One process, both sides in turns; `mujoco.Renderer` with the same effects."""
    sides: dict[str, list[float]] = {"gl": [], "mujoco_off": []}
    for _ in range(REPETITIONS):
        for side, values in sides.items():
            values.append(1e3 / finish([start(side, file)])[0])
    note = "640x480, colour; peer: `mujoco.Renderer`, effects off"
    return Row(f"image of `gl`, {file.stem}", "ms", sides["gl"], sides["mujoco_off"], note=note)


def together(file: Path, processes: int, mode: str) -> Row:
    """Images a second of all."""
    rates = []
    for _ in range(REPETITIONS):
        sides = [start("gl", file, ROBOCELL_GL_SERVICE=MODES[mode]) for _ in range(processes)]
        rates.append(sum(finish(sides)))
    name = f"images of {processes} processes, {mode}, {file.stem}"
    return Row(name, "1/s", rates, better="higher", note="640x480, colour, on one card")


def demo(folder: Path, mode: str) -> Row:
    """Episodes an hour of the demo drawn with `gl`, start-up included."""
    rates = []
    for seed in range(REPETITIONS):
        options = ["--workers", "16", "--episodes", "320", "--seed", str(seed)]
        options += [
            "--set",
            "cameras.renderer.backend=gl",
            "--set",
            "cameras.renderer.quality=fast",
        ]
        output = folder / f"card_{MODES[mode]}_{seed}"
        command: list[str | Path] = [
            sys.executable,
            "-m",
            "robocell",
            "generate",
            DEMO,
            "--output",
            output,
        ]
        done = subprocess.run(
            [*command, "--progress", "jsonl", *options],
            env=environment(folder / "byte_code") | {"ROBOCELL_GL_SERVICE": MODES[mode]},
            capture_output=True,
            text=True,
            check=True,
        )
        rates.append(float(json.loads(done.stdout.splitlines()[-1])["totals"]["per_hour"]))
    name = f"demo episodes, 16 workers, {mode}, rc7"
    return Row(name, "1/h", rates, better="higher", note="two cameras 320x240, start-up included")


def start(side: str, file: Path, **variables: str) -> subprocess.Popen[str]:
    """A process that has drawn its first images and waits."""
    return subprocess.Popen(
        [sys.executable, HERE / "graphics_card_side.py", side, file],
        env={**os.environ, "MUJOCO_GL": "egl", **variables},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def finish(processes: list[subprocess.Popen[str]]) -> list[float]:
    """Lets all draw at the same time; images a second of each."""
    for process in processes:
        assert process.stdout is not None
        if process.stdout.readline() != "ready\n":
            raise RuntimeError("a side did not begin")
    begin = time.time() + 0.2
    said = []
    for process in processes:
        assert process.stdin is not None
        process.stdin.write(f"{begin} {begin + SECONDS}\n")
        process.stdin.flush()
    for process in processes:
        out, _ = process.communicate()
        if process.returncode:
            raise RuntimeError("a side failed")
        said.append(float(out))
    return said
