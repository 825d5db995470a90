"""Samplers and tasks written in Python: episodes of a kind that robocell does not know."""

from __future__ import annotations

import gc
import threading
from pathlib import Path

import pytest

import robocell as rc
from test_task import Idle, load


class Wait(rc.tasks.Task):
    """Success: some time has passed."""

    def __init__(self) -> None:
        super().__init__()
        self.began = -1.0

    def begin(self, scene: rc.Scene) -> None:
        self.began = scene.time()

    def reward(self, scene: rc.Scene) -> float:
        return scene.time() - self.began

    def success(self, scene: rc.Scene) -> bool:
        return self.reward(scene) >= 0.5

    def instruction(self) -> str:
        return "wait"

    def objects(self) -> list[str]:
        return ["cube"]


class Patient(Idle):
    """Does nothing either, and does not call that a failure."""

    def failure(self) -> str:
        return ""


class Waiting(rc.tasks.TaskSampler):
    """The robot beside a cube; refuses the first attempts."""

    def __init__(self, run: rc.RunConfig, refused: int = 0) -> None:
        super().__init__()
        self.run = run
        self.refused = refused
        self.asked: list[tuple[int, int, int, float]] = []

    def sample(
        self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
    ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
        x = rng.uniform(0.3, 0.5)
        self.asked.append((request.scene, request.episode, request.attempt, x))
        if request.attempt < self.refused:
            return rc.tasks.Refusal(rc.tasks.RefusalReason.NO_GRASP, "as told")
        spec = rc.SceneSpec(name="waiting", timestep=0.002, add_floor=True, add_skybox=False)
        cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, pos=[x, 0, 0.02])
        cube.rgba, cube.mass, cube.friction = [0.9, 0.2, 0.2, 1], 0.1, [1, 0.02, 0.001]
        spec.objects.append(cube)
        config = self.run.robot
        spec.robots.append(rc.RobotSpec(name=config.name, config=config, prefix="r/"))
        scene = rc.Scene.build(spec)
        scene.reset()
        return rc.tasks.EpisodeStart(scene, Wait(), "cube", ["box"])


def runner(run: rc.RunConfig, samplers: list[Waiting], refused: int = 0) -> rc.generate.Runner:
    """A runner with the sampler above, which is put into `samplers`."""

    def sampler(run: rc.RunConfig) -> rc.tasks.TaskSampler:
        samplers.append(Waiting(run, refused))
        return samplers[-1]

    return rc.generate.Runner(run, expert=lambda run, start: Patient(3), sampler=sampler)


def test_a_python_sampler_and_task_generate_episodes(tmp_path: Path):
    run = load(tmp_path)
    samplers: list[Waiting] = []
    result = runner(run, samplers, refused=2).run(rc.generate.make_plan(run)[0])
    gc.collect()
    assert (result.success, result.attempts, result.accepted) == (True, 3, 1)
    assert dict(result.refusals) == {"no grasp": 2}
    asked = samplers[0].asked
    assert [ask[:3] for ask in asked] == [(0, 0, 0), (0, 0, 1), (0, 0, 2)]
    episode = rc.Dataset(run.output)[0]
    assert episode.metadata["instruction"] == "wait"
    assert episode.metadata["task"] == "custom"
    assert episode.metadata["unregistered"] == ["sampler", "expert"]
    assert episode.metadata["target_object"] == "cube"
    assert episode["objects/cube/pose"][0, 0] == pytest.approx(asked[2][3], abs=1e-9)
    assert episode["reward"][-1] == pytest.approx(3 * run.rates.policy_ms / 1000, abs=1e-9)
    assert not episode["success"][0]
    assert episode["success"][-1]


def test_episodes_of_an_unregistered_sampler_do_not_pass_for_those_of_the_run(tmp_path: Path):
    run = load(tmp_path)
    plan = rc.generate.make_plan(run)
    runner(run, []).run(plan[0])
    other_parts = r"unregistered sampler and expert.*registered parts"
    with pytest.raises(rc.ArgumentError, match=other_parts):
        rc.generate.Runner(run).run(plan[1])
    assert len(rc.Dataset(run.output)) == 1
    with pytest.raises(rc.ArgumentError, match=r"no name in the dataset stands for it.*Register"):
        rc.envs.from_dataset(run.output)
    assert runner(run, []).run(plan[1]).success


def test_an_unregistered_expert_does_not_go_on_with_the_runs_own(tmp_path: Path):
    run = load(tmp_path)
    plan = rc.generate.make_plan(run)
    assert rc.generate.Runner(run).run(plan[0]).committed
    waiting = rc.generate.Runner(run, expert=lambda run, start: Patient(3))
    with pytest.raises(rc.ArgumentError, match=r"registered parts.*an unregistered expert"):
        waiting.run(plan[1])


def test_a_start_has_the_given_task():
    scene = rc.Scene.build(rc.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=False))
    task = Wait()
    assert rc.tasks.EpisodeStart(scene, task).task is task
    with pytest.raises(TypeError, match="task must be a Task, got 7"):
        rc.tasks.EpisodeStart(scene, 7)  # type: ignore[arg-type]


def test_the_scripted_sampler_can_be_called_and_wrapped(tmp_path: Path):
    run = load(tmp_path)
    own = rc.tasks.StartSampler(run)

    class First(rc.tasks.TaskSampler):
        """Hands on what the scripted one makes."""

        def sample(
            self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
        ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
            return own.sample(request, rng)

    item = rc.generate.make_plan(run)[0]
    wrapped = rc.generate.Runner(run, sampler=lambda run: First()).run(item)
    steps = (Path(run.output) / item.id / "steps.h5").read_bytes()
    assert wrapped.success
    run.output = str(tmp_path / "plain")
    rc.generate.prepare_dataset(run)
    assert rc.generate.Runner(run).run(item).success
    assert (Path(run.output) / item.id / "steps.h5").read_bytes() == steps


def test_a_wrapped_sampler_sees_the_stop_request(tmp_path: Path):
    run = load(tmp_path)
    own = rc.tasks.StartSampler(run)
    stop = rc.generate.StopFlag()
    kept: list[rc.tasks.SampleRequest] = []

    class Stopping(rc.tasks.TaskSampler):
        """Somebody asks for an end while the scripted one is about to begin."""

        def sample(
            self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
        ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
            assert not request.stopped
            stop.set()
            assert request.stopped
            kept.append(request)
            return own.sample(request, rng)

    result = rc.generate.Runner(run, sampler=lambda run: Stopping()).run(
        rc.generate.make_plan(run)[0], stop=stop
    )
    assert result.stopped
    assert not result.committed
    assert not kept[0].stopped, "the call is over"


def test_other_threads_run_while_a_start_is_sampled(tmp_path: Path):
    run = load(tmp_path)
    own = rc.tasks.StartSampler(run)
    turns: list[int] = []
    during: list[int] = []
    done = threading.Event()

    def count() -> None:
        while not done.wait(0.001):
            turns.append(1)

    class Watched(rc.tasks.TaskSampler):
        """Notes what another thread did meanwhile."""

        def sample(
            self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
        ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
            before = len(turns)
            result = own.sample(request, rng)
            during.append(len(turns) - before)
            return result

    thread = threading.Thread(target=count)
    thread.start()
    try:
        assert (
            rc.generate.Runner(run, sampler=lambda run: Watched())
            .run(rc.generate.make_plan(run)[0])
            .success
        )
    finally:
        done.set()
        thread.join()
    assert max(during) >= 3, "the interpreter was not held"


def test_rejects_invalid_samplers_and_starts(tmp_path: Path):
    class Wrong(rc.tasks.TaskSampler):
        def sample(self, request, rng):
            return "here"

    run = load(tmp_path)
    with pytest.raises(TypeError, match=r"sampler\(\) must return a TaskSampler, got 7"):
        rc.generate.Runner(run, sampler=lambda run: 7)  # type: ignore[arg-type, return-value]
    with pytest.raises(
        TypeError, match=r"sample\(\) must return an EpisodeStart or a Refusal, got 'here'"
    ):
        rc.generate.Runner(run, sampler=lambda run: Wrong()).run(rc.generate.make_plan(run)[0])


class Bound(Wait):
    """Cannot judge before it is bound."""

    def bind(self, scene: rc.Scene, setting: rc.tasks.TaskSetting) -> None:
        self.robot = scene.robot(setting.robots[0])

    def success(self, scene: rc.Scene) -> bool:
        return self.robot.name == "rc7"


def test_the_runner_binds_the_task_of_a_start(tmp_path: Path):
    class Sampler(Waiting):
        def sample(
            self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
        ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
            start = super().sample(request, rng)
            assert isinstance(start, rc.tasks.EpisodeStart)
            return rc.tasks.EpisodeStart(start.scene, Bound(), "cube", ["box"])

    run = load(tmp_path, max_attempts=1)
    runner = rc.generate.Runner(run, expert=lambda *_: Patient(3), sampler=Sampler)
    assert runner.run(rc.generate.make_plan(run)[0]).success


def test_a_task_explains_why_it_failed(tmp_path: Path):
    class Never(Wait):
        def success(self, scene: rc.Scene) -> bool:
            return False

        def why_not_done(self) -> str:
            return super().why_not_done() + ": too short a wait"

    class Sampler(Waiting):
        def sample(
            self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
        ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
            start = super().sample(request, rng)
            assert isinstance(start, rc.tasks.EpisodeStart)
            return rc.tasks.EpisodeStart(start.scene, Never(), "cube", ["box"])

    run = load(tmp_path, max_attempts=1)
    runner = rc.generate.Runner(run, expert=lambda *_: Patient(3), sampler=Sampler)
    failures = runner.run(rc.generate.make_plan(run)[0]).failures
    assert failures == {"the task was not done: too short a wait": 1}
