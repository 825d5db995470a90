"""The scripted pick task, changed in Python: what a subclass defines is what runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell.gym import pick_cube_config
from test_task import load


class Never(rc.tasks.PickTask):
    """Judges otherwise than PickTask, and asks it too."""

    def __init__(self, fields: rc.tasks.PickTaskConfig) -> None:
        super().__init__(fields)
        self.rewards: list[float] = []

    def choose_kinds(self, rng: rc.tasks.Rng) -> list[str]:
        return super().choose_kinds(rng)[:1]

    def reward(self, scene: rc.Scene) -> float:
        self.rewards.append(super().reward(scene))
        return 7 + self.rewards[-1]

    def success(self, scene: rc.Scene) -> bool:
        return len(self.rewards) >= 2

    def instruction(self) -> str:
        return "do not " + super().instruction()


class Recorder(rc.tasks.StartSampler):
    """Overrides every stage and hands on to the one it replaces."""

    def __init__(self, run: rc.RunConfig) -> None:
        super().__init__(run)
        self.stages: list[str] = []
        self.placement: rc.tasks.BasePlacement | None = None
        self.made: list[Never] = []

    def make_base_scene(self, scene_index):
        self.stages.append("make_base_scene")
        return super().make_base_scene(scene_index)

    def choose_base_placement(self, request, rng):
        self.stages.append("choose_base_placement")
        self.placement = rc.tasks.BasePlacement(
            0.44, super().choose_base_placement(request, rng).height
        )
        return self.placement

    def place_objects(self, support, objects, rng):
        self.stages.append("place_objects")
        assert super().place_objects(support, objects, rng)
        at = support.frame_to_world
        objects[0].pos = [at.translation[0], at.translation[1], objects[0].pos[2]]
        return True

    def propose_base_pose(self, robot, support, target_in_world, placement, rng):
        self.stages.append("propose_base_pose")
        return super().propose_base_pose(robot, support, target_in_world, placement, rng)

    def validate_base_pose(self, scene, robot, target_body):
        self.stages.append("validate_base_pose")
        return super().validate_base_pose(scene, robot, target_body)

    def make_task(self):
        self.stages.append("make_task")
        assert type(super().make_task()) is rc.tasks.PickTask
        self.made.append(Never(self.run.task))
        return self.made[-1]


STAGES = [
    "make_base_scene",
    "choose_base_placement",
    "place_objects",
    "propose_base_pose",
    "validate_base_pose",
    "make_task",
]


def sample(sampler: rc.tasks.TaskSampler, attempts: int = 20) -> rc.tasks.EpisodeStart:
    for attempt in range(attempts):
        made = sampler.sample(
            rc.tasks.SampleRequest(0, 0, attempt), rc.tasks.Rng.stream(attempt, "test")
        )
        if isinstance(made, rc.tasks.EpisodeStart):
            return made
    raise AssertionError(f"nothing accepted: {made}")


def target_body(start: rc.tasks.EpisodeStart) -> str:
    return next(name for name in start.scene.body_names() if name.startswith("target"))


def test_every_stage_of_a_samplers_subclass_runs(tmp_path: Path):
    sampler = Recorder(load(tmp_path))
    start = sample(sampler)
    assert sorted(set(sampler.stages)) == sorted(STAGES)
    assert len(start.object_kinds) == 1  # choose_kinds
    body = start.scene.body_pose(
        target_body(start)
    ).translation  # place_objects: in the table's middle
    assert body[:2] == pytest.approx([0, 0], abs=0.02)
    offset = start.base_in_world.translation - body
    assert (offset[0] ** 2 + offset[1] ** 2) ** 0.5 == pytest.approx(0.44, abs=0.02)
    assert start.task is sampler.made[-1]


def test_episodes_carry_the_labels_of_a_subclass_of_pick_task(tmp_path: Path):
    run = load(tmp_path)
    result = rc.generate.Runner(run, sampler=Recorder).run(rc.generate.make_plan(run)[0])
    assert result.success
    episode = rc.Dataset(run.output)[0]
    assert episode.metadata["instruction"].startswith("do not pick up the ")
    assert (episode["reward"] >= 7).all()
    first = int(episode["success"].argmax())
    assert first == 1  # the second row: its reward is the second that was asked for
    assert not episode["success"][:1].any()


def test_a_subclass_that_overrides_nothing_changes_nothing(tmp_path: Path):
    class Same(rc.tasks.StartSampler):
        pass

    run = load(tmp_path)
    item = rc.generate.make_plan(run)[0]
    assert rc.generate.Runner(run, sampler=Same).run(item).success
    steps = (Path(run.output) / item.id / "steps.h5").read_bytes()
    run.output = str(tmp_path / "plain")
    rc.generate.prepare_dataset(run)
    assert rc.generate.Runner(run).run(item).success
    assert (Path(run.output) / item.id / "steps.h5").read_bytes() == steps


def test_the_sample_of_a_subclass_runs_and_can_call_the_scripted_one(tmp_path: Path):
    class Second(rc.tasks.StartSampler):
        def sample(self, request, rng):
            if request.attempt == 0:
                return rc.tasks.Refusal(rc.tasks.RefusalReason.CAMERA_CONSTRAINT, "as told")
            return super().sample(request, rng)

    run = load(tmp_path)
    result = rc.generate.Runner(run, sampler=Second).run(rc.generate.make_plan(run)[0])
    assert result.success
    assert dict(result.refusals)["camera constraint"] == 1


def test_refusals_of_a_stage_are_counted_with_the_places_tried(tmp_path: Path):
    class Picky(rc.tasks.StartSampler):
        def validate_base_pose(self, scene, robot, target_body):
            return rc.tasks.Refusal(rc.tasks.RefusalReason.BASE_IN_COLLISION, "as told")

    run = load(tmp_path, max_attempts=2)
    report = rc.generate.Runner(run, sampler=Picky).run(rc.generate.make_plan(run)[0])
    reason = "base: no base pose is free of collisions"
    assert (report.attempts, report.accepted, dict(report.refusals)) == (2, 0, {reason: 2})
    assert dict(report.redrawn) == {reason: 2 * 7}  # of 8 places each, the last is the refusal


def test_check_start_of_a_task_refuses_and_can_ask_the_scripted_one(tmp_path: Path):
    asked: list[rc.tasks.Refusal | None] = []

    class Choosy(rc.tasks.PickTask):
        def check_start(self, scene):
            asked.append(super().check_start(scene))
            return None if len(asked) > 1 else rc.tasks.Refusal("too dull", "as told")

    class Sampler(rc.tasks.StartSampler):
        def make_task(self):
            return Choosy(self.run.task)

    start = sample(Sampler(load(tmp_path)))
    assert dict(start.redrawn)["task: too dull"] == 1
    assert asked[-1] is None
    assert start.task.kind_of("target") == start.object_kinds[0]
    robot = start.scene.robot("rc7")
    assert rc.tasks.check_grasps(start.scene, robot, "target") is None
    refusal = rc.tasks.check_grasps(start.scene, robot, "target", lift_height=2)
    assert refusal is not None
    assert refusal.detail.startswith("grasps: ")


def test_the_scripted_expert_can_be_extended(tmp_path: Path):
    class Slow(rc.tasks.PickPlanner):
        """Waits before it begins."""

        def __init__(self, run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> None:
            super().__init__(run, start)
            self.waits = 5

        def act(self, scene, rng):
            self.waits -= 1
            return {} if self.waits >= 0 else super().act(scene, rng)

        def phase_names(self):
            return [*super().phase_names(), "extra"]

    run = load(tmp_path)
    item = rc.generate.make_plan(run)[0]
    assert rc.generate.Runner(run).run(item).success
    plain = rc.Dataset(run.output)[0]
    run.output = str(tmp_path / "slow")
    rc.generate.prepare_dataset(run)
    assert rc.generate.Runner(run, expert=Slow).run(item).success
    slow = rc.Dataset(run.output)[0]
    assert (slow["phase"][:6] == 0).all()
    assert len(slow) >= len(plain) + 4


def test_rejects_invalid_results_of_a_stage(tmp_path: Path):
    class NoTask(rc.tasks.StartSampler):
        def make_task(self):
            return 7

    class Fewer(rc.tasks.StartSampler):
        def place_objects(self, support, objects, rng):
            objects.clear()
            return True

    class Two(rc.tasks.PickTask):
        def choose_kinds(self, rng):
            return ["box", "cylinder"]

    class Swapped(rc.tasks.StartSampler):
        def make_task(self):
            return Two(self.run.task)

        def place_objects(self, support, objects, rng):
            placed = super().place_objects(support, objects, rng)
            objects.reverse()
            return placed

    run = load(tmp_path)
    with pytest.raises(TypeError, match=r"make_task\(\) must return a Task, got 7"):
        sample(NoTask(run))
    with pytest.raises(rc.ArgumentError, match=r"place_objects\(\) must not change which objects"):
        sample(Fewer(run))
    with pytest.raises(rc.ArgumentError, match="nor their order, only their poses"):
        sample(Swapped(run))


def test_errors_name_a_stage_that_returns_none(tmp_path: Path):
    class Nowhere(rc.tasks.StartSampler):
        def choose_base_placement(self, request, rng):
            return None

        def validate_base_pose(self, scene, robot, target_body):
            return "free"

    run = load(tmp_path)
    wanted = r"Nowhere.choose_base_placement\(\) must return a BasePlacement, got None"
    with pytest.raises(TypeError, match=wanted):
        rc.generate.Runner(run, sampler=Nowhere).run(rc.generate.make_plan(run)[0])
    del Nowhere.choose_base_placement
    wanted = r"Nowhere.validate_base_pose\(\) must return a Refusal or None, got 'free'"
    with pytest.raises(TypeError, match=wanted):
        rc.generate.Runner(run, sampler=Nowhere).run(rc.generate.make_plan(run)[0])


class BesideAPool(rc.tasks.StartSampler):
    """A second mug and a block as large as the room, both parked."""

    def make_base_scene(self, scene_index: int) -> rc.SceneSpec:
        spec = super().make_base_scene(scene_index)
        spec.objects.append(
            rc.SceneObject(name="spare", mjcf_path="mug", pos=[0, 0, 0.8], fixed=False, parked=True)
        )
        block = rc.SceneObject(name="block", shape=rc.Shape.BOX, size=[0.8, 0.8, 0.5], parked=True)
        block.pos, block.rgba, block.mass = [0, 0, 1.2], [1, 0, 0, 1], 5
        block.friction = [1, 0.02, 0.001]
        spec.objects.append(block)
        return spec


def test_parked_objects_are_not_sampled_and_collide_with_nothing(tmp_path: Path):
    run = load(tmp_path)
    start, alone = sample(BesideAPool(run)), sample(rc.tasks.StartSampler(run))
    assert start.object_kinds == alone.object_kinds
    assert start.task.objects() == alone.task.objects()
    assert start.scene.parked_objects == ["spare", "block"]
    assert start.scene.contacts("block") == []


def test_every_method_of_the_pick_task_can_be_called_by_a_subclass():
    class Mine(rc.tasks.PickTask):
        def memory(self):
            return [*super().memory(), 5]

        def recall(self, memory):
            assert memory[-1] == 5
            super().recall(memory[:-1])

        def starts(self, rng):
            return super().starts(rng)

    config = pick_cube_config()
    scene = rc.Env(config).scene
    task = Mine("cube", "cube", ["cube"])
    task.begin(scene)
    memory = task.memory()
    assert len(memory) == 4
    task.recall(np.asarray(memory))
    assert set(task.starts(rc.tasks.Rng.stream(0, "test"))) == {
        scene.compiled.object("cube").root_body
    }
