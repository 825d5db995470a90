"""P7: the control loop beside the bare engine. What is timed: control_loop_bench.cc."""

from __future__ import annotations

from pathlib import Path

from robot_bench import microseconds
from table import Row


def rows(folder: Path) -> list[Row]:
    """One row per robot."""
    ticks = microseconds("control_loop_bench", "tick_s", folder)
    return [
        Row(
            f"control tick, joint position, {robot}",
            "µs",
            sides["update+step"],
            sides["mj_step"],
            note="peer: `mj_step` with the same controls",
        )
        for robot, sides in ticks.items()
    ]
