"""Benchmarks: files with frozen starts, and what they refuse."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from robocell._core import sign_json

import robocell
from command_line import RC7, refused, robocell_command, write_run
from robocell import benchmark


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run, its benchmark of three starts, and the expert's rollouts."""
    folder = tmp_path_factory.mktemp("benchmark")
    robot = folder / "robot"
    shutil.copytree(RC7.parent, robot)
    write_run(folder, robot=f"robot/{RC7.name}", cameras={"streams": []})
    said = robocell_command("benchmark", folder / "run.yaml", folder / "picks.json", "-n", 3)
    assert said.returncode == 0, said.stderr
    assert said.stdout == f"3 starts of run.yaml: {folder / 'picks.json'}\n"
    return folder


@pytest.fixture(scope="module")
def result(folder: Path) -> robocell.evaluate.Evaluation:
    return benchmark.evaluate(folder / "picks.json", "expert", output=folder / "expert")


def test_a_benchmark_says_how_its_episodes_start(folder: Path):
    made = benchmark.load(folder / "picks.json")
    assert (made.source, made.seed, len(made.starts)) == ("run.yaml", benchmark.SEED, 3)
    assert made.task.startswith("task:\n  kind: pick\n")
    for start in made.starts:
        assert start["instruction"].startswith("pick up the ")
        assert len(start["state"]["robots/rc7/arm/qpos"]) == 7
        assert len(start["state"]["objects/target/pose"]) == 7
    assert len({json.dumps(start["state"]) for start in made.starts}) == 3
    assert any(name.endswith("rc7.xml") for name in made.files)


def test_rollouts_begin_at_the_frozen_starts(folder: Path, result: Any):
    made = benchmark.load(folder / "picks.json")
    assert (result.rollouts, result.seed) == (3, made.seed)
    rollouts = robocell.Dataset(folder / "expert")
    assert rollouts.ids == [start["id"] for start in made.starts]
    for start, episode in zip(made.starts, rollouts, strict=True):
        assert episode.metadata["instruction"] == start["instruction"]
        for name, values in start["state"].items():
            assert np.array_equal(np.ravel(episode[name][0]), values), name


def test_the_command_evaluates_a_benchmark(folder: Path, result: Any):
    said = robocell_command(
        "evaluate", folder / "picks.json", "--policy", "expert", "-o", folder / "expert", "--json"
    )
    assert said.returncode == 0, said.stderr
    assert json.loads(said.stdout)["outcomes"] == result.outcomes


def test_a_benchmark_of_a_dataset_has_its_cell(folder: Path, result: Any, tmp_path: Path):
    made = benchmark.create(folder / "expert", tmp_path / "more.json", episodes=1, seed=7)
    assert made.place.resolve() == (folder / "expert").resolve()
    found = benchmark.evaluate(made, "random", output=tmp_path / "random")
    assert found.rollouts == 1


def edited(folder: Path, out: Path, change: Any) -> Path:
    """A copy of the benchmark with another content and a right hash."""
    content = json.loads((folder / "picks.json").read_text())
    content["source"] = str(folder / "run.yaml")
    change(content)
    content["json_sha256"] = "0" * 64
    out.write_text(sign_json(json.dumps(content, indent=1) + "\n"))
    return out


def test_another_start_is_refused_before_the_first_rollout(folder: Path, tmp_path: Path):
    def change(content: Any) -> None:
        content["starts"][0]["state"]["robots/rc7/arm/qpos"][2] += 1e-9

    file = edited(folder, tmp_path / "b.json", change)
    said = refused("evaluate", file, "--policy", "expert", "-o", tmp_path / "out")
    assert "start 's0000_e0000' is another one here: 'robots/rc7/arm/qpos' is [" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c["starts"][2]["state"]["objects/target/pose"].reverse(), "'s0000_e0002' is"),
        (lambda c: c.update(task="task:\n  kind: push\n"), "its successes mean something else"),
        (
            lambda c: c["files"].update(dict.fromkeys(c["files"], "0" * 64)),
            "is not the file that benchmark",
        ),
    ],
)
def test_what_cannot_be_compared_is_refused(
    folder: Path, result: Any, tmp_path: Path, change: Any, message: str
):
    file = edited(folder, tmp_path / "b.json", change)
    # The rollouts are there already: evaluating them again only looks at them.
    with pytest.raises(robocell.ArgumentError) as raised:
        benchmark.evaluate(file, "expert", output=folder / "expert")
    assert message in str(raised.value)


def test_a_task_that_was_changed_is_refused(folder: Path, tmp_path: Path):
    run = yaml.safe_load((folder / "run.yaml").read_text())
    run["robot"] = str(folder / run["robot"])
    run["task"]["lift_height"] = 0.2
    (tmp_path / "run.yaml").write_text(yaml.safe_dump(run))
    file = edited(folder, tmp_path / "b.json", lambda c: c.update(source="run.yaml"))
    with pytest.raises(robocell.ArgumentError, match="its successes mean something else"):
        benchmark.evaluate(file, "random", output=tmp_path / "out")


def test_mistakes_are_named(folder: Path, tmp_path: Path):
    file = folder / "picks.json"
    assert "exists already" in refused("benchmark", folder / "run.yaml", file)
    assert "seed is that of the benchmark" in refused(
        "evaluate", file, "--policy", "expert", "--seed", 3
    )
    assert "no recorded actions to replay" in refused("evaluate", file, "--policy", "replay")
    copy = tmp_path / "alone.json"
    shutil.copy(file, copy)
    assert "is of 'run.yaml', and there is no" in refused("evaluate", copy, "--policy", "expert")
    copy.write_text(file.read_text().replace("pick up", "lift", 1))
    assert "is damaged or was edited" in refused("evaluate", copy, "--policy", "expert", code=3)
    copy.write_text("{}")
    assert "is no benchmark; `robocell benchmark` writes one" in refused(
        "evaluate", copy, "--policy", "expert", code=3
    )
