"""P10: an object comes or goes, beside mj_recompile. What is timed: add_remove_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import scaled, seconds
from robots import robot_files
from table import Row


def rows(folder: Path) -> list[Row]:
    """Two rows per robot."""
    result = []
    for robot, sides in seconds("add_remove_bench", robot_files(), folder).items():
        for side, name in (("pool", "pool"), ("rebuild", "compiling")):
            result.append(
                Row(
                    f"object added or removed by {name}, {robot}",
                    "µs",
                    scaled(sides[side], 1e6),
                    scaled(sides["mj_recompile"], 1e6),
                    note="peer: `mj_recompile` of the same scene",
                )
            )
    return result
