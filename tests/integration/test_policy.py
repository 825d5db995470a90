"""Policies: what they see and do, and what is said of those that are wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from commands import refusal, robocell_command
from test_evaluate import DEMO, REPLAYER, dataset, policy_file

import robocell as rc
from robocell.dataset_run import run_of_dataset
from robocell.evaluate import evaluate
from robocell.policy import Policy, PolicyExpert

__all__ = ["dataset"]  # a fixture


class Spy(Policy):
    def __init__(self, actions: list[np.ndarray]) -> None:
        self.seen: list[dict[str, np.ndarray]] = []
        self.actions = actions

    def act(self, observation):
        self.seen.append(observation)
        at = min(len(self.seen), len(self.actions)) - 1
        arm, opening = self.actions[at]
        return {"robots/rc7/action/arm": arm, "robots/rc7/action/gripper": opening}


def test_a_policy_sees_the_rows_that_a_dataset_records(dataset: Path, tmp_path: Path):
    """The recorded actions, played by a policy, lead through the recorded rows."""
    run = run_of_dataset(dataset)
    run.output = str(tmp_path / "played")
    source = rc.Dataset(dataset)[0]
    actions = list(
        zip(source["robots/rc7/action/arm"], source["robots/rc7/action/gripper"], strict=True)
    )
    spies: list[Spy] = []

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        spies.append(Spy(actions))
        return PolicyExpert(run, start, spies[-1])

    run.keep = rc.generate.Keep.FIRST
    run.episodes, run.max_attempts = 1, 20
    rc.generate.prepare_dataset(run)
    result = rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    assert result.committed
    played = rc.Dataset(run.output)[0]
    spy = spies[-1]
    assert len(spy.seen) == len(played)
    for name in (
        "robots/rc7/arm/qpos",
        "robots/rc7/arm/qvel",
        "robots/rc7/tcp_pose",
        "robots/rc7/tcp_pose_in_base",
        "robots/rc7/base_pose",
        "robots/rc7/opening",
        "objects/target/pose",
        "time",
    ):
        seen = np.array([row[name] for row in spy.seen])
        np.testing.assert_allclose(seen, played[name], rtol=0, atol=1e-12, err_msg=name)


def test_what_is_wrong_with_a_policy_is_named(dataset: Path, tmp_path: Path):
    (tmp_path / "mine.py").write_text(REPLAYER)
    out = tmp_path / "out"

    def said(policy: str) -> str:
        return refusal("evaluate", dataset, "--policy", policy, "-n", "1", "--output", out)

    assert "expected module:Class" in said("mine")
    assert "no class or function 'Gone'" in said(f"{tmp_path / 'mine.py'}:Gone")
    assert "there is no such file" in said(f"{tmp_path / 'no.py'}:Stay")
    wrong = said(f"{tmp_path / 'mine.py'}:Wrong")
    assert "Wrong.act(): no action 'robots/rc7/action/am'" in wrong
    assert "robots/rc7/action/arm" in wrong


def test_a_policy_that_raises_is_named_with_its_line(dataset: Path, tmp_path: Path):
    file = policy_file(tmp_path, "raising")
    line = 1 + REPLAYER[: REPLAYER.index("return 1 / 0")].count("\n")
    for workers in (1, 2):
        with pytest.raises(rc.Error, match=rf"ZeroDivisionError.*raising\.py:{line}, in act"):
            evaluate(
                dataset,
                f"{file}:Raising",
                episodes=3,
                workers=workers,
                output=tmp_path / f"out{workers}",
            )


def test_a_dataset_replays_its_own_actions(dataset: Path, tmp_path: Path):
    result = evaluate(dataset, "replay", output=tmp_path / "out", workers=2)
    assert (result.successes, result.trials) == (2, 2)
    for episode in rc.Dataset(dataset):
        again = rc.Dataset(tmp_path / "out")[episode.id]
        rows = len(again)  # a policy ends at success, an expert goes on to hold
        for name in ("robots/rc7/arm/qpos", "objects/target/pose"):
            assert np.array_equal(episode[name][:rows], again[name])
    said = refusal("evaluate", DEMO, "--policy", "replay", "-o", tmp_path / "none")
    assert "needs a dataset whose actions it takes" in said
    said = robocell_command(
        *("evaluate", dataset, "--policy", "replay", "--seed", "5", "-n", "1"),
        *("-o", tmp_path / "other"),
    )
    assert "starts like this one" in said.stdout + said.stderr
