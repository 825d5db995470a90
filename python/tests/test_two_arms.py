"""Robots with two arms: their fields in runs, their environments, and what their experts do."""

from __future__ import annotations

from pathlib import Path

import pytest

import robocell as rc

EXAMPLES = Path(__file__).parents[2] / "examples"
DUO = EXAMPLES / "duo" / "duo.yaml"


def test_kinds_for_two_arms_have_an_expert_an_example_and_a_class():
    for kind in ("handover", "carry"):
        assert kind in rc.tasks.task_kinds()
        assert kind in rc.tasks.expert_kinds()
        run = rc.RunConfig.load(EXAMPLES / "tasks" / f"{kind}.yaml")
        assert run.task.kind == kind
        assert [group.kind.name for group in run.robot.move_groups.values()].count("ARM") == 2
    assert {"handed_over", "carried"} <= set(rc.tasks.relations())


@pytest.mark.parametrize("arm", ["left", "right", "any"])
def test_a_pick_may_name_its_arm(arm: str):
    run = rc.RunConfig.load(EXAMPLES / "duo" / "pick.yaml")
    run.task = rc.tasks.PickTaskConfig(arm=arm)
    assert rc.RunConfig.from_yaml(run.to_yaml()).task.arm == arm


def test_an_unknown_arm_is_named_with_its_place(tmp_path: Path):
    file = tmp_path / "run.yaml"
    file.write_text(f"run: a\nrobot: {DUO}\ntask: {{kind: pick, arm: lft}}\noutput: out\n")
    with pytest.raises(rc.SpecError, match=r"run.yaml:3:25.*no arm 'lft'.*Did you mean 'left'"):
        rc.RunConfig.load(file)


def test_a_robot_with_one_arm_cannot_hand_over(tmp_path: Path):
    run = rc.RunConfig.load(EXAMPLES / "demo.yaml")
    run.task, run.output = {"kind": "handover"}, str(tmp_path / "out")
    with pytest.raises(rc.SpecError, match=r"has 1 arm with a gripper.*is for two"):
        rc.generate.prepare_dataset(run)


def pick_of(run: rc.RunConfig) -> rc.Episode:
    runner = rc.generate.Runner(run)
    rc.generate.prepare_dataset(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    return rc.Dataset(run.output)[0]


@pytest.mark.proof
@pytest.mark.parametrize("arm", ["left", "right"])
def test_the_named_arm_picks_and_the_other_one_holds_still(tmp_path: Path, arm: str):
    run = rc.RunConfig.load(EXAMPLES / "duo" / "pick.yaml")
    run.task, run.episodes, run.output = {"kind": "pick", "arm": arm}, 1, str(tmp_path / "out")
    run.cameras.streams = []
    episode = pick_of(run)
    assert episode.success
    other = {"left": "right", "right": "left"}[arm]
    for name, moves in ((arm, True), (other, False)):
        q = episode[f"robots/duo/{name}/qpos"]
        assert (abs(q - q[0]).max() > 0.1) == moves
        assert f"robots/duo/action/{name}" in episode
        assert f"robots/duo/action/{name}_hand" in episode
