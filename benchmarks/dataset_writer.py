"""P14: writing a dataset beside encoding its images. What is timed: dataset_writer_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import scaled, seconds
from robots import robot_files
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot, whose images are encoded."""
    sides = seconds("dataset_writer_bench", robot_files(), folder, repetitions=7)
    return [
        Row(
            f"an image and its share of the rows, written, {robot}",
            "ms",
            scaled(side["writer"], 1e3),
            scaled(side["ffmpeg"], 1e3),
            note="two cameras 640x480; peer: the bare encoders with the same frames",
        )
        for robot, side in sides.items()
    ]
