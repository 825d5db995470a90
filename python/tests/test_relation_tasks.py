"""Tasks whose goals are relations: their fields, their errors, environments and runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc

EXAMPLES = Path(__file__).parents[2] / "examples" / "tasks"
KINDS = ("stack", "place_next_to", "open", "close", "press", "push", "relations")


def test_every_kind_has_an_expert_an_example_and_a_class():
    for kind in KINDS:
        assert kind in rc.tasks.task_kinds()
        assert kind in rc.tasks.expert_kinds()
        run = rc.RunConfig.load(EXAMPLES / f"{kind}.yaml")
        assert run.task.kind == kind
        assert type(run.task).__name__.endswith("TaskConfig")


def test_the_fields_are_attributes_and_survive_yaml():
    run = rc.RunConfig.load(EXAMPLES / "relations.yaml")
    run.task = rc.tasks.RelationsTaskConfig(objects=["mug", "tray"], goal=["mug on tray"])
    again = rc.RunConfig.from_yaml(run.to_yaml())
    assert again.task == run.task
    assert list(again.task.goal) == ["mug on tray"]
    assert again.task.hold_seconds == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("task", "place", "text"),
    [
        ("{kind: relations}", "3:7", "write at least one relation"),
        ("{kind: relations, goal: [mug insde tray]}", "3:32", "Did you mean 'inside'?"),
        ("{kind: relations, goal: [a on b], start: [a on b, c]}", "3:57", "is no relation"),
        ("{kind: relations, objects: [mgu], goal: [a on b]}", "3:35", "Did you mean 'mug'?"),
        ("{kind: stack, cubes: 9}", "3:28", "a stack has 2 to 6 cubes"),
        ("{kind: open, opening: 0.3, start_opening: [0, 0.4]}", "3:49", "leave something to open"),
        ("{kind: close, start_opening: [0.1, 0.4]}", "3:36", "leave something to close"),
        ("{kind: push, distance: [0.01, 0.1]}", "3:30", "within the region"),
        ("{kind: pour, objects: [box, open_bottle]}", "3:30", "'box' has no hollow"),
        ("{kind: pour, receivers: [box]}", "3:32", "'box' has no hollow"),
        ("{kind: pour, grains: 200}", "3:28", "200 grains with a radius of 0.005 m do not fit"),
        ("{kind: wipe, share: 0}", "3:27", "holds at every start"),
        ("{kind: relations, goal: [a inserted b 5]}", "3:32", "has the share 5"),
        ("{kind: press, objects: [buton]}", "3:31", "no kind of object 'buton'"),
    ],
)
def test_mistakes_are_named_with_their_place(tmp_path: Path, task: str, place: str, text: str):
    file = tmp_path / "run.yaml"
    file.write_text(f"run: a\nrobot: rc7\ntask: {task}\noutput: out\n")
    with pytest.raises(rc.SpecError) as raised:
        rc.RunConfig.load(file)
    assert text in str(raised.value)
    assert f"run.yaml:{place}" in str(raised.value)


@pytest.mark.parametrize("kind", ["stack", "press"])
def test_an_environment_has_the_task_too(kind: str):
    rc7 = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    env = rc.Env(rc.EnvConfig(robots={"rc7": rc7}, task={"kind": kind}, relative_to="last_step"))
    for seed in range(3):
        env.reset(seed=seed)
        env.save("start")
        stay = {"rc7": {"joints": [0.0] * 7, "gripper": 1}}
        first, reward, terminated, _, _ = env.step(stay)
        assert 0 <= reward < 1
        assert not terminated
        env.restore("start")
        again, same_reward, _, _, _ = env.step(stay)
        assert same_reward == reward
        np.testing.assert_equal(again, first)
    assert env.instruction.startswith(
        {"stack": "put the blue cube on", "press": "press the "}[kind]
    )


def test_a_run_presses_a_button_and_records_the_opening(tmp_path: Path):
    run = rc.RunConfig.load(EXAMPLES / "press.yaml")
    run.cameras.streams.clear()
    run.output, run.episodes = str(tmp_path / "out"), 1
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        assert runner.run(item).success
    episode = rc.Dataset(run.output)[0]
    assert np.max(episode["task/opening"]) > 0.7
    assert episode.metadata["instruction"].startswith("press the ")
    names = episode.column("phase").values
    seen = [names[i] for i in np.unique(episode["phase"])]
    assert {"reach", "approach", "press", "retreat"} <= set(seen)


def test_relations_are_judged_and_sampled_from_python():
    spec = rc.SceneSpec(name="a", timestep=0.002, add_floor=True, add_skybox=True)
    for name, x in (("red", 0.0), ("blue", 0.3)):
        cube = rc.SceneObject(name=name, shape=rc.Shape.BOX, size=[0.02] * 3, mass=0.1)
        cube.rgba, cube.friction, cube.pos = [1, 0, 0, 1], [1, 0.02, 0.001], [x, 0, 0.02]
        spec.objects.append(cube)
    scene = rc.Scene.build(spec)
    scene.reset()
    assert not rc.tasks.relation_holds(scene, "red next_to blue")
    rng = rc.tasks.Rng.stream(1, "poses")
    for pose in rc.tasks.relation_poses(scene, "red next_to blue", rng, 4):
        scene.set_body_pose("red", pose)
        scene.forward()
        assert rc.tasks.relation_holds(scene, "red next_to blue")
    for count in (-1, 0, 10**9):
        with pytest.raises(rc.ArgumentError, match="count: expected a number from 1 to 10000"):
            rc.tasks.relation_poses(scene, "red next_to blue", rng, count)
    with pytest.raises(rc.ArgumentError, match="takes '<=' only"):
        rc.tasks.relation_holds(scene, "red next_to blue >= 0.1")
    assert "held" in rc.tasks.relations()
    with pytest.raises(rc.ArgumentError, match="Did you mean 'next_to'"):
        rc.tasks.relation_holds(scene, "red nextto blue")
