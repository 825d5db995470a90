"""A small dataset for tests of the report's page: picks, some of which run out of actions."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import RUN, robocell_command, write_run
from made_once import made_once

MOST_STEPS = 26  # four of the six picks need fewer


def _make(folder: Path) -> None:
    rates = {**RUN["rates"], "max_steps": MOST_STEPS}  # type: ignore[dict-item]
    changes = {"rates": rates, "episodes_per_scene": 6, "max_attempts": 1}
    run = write_run(folder, keep="all", **changes)
    result = robocell_command("generate", run, "--progress", "jsonl")
    assert result.returncode in (0, 1), result.stderr


def mixed_dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six episodes with successes and failures; no test may change it."""
    return made_once(tmp_path_factory, "report_page", _make) / "out"
