"""Benchmarks: files with frozen starts, and what they refuse."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from robocell._core import self_hashed_json

import robocell
from command_line import RC7, RUN, refused, robocell_command, write_run
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


def test_successes_are_counted_by_what_differs_between_the_starts(folder: Path, result: Any):
    starts = benchmark.load(folder / "picks.json").starts
    kinds = {start["object_kinds"][0] for start in starts}
    assert result.breakdown["object"].keys() == kinds
    for groups in result.breakdown.values():
        assert sum(good for good, _ in groups.values()) <= result.successes
    of_object = result.breakdown["object"].values()
    assert sum(of for _, of in of_object) == result.rollouts
    assert sum(good for good, _ in of_object) == result.successes
    assert any(" x, m" in name for name in result.breakdown), "where objects stand"
    assert result.breakdown.keys().isdisjoint({"task", "robot"}), "there is one of each"


def test_the_command_evaluates_a_benchmark(folder: Path, result: Any):
    said = robocell_command(
        "evaluate", folder / "picks.json", "--policy", "expert", "-o", folder / "expert", "--json"
    )
    assert said.returncode == 0, said.stderr
    assert json.loads(said.stdout)["outcomes"] == result.outcomes


def test_a_benchmark_of_a_dataset_has_its_cell(folder: Path, result: Any, tmp_path: Path):
    made = benchmark.create(folder / "expert", tmp_path / "more.json", episodes=1, seed=7)
    assert made.place.resolve() == (folder / "expert").resolve()
    found = benchmark.evaluate(made, "random", output=tmp_path / "random", max_steps=5)
    assert found.rollouts == 1


def edited(folder: Path, out: Path, change: Any) -> Path:
    """A copy of the benchmark with another content and a right hash."""
    content = json.loads((folder / "picks.json").read_text())
    content["source"] = str(folder / "run.yaml")
    change(content)
    content["json_sha256"] = "0" * 64
    out.write_text(self_hashed_json(json.dumps(content, indent=1) + "\n"))
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
    # The rollouts are there already: evaluating again only reads them.
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
    assert not (tmp_path / "out").exists(), "it is refused before the first rollout"


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


MARKING = """
from pathlib import Path
with Path(__file__).with_suffix(".imported").open("a") as file:
    file.write("x")
"""


@pytest.fixture
def with_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A benchmark whose module leaves a file when it is imported."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "marking.py").write_text(MARKING)
    write_run(tmp_path, cameras={"streams": []}, rates={**RUN["rates"], "max_steps": 5})
    arguments = ("benchmark", "run.yaml", "picks.json", "-n", 1, "--import", "marking.py")
    said = robocell_command(*arguments)
    assert said.returncode == 0, said.stderr
    assert list(benchmark.load("picks.json").imports) == ["marking.py"]
    Path("marking.imported").unlink()
    return tmp_path


def test_a_benchmark_imports_only_what_the_user_names(with_module: Path):
    evaluate = ("evaluate", "picks.json", "--policy", "random", "-o", "out")
    said = refused(*evaluate)
    assert "needs the module 'marking.py', and a file never imports code by itself" in said
    command = "robocell evaluate picks.json --policy random --output out --import marking.py"
    assert f"`{command}`" in said
    assert not Path("marking.imported").exists()
    done = robocell_command(*command.split()[1:])
    assert done.returncode == 0, done.stderr
    assert Path("marking.imported").exists()


def test_modules_with_another_content_are_refused_unread(with_module: Path):
    Path("marking.py").write_text(MARKING + "# another\n")
    named = ("evaluate", "picks.json", "--policy", "random", "--import")
    said = refused(*named, "marking.py")
    assert "'marking.py' is not the module that benchmark 'picks.json' was made with" in said
    Path("more.py").write_text(MARKING)
    Path("marking.py").unlink()
    Path("other.py").write_text("")
    assert "was made without the module 'other.py'" in refused(*named, "other.py")
    assert not list(with_module.glob("*.imported"))


def test_a_run_file_that_a_benchmark_names_imports_nothing_by_itself(with_module: Path):
    def change(content: Any) -> None:
        content["imports"] = {}

    run = yaml.safe_load(Path("run.yaml").read_text()) | {"imports": ["evil.py"]}
    Path("run.yaml").write_text(yaml.safe_dump(run))
    Path("evil.py").write_text(MARKING)
    edited(with_module, with_module / "b.json", change)
    said = refused("evaluate", "b.json", "--policy", "random")
    assert "needs the module 'evil.py'" in said
    assert "--import evil.py`" in said
    said = refused("evaluate", "b.json", "--policy", "random", "--import", "evil.py")
    assert "was made without the module 'evil.py'" in said
    assert not list(with_module.glob("*.imported"))


def test_a_benchmark_needs_a_file_or_folder(tmp_path: Path):
    said = refused("benchmark", "tasks.py:config", tmp_path / "b.json")
    assert "no run file or dataset 'tasks.py:config'" in said


@pytest.mark.parametrize("name", ["source", "imports", "starts", "files"])
def test_a_file_of_another_shape_is_refused(folder: Path, tmp_path: Path, name: str):
    file = edited(folder, tmp_path / "b.json", lambda content: content.update({name: 3}))
    said = refused("evaluate", file, "--policy", "expert", code=3)
    assert f"has no {name} of this version of robocell" in said
