"""P14: writing a dataset beside encoding its images, and beside LeRobot's writer.

What is timed: dataset_writer_bench.cc and, with the same frames, lerobot_writer_side.py.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from bench_program import PROGRAMS, ROOT, on_one_core, scaled, seconds
from lerobot_peer import peer_python
from robots import robot_files
from table import Row

PEERS = {
    "default": "LeRobot 0.4.4: PNG files, then AV1",
    "streaming": "LeRobot's streaming, H.264",
}
REPETITIONS = 7
PEER_REPETITIONS = 5


def rows(folder: Path, repetitions: int = REPETITIONS) -> list[Row]:
    """Three rows per robot, whose images are encoded; those of LeRobot where it installs."""
    files = {file.stem: file for file in robot_files()}
    sides = seconds("dataset_writer_bench", list(files.values()), folder, repetitions=repetitions)
    python = peer_python(folder)
    result = []
    for robot, side in sides.items():
        peers = {"the bare encoders with the same frames": side["ffmpeg"]}
        if python:
            peers |= lerobot(python, files[robot], folder, min(repetitions, PEER_REPETITIONS))
        for peer, values in peers.items():
            result.append(
                Row(
                    f"an image and its share of the rows, written, {robot}",
                    "ms",
                    scaled(side["writer"], 1e3),
                    scaled(values, 1e3),
                    note=f"two cameras 640x480; peer: {peer}",
                )
            )
    return result


def lerobot(
    python: Path, robot_file: Path, folder: Path, repetitions: int
) -> dict[str, list[float]]:
    """Seconds for each image that LeRobot's writer is given, by the peer's name."""
    frames = folder / "frames.rgb"
    said = run([PROGRAMS / "dataset_writer_bench", "--frames", frames, robot_file])
    shape = said.split()  # rows, cameras, width, height
    found = {}
    for mode, peer in PEERS.items():
        side = Path(__file__).with_name("lerobot_writer_side.py")
        options: list[str | Path] = [*shape, str(repetitions), mode, folder / "lerobot_peer"]
        said = run([*on_one_core(), python, "-I", side, frames, *options])
        result = json.loads(said.splitlines()[-1])
        if missing := result["missing"]:
            given = repetitions * int(shape[0]) * int(shape[1])
            peer += f", which dropped {missing} of {given} frames"
        found[peer] = result["seconds"]
    frames.unlink()
    return found


def run(command: list[str | Path]) -> str:
    """What a command prints."""
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed:\n{done.stderr[-2000:]}")
    return done.stdout
