"""`robocell augment`: episodes of a small dataset, moved to new starts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from command_line import RUN, refused, robocell_command, write_run
from made_once import made_once
from robocell.data import ColumnSpec, EpisodeWriter

PICKS = {"cameras": {**RUN["cameras"], "streams": []}, "task": {"kind": "pick", "objects": ["box"]}}
# What a dataset of another system may have, or a mapping file may name so.
COLUMNS = ("robots/rc7/base_pose", "robots/rc7/tcp_pose", "objects/target/pose")


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two picks of boxes, with their run file beside them."""

    def make(folder: Path) -> None:
        write_run(folder, **PICKS)
        made(rc.RunConfig.load(folder / "run.yaml", [f"output={folder / 'out'}"]))

    return made_once(tmp_path_factory, "augment_source", make) / "out"


def made(run: rc.RunConfig) -> list[rc.generate.ItemResult]:
    """Makes all episodes of a run in this process."""
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    return [runner.run(item) for item in rc.generate.make_plan(run)]


def rows_of(dataset: Path) -> dict[str, bytes]:
    """The time series of the episodes; their specs name the robot as the source has it."""
    return {file.parent.name: file.read_bytes() for file in dataset.glob("*/steps.h5")}


def provenance(episode: rc.data.Episode) -> dict[str, Any]:
    """What an episode says of its source."""
    results: Any = episode.results
    made_from: dict[str, Any] = results["augmented"]
    return made_from


def augment(dataset: Path, *options: object) -> dict[str, Any]:
    """The totals of a command that must succeed."""
    result = robocell_command("augment", dataset, "--progress", "jsonl", *options)
    assert result.returncode == 0, result.stderr
    totals: dict[str, Any] = json.loads(result.stdout.splitlines()[-1])["totals"]
    return totals


def test_episodes_are_those_of_any_number_of_workers_and_resumed(source: Path, tmp_path: Path):
    out = tmp_path / "out"
    totals = augment(source, "-n", 2, "-o", out, "--workers", 2)
    assert totals["made"] == 2
    assert augment(source, "-n", 3, "-o", out)["already"] == 2
    run = rc.RunConfig.load(source.parent / "run.yaml", [f"output={tmp_path / 'alone'}"])
    run.augment = rc.generate.AugmentConfig(dataset=str(source))
    run.seed += 1
    run.episodes = 3
    made(run)
    steps = [rows_of(folder) for folder in (out, tmp_path / "alone")]
    assert len(steps[0]) == 3
    assert steps[0] == steps[1]
    assert rc.data.verify(out).ok
    for episode in rc.Dataset(out):
        assert episode.success
        assert rc.data.verify_replay(episode).ok
        assert provenance(episode)["source"] in rc.Dataset(source).ids


def test_a_source_without_scene_phases_and_commands_needs_a_run_file(source: Path, tmp_path: Path):
    episode = rc.Dataset(source)[0]
    specs = {name: ColumnSpec(shape=7, units="m, 1") for name in COLUMNS}
    columns = {
        "time": ColumnSpec(units="s"),
        **specs,
        "robots/rc7/action/gripper": ColumnSpec(units="1", names=["opening"]),
    }
    with EpisodeWriter(tmp_path / "written", "shown", columns) as writer:
        for row in range(len(episode)):
            writer.add_row({name: np.asarray(episode[name])[row].squeeze() for name in columns})
        writer.commit(success=True)
    text = refused("augment", tmp_path / "written", "-n", 1)
    assert "--run RUN.yaml" in text
    out = tmp_path / "out"
    run = source.parent / "run.yaml"
    totals = augment(tmp_path / "written", "-n", 1, "-o", out, "--run", run, "--seed", 5)
    assert totals["made"] == 1
    results = provenance(rc.Dataset(out)[0])
    assert results["source"] == "shown"
    assert results["segments_from"] == "gripper"
    assert results["segments"][0]["reference"] == "target"


def test_mistakes_name_the_place_and_the_next_step(source: Path, tmp_path: Path):
    assert "is the source itself" in refused("augment", source, "-n", 1, "-o", source)
    run = source.parent / "run.yaml"
    assert "not a dataset" in refused("augment", run, "-n", 1)
    # Naming unknown episodes, and both an expert and a source.
    options = ("-o", tmp_path / "out", "-n", 1)
    text = refused("augment", source, *options, "--set", "augment.episodes=[s0000_e0009]")
    assert "s0000_e0009" in text
    assert "s0000_e0001" in text
    block = f"augment={{dataset: {source}}}"
    text = refused(
        "generate", run, "--output", tmp_path / "out", "--set", block, "--set", "expert=pick"
    )
    assert "leave out `expert`" in text
