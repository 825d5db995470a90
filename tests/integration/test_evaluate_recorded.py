"""Policies in the environment that a dataset was recorded in."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from commands import refusal, robocell_command

import robocell as rc
from robocell._env_job import EnvJob
from robocell._generation.run_source import RunSource
from robocell.data import EnvRecorder, env_of_episode, replay_actions
from robocell.evaluate import Evaluation, compare, evaluate
from robocell.gym import pick_cube_config

POLICIES = """
import os
import signal
from pathlib import Path

import numpy as np
from robocell.policy import Policy

STILL = [0, 0, 0, 0, 0, 0, 1]


class Picker(Policy):
    def reset(self, context):
        assert context.run.task.kind == "pick", context.run.task
        assert context.instruction == "pick up the cube"
        assert {f.role for f in context.features} >= {"observation", "action"}
        self.step = 0

    def act(self, observation):
        cube = observation["observation/objects/cube/tquat"][:3]
        tcp = observation["observation/robot/tquat"][:3]
        self.step += 1
        if self.step < 14:  # above the cube, then down
            goal, opening = cube + [0, 0, 0.1 if self.step < 8 else 0], 1
        elif self.step < 17:
            goal, opening = tcp, 0
        else:
            goal, opening = tcp + [0, 0, 0.05], 0
        move = np.clip(goal - tcp, -0.05, 0.05)
        return {"action/robot/tquat": [*move, 0, 0, 0, 1], "action/robot/gripper": [opening]}


class Still(Policy):
    def act(self, observation):
        moves = np.tile(STILL, (3, 1))  # a chunk
        return {"action/robot/tquat": moves, "action/robot/gripper": np.ones((3, 1))}


class Raising(Policy):  # at once in the first rollout, later in others
    def act(self, observation):
        if observation["time"] >= 0.1:
            raise ValueError("lost")
        return {"action/robot/tquat": STILL, "action/robot/gripper": [1]}


class Half(Policy):
    def act(self, observation):
        return {"action/robot/gripper": [1]}


class Dying(Still):  # its first process is killed in the middle of a rollout
    def act(self, observation):
        mark = Path(__file__).with_name("died")
        if observation["time"] > 0.1 and not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().act(observation)
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes of five and seven actions."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "policies.py").write_text(POLICIES)
    env = rc.Env(pick_cube_config(relative_to="last_step"))
    with EnvRecorder(env, folder / "out"):
        for seed, steps in ((11, 5), (12, 7)):
            env.reset(seed=seed)
            for i in range(steps):
                env.step({"robot": {"tquat": [0.01 * i, 0, -0.01, 0, 0, 0, 1], "gripper": i % 2}})
    env.close()
    return folder / "out"


def policy(recorded: Path, name: str) -> str:
    return f"{recorded.parent / 'policies.py'}:{name}"


@pytest.mark.proof
def test_policies_get_the_same_new_starts(recorded: Path, tmp_path: Path):
    picker = evaluate(
        recorded, policy(recorded, "Picker"), episodes=4, workers=2, max_steps=40,
        output=tmp_path / "picker",
    )  # fmt: skip
    still = evaluate(
        recorded, policy(recorded, "Still"), episodes=4, max_steps=40, output=tmp_path / "still"
    )
    assert (picker.rollouts, picker.unmade, picker.policy_errors) == (4, 0, 0)
    assert picker.successes >= 3
    assert (still.successes, still.failures) == (0, {"timeout": 4})
    assert still.mean_length == 40
    mine, other = rc.Dataset(tmp_path / "picker"), rc.Dataset(tmp_path / "still")
    assert {episode.id: episode.success for episode in mine} == picker.outcomes
    starts = set()
    for id in picker.outcomes:
        assert np.array_equal(mine[id]["env_state"], other[id]["env_state"])
        assert replay_actions(env_of_episode(mine[id]), mine[id]).ok
        starts.add(tuple(mine[id]["observation/objects/cube/tquat"][0]))
    assert len(starts) == 4
    assert not starts & {
        tuple(e["observation/objects/cube/tquat"][0]) for e in rc.Dataset(recorded)
    }
    compared = compare(picker, still)
    assert (compared.first_only, compared.second_only) == (picker.successes, 0)
    assert other[0].metadata["user"]["evaluation"]["policy"] == policy(recorded, "Still")


@pytest.mark.proof  # of runs in test_evaluate.py
def test_another_seed_or_number_of_workers(recorded: Path, tmp_path: Path):
    def first_state(output: Path, **options: int) -> np.ndarray:
        evaluate(recorded, "random", episodes=2, max_steps=3, output=output, **options)
        return np.array([episode["env_state"] for episode in rc.Dataset(output)])

    alone = first_state(tmp_path / "alone", seed=1)
    assert np.array_equal(alone, first_state(tmp_path / "together", seed=1, workers=2))
    one, two = (rc.Dataset(tmp_path / each) for each in ("alone", "together"))
    for a, b in zip(one, two, strict=True):
        assert np.array_equal(a["action/robot/tquat"], b["action/robot/tquat"])
    assert not np.array_equal(alone, first_state(tmp_path / "other", seed=2))


def test_a_replay_repeats_the_recorded_episodes(recorded: Path, tmp_path: Path):
    result = evaluate(recorded, "replay", output=tmp_path / "out")
    assert list(result.outcomes) == ["recorded000000-000000", "recorded000001-000000"]
    for a, b in zip(rc.Dataset(recorded), rc.Dataset(tmp_path / "out"), strict=True):
        assert len(a) == len(b)
        for column in a.columns:
            assert np.array_equal(a[column], b[column]), column


def test_errors_of_the_policy_are_failures(recorded: Path, tmp_path: Path):
    result = evaluate(recorded, policy(recorded, "Raising"), episodes=2, output=tmp_path / "late")
    place = f"({recorded.parent / 'policies.py'}:"
    (reason,) = result.failures
    assert reason.startswith(f"policy error: ValueError: lost {place}")
    assert (result.policy_errors, result.rollouts) == (2, 2)
    assert {len(episode) for episode in rc.Dataset(tmp_path / "late")} == {2}
    half = evaluate(recorded, policy(recorded, "Half"), episodes=2, output=tmp_path / "half")
    lacks = (
        r"Half\.act\(\): the action lacks 'action/robot/tquat'; an environment takes whole actions"
    )
    (reason,) = half.failures
    assert re.fullmatch(rf"policy error: {lacks} \(\S+policies\.py:\d+, in act\)", reason)
    assert half.failures[reason] == 2
    assert (half.policy_errors, half.mean_length) == (2, 0)
    assert len(rc.Dataset(tmp_path / "half")) == 0
    again = evaluate(recorded, policy(recorded, "Half"), episodes=2, output=tmp_path / "half")
    assert again.outcomes == half.outcomes


def test_a_killed_worker_costs_no_rollout(recorded: Path, tmp_path: Path):
    result = evaluate(recorded, policy(recorded, "Dying"), episodes=3, output=tmp_path / "out")
    assert (recorded.parent / "died").exists()
    assert (result.rollouts, result.failures) == (3, {"timeout": 3})
    assert rc.data.verify(tmp_path / "out").ok


def test_an_evaluation_continues_only_as_the_same(recorded: Path, tmp_path: Path):
    file = shutil.copy(recorded.parent / "policies.py", tmp_path / "policies_here.py")
    out = tmp_path / "out"
    first = evaluate(recorded, f"{file}:Still", episodes=1, output=out)
    before = (out / "start000000-000000/episode.json").read_bytes()
    more = evaluate(recorded, f"{file}:Still", episodes=2, output=out)
    assert (out / "start000000-000000/episode.json").read_bytes() == before
    assert first.outcomes.items() < more.outcomes.items()
    with pytest.raises(rc.SpecError, match="has another evaluation: max_steps: 7 and now 2; "):
        evaluate(recorded, f"{file}:Still", episodes=2, output=out, max_steps=2)
    with pytest.raises(
        rc.SpecError, match=r"has another evaluation: policy: \S+:Still and now \S+:Picker; "
    ):
        evaluate(recorded, f"{file}:Picker", episodes=2, output=out)


@pytest.mark.proof  # as other weights in test_evaluate.py
def test_a_corrected_policy_is_another_evaluation(recorded: Path, tmp_path: Path):
    """Its rollouts have no episode: they ended before their first action."""
    file = tmp_path / "corrected.py"
    still = POLICIES.replace("class Still(Policy)", "class Mine(Policy)").replace(
        "(Still)", "(Mine)"
    )
    wrong = "    def reset(self, context): raise KeyError('nope')\n\n"
    file.write_text(still.replace("class Mine(Policy):\n", f"class Mine(Policy):\n{wrong}"))
    out = tmp_path / "out"
    words = ("evaluate", recorded, "--policy", f"{file}:Mine", "-n", "2", "--output", out)
    said = robocell_command(*words)
    assert said.returncode == 1, said.stderr
    assert not rc.Dataset(out).ids
    file.write_text(still)
    said = refusal(*words)
    assert f"another evaluation: code file {file} changed since then; choose another" in said
    said = refusal(*words[:2], "--policy", "random", *words[4:])
    assert "has another evaluation: policy:" in said


def test_the_cell_of_a_moved_dataset_is_the_same(recorded: Path, tmp_path: Path):
    moved = shutil.copytree(recorded, tmp_path / "moved")
    one = evaluate(recorded, "random", episodes=1, max_steps=1, output=tmp_path / "one")
    other = evaluate(moved, "random", episodes=1, max_steps=1, output=tmp_path / "other")
    assert compare(one, other).neither == 1
    assert any(name.startswith("file ") for name in one.cell)
    assert one.cell["task.kind"] == "pick"


def test_two_evaluations_do_not_share_a_folder(recorded: Path, tmp_path: Path):
    out = tmp_path / "out"
    out.mkdir()
    with rc.data.DatasetLock(out), pytest.raises(rc.IoError, match="is in use by process"):
        evaluate(recorded, "random", episodes=1, max_steps=1, output=out)
    assert not list(out.glob("start*"))


def test_the_command_for_one_rollout_has_all_options(recorded: Path, tmp_path: Path):
    source = RunSource(str(recorded), ("tasks.py",), "random")
    made = source.evaluation_command(3, 5, 7, False, tmp_path / "alone")
    assert made == (
        f"robocell evaluate {recorded} --import tasks.py --policy random -n 3 --seed 5 "
        f"--max-steps 7 --no-cameras --output {tmp_path / 'alone'}"
    )
    job = EnvJob(
        RunSource(str(recorded), policy="random"), tmp_path / "out",
        episodes=4, seed=5, max_steps=7, workers=1, cameras=False,
    )  # fmt: skip
    assert "-n 3 --seed 5 --max-steps 7 --no-cameras --output" in job.reproduce(job.items[2])


def test_the_command_evaluates_in_the_recorded_environment(recorded: Path, tmp_path: Path):
    out = tmp_path / "out"
    words = ("--policy", policy(recorded, "Still"), "-n", "2", "--max-steps", "3")
    said = robocell_command("evaluate", recorded, *words, "--output", out)
    assert said.returncode == 0, said.stderr
    assert "failures: timeout 2" in said.stdout
    assert Evaluation.load(out).rollouts == 2
    stored = json.loads((out / "evaluation.json").read_text())
    assert stored["cell"]["max_steps"] == "3"
    said = refusal("evaluate", recorded, "--policy", "expert")
    assert "which has no expert: experts act in runs. Evaluate a run of the same task" in said
