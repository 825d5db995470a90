"""P6: Jacobian, gravity torques and mass matrix beside KDL and the engine: dynamics_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import scaled, seconds
from robots import robot_files
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot, quantity and peer, one configuration at a time and as a batch."""
    return [
        Row(
            what,
            "ns",
            scaled(sides["robocell"], 1e9),
            scaled(sides[peer], 1e9),
            note=f"a configuration; peer: {peer}, one at a time",
        )
        for what, sides in seconds("dynamics_bench", robot_files(), folder).items()
        for peer in sides
        if peer != "robocell"
    ]
