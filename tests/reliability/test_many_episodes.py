"""Commands on a dataset of many small episodes stay within their memory."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from many_episodes import cost_of, jobs, make_many

import robocell

MOST_MB = 500
FEW, MANY = 40, 20_000


@pytest.mark.proof
def test_copies_of_an_episode_are_a_dataset(tmp_path: Path):
    make_many(tmp_path / "many", FEW)
    assert robocell.data.verify(tmp_path / "many").ok
    assert len(robocell.Dataset(tmp_path / "many")) == FEW


@pytest.mark.soak
def test_commands_on_many_episodes_take_little_memory(tmp_path: Path):
    make_many(tmp_path / "many", MANY)
    for name, command in jobs(tmp_path).items():
        cost = cost_of(command)
        assert cost.code == 0, name
        assert cost.megabytes < MOST_MB, f"{name} took {cost.megabytes:.0f} MB"
    shutil.rmtree(tmp_path)
