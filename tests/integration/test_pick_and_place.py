"""Runs of pick_and_place: the example, what a run file may say, the expert as a base class."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from commands import ROOT, generate, refusal

import robocell as rc
from robocell.evaluate import evaluate

EXAMPLE = ROOT / "examples" / "pick_and_place.yaml"
RC7 = ROOT / "models" / "robots" / "rc7" / "rc7.yaml"


def run_file(folder: Path, task: str) -> Path:
    text = EXAMPLE.read_text().replace("../models/robots/rc7/rc7.yaml", str(RC7))
    lines = [line for line in text.splitlines() if not line.startswith("start:")]
    lines = [f"task: {task}" if line.startswith("task:") else line for line in lines]
    # Without the block of the cameras.
    lines = [line for line in lines if not line.startswith(("cameras:", "  "))]
    file = folder / "place.yaml"
    file.write_text("\n".join(lines) + "\n")
    return file


@pytest.mark.parametrize("episodes", [2, pytest.param(6, marks=pytest.mark.proof)])
def test_the_example_puts_objects_on_the_tray(episodes: int, tmp_path: Path):
    words = ("--set", "cameras.streams=[]", "--episodes", episodes)
    generate(EXAMPLE, tmp_path / "two", "--workers", 2, *words)
    generate(EXAMPLE, tmp_path / "one", "--workers", 1, *words)
    made = rc.Dataset(tmp_path / "two")
    assert len(made) == episodes
    for episode in made:
        assert episode.success
        kind, goal = episode.metadata["object_kinds"][:2]
        assert goal == "tray"
        assert episode.metadata["instruction"] == f"pick up the {kind} and put it on the tray"
        target = episode["objects/target/pose"][-1][:3]
        tray = episode["objects/goal/pose"][-1][:3]
        assert np.linalg.norm((target - tray)[:2]) < 0.03
        assert rc.data.verify_replay(episode).ok
    for file in sorted((tmp_path / "two").glob("s*/steps.h5")):
        assert file.read_bytes() == (tmp_path / "one" / file.parent.name / file.name).read_bytes()


@pytest.mark.parametrize(
    ("task", "message"),
    [
        ("{kind: pick_and_place, goals: [try]}", "Did you mean 'tray'?"),
        ("{kind: pick_and_place, objects: [bok]}", "Did you mean 'box'?"),
        ("{kind: pick_and_place, goal_object: mat}", "task.goal_object: no object 'mat'"),
        ("{kind: pick_and_place, goal: [0, 0, 0], goals: [tray]}", "leave one of them out"),
        ("{kind: pick_and_place, goal_tolerance: 0}", "task.goal_tolerance"),
        ("{kind: pick_and_place}\nstart: {base_distance: [3, 4]}", "goes beyond"),
    ],
)
def test_rejects_impossible_tasks_before_the_first_episode(tmp_path: Path, task: str, message: str):
    assert message in refusal("generate", run_file(tmp_path, task), "--output", tmp_path / "out")


class Counting(rc.tasks.PickAndPlacePlanner):
    """The built-in expert, counting its actions."""

    actions = 0

    def act(self, scene, rng):
        Counting.actions += 1
        return super().act(scene, rng)


def test_the_expert_can_be_subclassed(tmp_path: Path):
    run = rc.RunConfig.load(
        run_file(
            tmp_path, "{kind: pick_and_place, objects: [box]}\nstart: {base_height_offset: -0.25}"
        )
    )
    run.output = str(tmp_path / "out")
    run.episodes_per_scene = 1
    rc.generate.prepare_dataset(run)
    result = rc.generate.Runner(run, expert=Counting).run(rc.generate.make_plan(run)[0])
    assert result.success
    assert Counting.actions >= len(rc.Dataset(run.output)[0]["phase"])


@pytest.mark.proof  # other tasks are evaluated in test_evaluate.py
def test_the_task_is_evaluated_like_any_other(tmp_path: Path):
    words = ("--set", "cameras.streams=[]", "--episodes", 2, "--workers", 1)
    generate(EXAMPLE, tmp_path / "out", *words)
    result = evaluate(tmp_path / "out", "expert", episodes=2, output=tmp_path / "trials")
    assert result.successes == 2
