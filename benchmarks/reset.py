"""P9: reset to a randomised state beside one mj_forward. What is timed: reset_bench.cc."""

from __future__ import annotations

from pathlib import Path

from robot_bench import microseconds
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot."""
    resets = microseconds("reset_bench", "reset_s", folder)
    return [
        Row(
            f"reset with noise, {robot}",
            "µs",
            sides["reset"],
            sides["mj_forward"],
            note="peer: one `mj_forward` on the same scene",
        )
        for robot, sides in resets.items()
    ]
