"""P12: making episodes beside their stages one after the other. What is timed: overlap_bench.cc."""

from __future__ import annotations

from pathlib import Path

from bench_program import ROOT, scaled, seconds
from table import Row

STAGES = ("acting", "images", "encoding")


def rows(folder: Path) -> list[Row]:
    """Beside the sum of the stages, and beside the slowest one."""
    result = []
    runs = [ROOT / "examples" / "demo.yaml"]
    programs = seconds("overlap_bench", runs, folder, repetitions=5, one_core=False)
    for robot, sides in programs.items():
        made = scaled(sides["made"], 1e3)
        stages = {stage: scaled(sides[stage], 1e3) for stage in STAGES}
        slowest = max(STAGES, key=lambda stage: min(stages[stage]))
        serial = [sum(times) for times in zip(*stages.values(), strict=True)]
        for peer, what in (
            (serial, f"{', '.join(STAGES)} one after the other"),
            (stages[slowest], f"the slowest stage alone: {slowest}"),
        ):
            name = f"an image of an episode, {robot}"
            note = f"two cameras 640x480, one worker, all cores; peer: {what}"
            result.append(Row(name, "ms", made, peer, note=note))
    return result
