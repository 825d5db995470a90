"""P9: reset to a randomised state beside one mj_forward. What is timed: reset_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import scaled, seconds
from robots import robot_files
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot."""
    return [
        Row(
            f"reset with noise, {robot}",
            "µs",
            scaled(sides["reset"], 1e6),
            scaled(sides["mj_forward"], 1e6),
            note="peer: one `mj_forward` on the same scene",
        )
        for robot, sides in seconds("reset_bench", robot_files(), folder).items()
    ]
