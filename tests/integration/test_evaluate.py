"""Policies act in the cells of datasets, and evaluations count what comes of it."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from commands import ROOT, generate, refusal, robocell_command

import robocell as rc
from made_once import made_once
from robocell._dataset_run import run_of_dataset
from robocell._evaluated import RolloutEnd, breakdown_of, rollout_end
from robocell._generation.items import ItemRecord
from robocell._generation.unstored import UnstoredRollout
from robocell._policy_calls import PolicyCalls, latency
from robocell._report.facts import EpisodeFacts
from robocell.envs import from_dataset
from robocell.evaluate import (
    Evaluation,
    compare,
    default_output,
    evaluate,
    wilson_interval,
)

DEMO = ROOT / "examples" / "demo.yaml"


REPLAYER = """
import os
import signal
from pathlib import Path

import numpy as np
from robocell.policy import Policy


class Stay(Policy):
    def act(self, observation):
        q = observation["robots/rc7/arm/qpos"]
        return {
            "robots/rc7/action/arm": np.tile(q, (5, 1)),
            "robots/rc7/action/gripper": np.ones((5, 1)),
        }


class Raising(Policy):
    def act(self, observation):
        return 1 / 0


class Dying(Policy):  # its first process is killed in the middle of a rollout
    def act(self, observation):
        mark = Path(__file__).with_name("died")
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return {"robots/rc7/action/gripper": 1}


class Wrong(Policy):
    def act(self, observation):
        return {"robots/rc7/action/am": observation["robots/rc7/arm/qpos"]}
"""


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two picks without images; policies that fail at them need no more than 120 steps."""

    def make(folder: Path) -> None:
        words = ("--set", "cameras.streams=[]", "--set", "rates.max_steps=120")
        generate(DEMO, folder / "picks", "--episodes", 2, *words)

    return made_once(tmp_path_factory, "evaluate", make) / "picks"


def test_the_interval_is_wilsons():
    # Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
    for successes, trials, low, high in (
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ):
        assert wilson_interval(successes, trials) == pytest.approx((low, high), abs=1e-4)
    assert wilson_interval(0, 0) == (0.0, 1.0)


def test_an_expert_is_evaluated_from_new_starts(dataset: Path, tmp_path: Path):
    result = evaluate(dataset, "expert", episodes=4, workers=2, output=tmp_path / "out")
    assert result.rollouts == 4
    assert result.successes >= 3
    rollouts = rc.Dataset(tmp_path / "out")
    assert {episode.id: episode.success for episode in rollouts} == result.outcomes
    seen = {tuple(e["objects/target/pose"][0]) for e in rc.Dataset(dataset)}
    assert not seen & {tuple(e["objects/target/pose"][0]) for e in rollouts}
    again = evaluate(dataset, "expert", episodes=4, workers=1, output=tmp_path / "out")
    assert again.outcomes == result.outcomes


def test_policies_see_the_same_starts_and_failures_are_kept(dataset: Path, tmp_path: Path):
    (tmp_path / "mine.py").write_text(REPLAYER)
    expert = evaluate(dataset, "expert", episodes=2, output=tmp_path / "expert")
    stay = evaluate(dataset, f"{tmp_path / 'mine.py'}:Stay", episodes=2, output=tmp_path / "stay")
    assert (stay.successes, stay.rollouts) == (0, 2)
    assert stay.failures == {"timeout": 2}
    for name in expert.outcomes:
        a, b = rc.Dataset(tmp_path / "expert")[name], rc.Dataset(tmp_path / "stay")[name]
        assert np.array_equal(a["objects/target/pose"][0], b["objects/target/pose"][0])
        still = b["robots/rc7/action/arm"]
        assert np.abs(still - still[0]).max() < 0.05


def test_the_results_of_rollouts_that_are_not_kept_are_read_back(tmp_path: Path):
    good = ItemRecord("a", success=True, complete=True, rows=7, robot="rc7", object_kind="cup")
    bad = replace(good, id="b", success=False, rows=9, object_kind="box")
    for record, failure in ((good, ""), (bad, "policy error: in act: no")):
        calls = PolicyCalls(record.id)
        calls.add(0, 1, 2.5, {})
        UnstoredRollout(record, failure).save(calls, tmp_path)
    (tmp_path / "policy_calls/c.json").write_text('{"calls": [], "result": {"record": {}}}')
    ends = [rollout_end(tmp_path, name) for name in "abcd"]
    assert ends == [
        RolloutEnd(True, "success", 7, False),
        RolloutEnd(False, "policy error: in act: no", 9, True),
        None,
        None,
    ]
    assert UnstoredRollout.find(tmp_path, "a") == UnstoredRollout(good, "")
    assert breakdown_of(tmp_path, "abcd") == {"object": {"cup": [1, 1], "box": [0, 1]}}
    assert latency(tmp_path, "ab")["calls"] == 2


def test_kept_rollouts_count_beside_those_that_are_not(dataset: Path, tmp_path: Path):
    kept = rc.Dataset(dataset)[0]
    (tmp_path / kept.id).symlink_to(kept.folder.absolute())
    own = EpisodeFacts.of(kept)
    other = ItemRecord("b", complete=True, robot=own.robots[0], object_kind="another")
    UnstoredRollout(other, "timeout").save(PolicyCalls("b"), tmp_path)
    groups = breakdown_of(tmp_path, [kept.id, "b"])
    assert groups["object"] == {own.object_kind: [1, 1], "another": [0, 1]}
    assert "robot" not in groups, "both are of one robot"


@pytest.mark.proof
def test_an_evaluation_without_rollouts_has_the_same_results(dataset: Path, tmp_path: Path):
    (tmp_path / "mine.py").write_text(REPLAYER)
    policy = f"{tmp_path / 'mine.py'}:Stay"
    kept = evaluate(dataset, policy, episodes=2, output=tmp_path / "kept")
    short = evaluate(dataset, policy, episodes=1, output=tmp_path / "out", rollouts=False)
    assert short.outcomes.items() < kept.outcomes.items()
    result = evaluate(dataset, policy, episodes=2, output=tmp_path / "out", rollouts=False)
    for name in ("outcomes", "failures", "mean_length", "seed", "cell", "policy_errors"):
        assert getattr(result, name) == getattr(kept, name), name
    assert not rc.Dataset(tmp_path / "out").ids
    assert evaluate(dataset, policy, episodes=2, output=tmp_path / "out", rollouts=False) == result
    evaluate(dataset, policy, episodes=2, output=tmp_path / "out")
    rows = [
        (tmp_path / folder / rc.Dataset(tmp_path / "kept").ids[0] / "steps.h5").read_bytes()
        for folder in ("kept", "out")
    ]
    assert rows[0] == rows[1], "kept later"


def evaluation(outcomes: dict[str, bool], seed: int = 1) -> Evaluation:
    """An evaluation with these outcomes."""
    successes = sum(outcomes.values())
    return Evaluation(
        policy="mine",
        successes=successes,
        rollouts=len(outcomes),
        interval=wilson_interval(successes, len(outcomes)),
        mean_length=1.0,
        unmade=0,
        failures={},
        policy_errors=0,
        outcomes=outcomes,
        dataset="out",
        seed=seed,
        errors={},
    )


def test_policies_are_compared_by_their_common_starts():
    first = {f"s0_e{i}": i < 12 for i in range(20)}
    second = {f"s0_e{i}": i < 3 or i == 19 for i in range(1, 21)}
    found = compare(evaluation(first), evaluation(second))
    # 12 starts of the first alone or both: 1 to 11 are common; the second has 1, 2 and 19.
    assert (found.both, found.first_only, found.second_only, found.neither) == (2, 9, 1, 7)
    assert found.p_value == pytest.approx(2 * (1 + 10) / 2**10)
    same = compare(evaluation(first), evaluation(first))
    assert (same.first_only, same.second_only, same.p_value) == (0, 0, 1.0)


def test_evaluations_without_common_starts_are_not_compared():
    mine = evaluation({"s0_e0": True})
    with pytest.raises(rc.ArgumentError, match="the seeds of the evaluations are 1 and 2"):
        compare(mine, evaluation({"s0_e0": True}, seed=2))
    with pytest.raises(rc.ArgumentError, match=r"have no start in common; evaluate both"):
        compare(mine, evaluation({"s0_e1": True}))


def test_evaluations_in_different_cells_are_not_compared():
    cell = {"rates.policy_ms": "40", "task.kind": "pick", "file 'rc7.xml'": "12ab"}
    mine = replace(evaluation({"s0_e0": True}), cell=cell)
    assert compare(mine, replace(mine, policy="other")).both == 1
    other = {"rates.policy_ms": "20", "task.kind": "pick", "file 'rc7.xml'": "34cd", "seed": "1"}
    with pytest.raises(rc.ArgumentError) as refused:
        compare(mine, replace(mine, cell=other))
    assert str(refused.value) == (
        "'out' and 'out' are evaluations in different cells: rates.policy_ms: 40 and 20, "
        "file 'rc7.xml', seed: nothing and 1; evaluate both policies in the cell of one dataset or "
        "run"
    )


@pytest.mark.proof
def test_an_evaluation_stores_its_cell(dataset: Path, tmp_path: Path):
    same = evaluate(dataset, "random", episodes=1, output=tmp_path / "same", cameras=False)
    longer = evaluate(dataset, "expert", episodes=1, output=tmp_path / "longer", max_steps=700)
    assert same.cell["rates.max_steps"] == "120"
    assert "expert" not in same.cell
    with pytest.raises(rc.ArgumentError, match=r"cells: rates\.max_steps: 700 and 120; evaluate"):
        compare(longer, same)


@pytest.mark.proof  # of a recorded one in test_evaluate_recorded.py
def test_the_cell_of_a_moved_dataset_and_of_its_run_file_is_the_same(dataset: Path, tmp_path: Path):
    shutil.copytree(dataset, tmp_path / "moved")
    run = yaml.safe_load(DEMO.read_text()) | {"output": "out"}
    run["robot"] = str(DEMO.parent / run["robot"])
    run["cameras"]["streams"], run["rates"]["max_steps"] = [], 120
    (tmp_path / "own.yaml").write_text(yaml.safe_dump(run))
    sources = (dataset, tmp_path / "moved", tmp_path / "own.yaml")
    mine, moved, own = (
        evaluate(source, "random", episodes=1, output=tmp_path / f"rollouts{number}")
        for number, source in enumerate(sources)
    )
    assert compare(mine, moved).neither == 1
    assert compare(mine, own).neither == 1
    assert [name for name in mine.cell if name.endswith("rc7.xml'")]
    assert not [
        value for value in mine.cell.values() if str(tmp_path) in value or " at 0x" in value
    ]


@pytest.mark.proof
def test_a_refused_folder_is_told_by_the_options_of_the_command(dataset: Path, tmp_path: Path):
    words = ("evaluate", dataset, "--policy", "random", "-n", 1, "--output", tmp_path / "out")
    assert robocell_command(*words).returncode == 0
    said = refusal(*words, "--max-steps", 30)
    assert "--max-steps 30: rates.max_steps: 120 then, 30 now" in said
    assert "--set" not in said


def test_reasons_that_differ_in_the_names_there_are_count_as_one():
    errors = [
        f"policy error: the row has no 'x'. It has: {names} (p.py:5, in act)" for names in "ab"
    ]
    counts = rc.evaluate._by_reason(["timeout", *errors, errors[1]])
    assert counts == {errors[0]: 3, "timeout": 1}


def test_a_misspelt_dataset_is_told_with_the_nearest_one(dataset: Path):
    said = refusal("evaluate", dataset.with_name("pickks"), "--policy", "expert")
    assert f"no dataset or run file '{dataset.with_name('pickks')}'." in said
    assert f"Did you mean '{dataset}'?" in said


def test_a_stored_evaluation_is_read_again(tmp_path: Path):
    mine = evaluation({"s0_e0": True, "s0_e1": False})
    with pytest.raises(rc.IoError, match="`robocell evaluate` writes it"):
        Evaluation.load(tmp_path)
    (tmp_path / "evaluation.json").write_text(mine.to_json())
    assert Evaluation.load(tmp_path) == mine
    (tmp_path / "evaluation.json").write_text('{"interval": [0, 1]}')
    with pytest.raises(rc.IoError, match=r"no evaluation of this version.*repeat the command"):
        Evaluation.load(tmp_path)


def test_the_command_prints_rate_and_interval(dataset: Path, tmp_path: Path):
    out = tmp_path / "out"
    words = ("evaluate", dataset, "--policy", "expert", "-n", "2", "--output", out)
    said = robocell_command(*words)
    assert said.returncode == 0, said.stderr
    result = json.loads((out / "evaluation.json").read_text())
    assert result["rollouts"] == 2
    lengths = [len(episode) for episode in rc.Dataset(out)]
    assert result["mean_length"] == pytest.approx(sum(lengths) / 2)
    head, row = (line for line in said.stdout.splitlines() if line.startswith("  "))
    assert " ".join(head.split()) == "policy success rate 95 % interval mean length errors"
    assert row.split()[:2] == ["expert", f"{result['successes']}/2"]
    low, high = (f"{100 * bound:.0f}" for bound in result["interval"])
    assert f"{low} ... {high} %" in row
    assert row.split()[-2:] == [f"{result['mean_length']:.1f}", "0"]


@pytest.mark.parametrize(
    ("source", "policy", "expected"),
    [
        ("picks", "expert", "picks_evaluation/expert-7"),
        ("run.yaml", "random", "run_evaluation/random-7"),
        ("picks", "here/mine.py:Mine", "picks_evaluation/mine.Mine-7"),
        ("picks", "package.mine:Mine", "picks_evaluation/package.mine.Mine-7"),
    ],
)
def test_rollouts_are_next_to_the_source(tmp_path: Path, source: str, policy: str, expected: str):
    (tmp_path / "picks").mkdir()
    (tmp_path / "run.yaml").touch()
    assert default_output(tmp_path / source, policy, 7) == tmp_path / expected


def test_the_default_output_of_a_configuration_is_in_the_working_folder():
    assert default_output("a/cells.py:demo", "expert", 7) == Path("cells.demo_evaluation/expert-7")


@pytest.mark.proof
def test_an_evaluation_without_output_continues_in_its_own_folder(dataset: Path):
    words = ("evaluate", dataset, "--policy", "expert", "-n", "1", "--seed", "7")
    said = robocell_command(*words)
    assert said.returncode == 0, said.stderr
    folder = dataset.with_name("picks_evaluation") / "expert-7"
    assert str(folder) in said.stdout
    assert (folder / "evaluation.json").is_file()
    other = refusal("evaluate", DEMO, *words[2:], "--output", folder)
    assert "was begun differently" in other


def policy_file(folder: Path, name: str) -> Path:
    file = folder / f"{name}.py"
    file.write_text(REPLAYER)
    return file


@pytest.mark.proof  # as in test_evaluate_recorded.py
def test_a_killed_worker_costs_no_rollout(dataset: Path, tmp_path: Path):
    file = policy_file(tmp_path, "dying")
    result = evaluate(dataset, f"{file}:Dying", episodes=3, workers=2, output=tmp_path / "out")
    assert (tmp_path / "died").exists()
    assert (result.rollouts, result.unmade) == (3, 0)
    assert result.failures == {"timeout": 3}


@pytest.mark.proof
def test_scenes_of_files_come_from_the_dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    here = tmp_path / "here"
    here.mkdir()
    (here / "lab.xml").write_text(
        '<mujoco><worldbody><light pos="0 0 3"/><body name="bench" pos="0 0 0.2">'
        '<geom type="box" size="0.3 0.4 0.2"/><site name="table_top" pos="0 0 0.2"/>'
        "</body></worldbody></mujoco>"
    )
    text = DEMO.read_text().replace(
        "../models/robots/rc7/rc7.yaml", str(ROOT / "models/robots/rc7/rc7.yaml")
    )
    text = text.replace("{source: tabletop}", "{source: files, files: [lab.xml]}")
    (here / "run.yaml").write_text(text)
    monkeypatch.chdir(here)
    out = tmp_path / "out"
    generate(here / "run.yaml", out, "--episodes", 1, "--set", "cameras.streams=[]")
    (here / "lab.xml").unlink()
    monkeypatch.chdir(tmp_path)
    result = evaluate(out, "expert", episodes=1, output=tmp_path / "trials")
    assert result.rollouts == 1


@pytest.mark.proof  # shorter below: without a report
def test_chosen_scenes_are_those_of_the_dataset(tmp_path: Path):
    """Also in a dataset that is not complete: here each second item is missing."""
    out = tmp_path / "out"
    words = ("--set", "scenes.houses=[5,3]", "--set", "cameras.streams=[]", "--shard", "1/2")
    generate(DEMO, out, "--episodes", 4, *words)
    made = {episode.id: episode for episode in rc.Dataset(out)}
    assert set(made) == {"s0003_e0000", "s0003_e0001"}
    assert list(run_of_dataset(out).scenes.houses) == [5, 3]

    env = from_dataset(out, privileged=True)
    for start, name in ((1, "s0003_e0000"), (3, "s0003_e0001")):
        row, _ = env.reset(seed=start)
        for column in env.observations:
            assert np.array_equal(row[column], np.asarray(made[name][column])[0]), column

    expert = evaluate(out, "expert", episodes=3, output=tmp_path / "expert")
    assert set(expert.outcomes) == {"s0005_e0000", "s0003_e0000", "s0005_e0001"}
    replay = evaluate(out, "replay", output=tmp_path / "replay")
    assert replay.outcomes == dict.fromkeys(made, True)
    first = evaluate(out, "replay", episodes=1, output=tmp_path / "first")
    assert first.outcomes == {"s0003_e0000": True}


def test_without_a_report_scenes_come_from_the_episodes(tmp_path: Path):
    out = tmp_path / "out"
    words = ("--set", "scenes.houses=[5,3]", "--set", "cameras.streams=[]")
    generate(DEMO, out, "--episodes", 2, *words)
    (out / "report.json").unlink()
    assert list(run_of_dataset(out).scenes.houses) == [3, 5]


@pytest.mark.proof
def test_other_weights_are_another_evaluation(dataset: Path, tmp_path: Path):
    file = tmp_path / "weighing.py"
    file.write_text(
        "from robocell.policy import Policy\n"
        "class Weighing(Policy):\n"
        "    files = ['weights.txt']\n"
        "    def act(self, observation):\n"
        "        return {'robots/rc7/action/gripper': 1}\n"
    )
    out = tmp_path / "out"
    with pytest.raises(rc.SpecError, match=r"weights\.txt', where there is no file"):
        evaluate(dataset, f"{file}:Weighing", episodes=1, output=out)
    (tmp_path / "weights.txt").write_text("1")
    evaluate(dataset, f"{file}:Weighing", episodes=1, output=out)
    (tmp_path / "weights.txt").write_text("2")
    with pytest.raises(rc.SpecError, match=r"weights\.txt: changed since then"):
        evaluate(dataset, f"{file}:Weighing", episodes=1, output=out)


@pytest.mark.parametrize("policy", ["expert", "random", "replay"])
def test_rejects_a_folder_without_episodes(policy: str, tmp_path: Path):
    (tmp_path / "empty").mkdir()
    said = refusal("evaluate", tmp_path / "empty", "--policy", policy, "-n", "1")
    assert "has no episode" in said or "no dataset" in said
    assert "Traceback" not in said
