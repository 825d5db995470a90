"""P6: Jacobian, gravity torques and mass matrix beside KDL. What is timed: dynamics_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import scaled, seconds
from robots import robot_files
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot and quantity, one configuration at a time and as a batch."""
    return [
        Row(
            what,
            "ns",
            scaled(sides["robocell"], 1e9),
            scaled(sides["KDL"], 1e9),
            note="a configuration; peer: KDL, one at a time",
        )
        for what, sides in seconds("dynamics_bench", robot_files(), folder).items()
    ]
