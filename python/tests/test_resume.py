"""Which items of a plan are made already: counted on the disk."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from command_line import write_run
from robocell import RunConfig
from robocell._generation import resume
from robocell._generation.resume import DamagedEpisodesError, made_items, result_of
from robocell.generate import make_plan


def test_attempts_follow_their_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    run = RunConfig.load(write_run(tmp_path))
    item = make_plan(run)[0]
    monkeypatch.setattr(resume, "Episode", lambda folder: folder)
    for number in ("99", "100", "07"):
        folder = tmp_path / "out" / f"{item.id}_a{number}"
        folder.mkdir(parents=True)
        (folder / "episode.json").touch()
    assert resume._success_of(run, item) == tmp_path / "out" / f"{item.id}_a100"
    shutil.rmtree(tmp_path / "out")
    assert resume._success_of(run, item) == tmp_path / "out" / item.id


def test_broken_episodes_are_reported_and_not_counted(tmp_path: Path):
    run = RunConfig.load(write_run(tmp_path))
    out = tmp_path / "out"
    first, second = make_plan(run)
    (out / first.id).mkdir(parents=True)
    assert made_items(run, [first, second]) == set(), "an empty folder is no episode"
    (out / first.id / "steps.h5").write_bytes(b"half")
    (out / f".{second.id}.7.1.partial").mkdir()
    assert result_of(run, first) is None
    with pytest.raises(DamagedEpisodesError, match=f"{first.id}' is half an episode"):
        made_items(run, [first, second])
    assert made_items(run, [second]) == set()
