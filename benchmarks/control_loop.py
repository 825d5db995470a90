"""P7: the control loop beside the bare engine. What is timed: control_loop_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import scaled, seconds
from robots import robot_files
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot and kind of control."""
    return [
        Row(
            f"control tick, {control}",
            "µs",
            scaled(sides["update+step"], 1e6),
            scaled(sides["mj_step"], 1e6),
            note="peer: `mj_step` with the same controls",
        )
        for control, sides in seconds("control_loop_bench", robot_files(), folder).items()
    ]
