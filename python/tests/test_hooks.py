"""What a user's code returns wrongly ends the attempt with the place of the code."""

from __future__ import annotations

import asyncio
import inspect
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import robocell as rc
from robocell._raised import LostPolicyError, UnmadePolicyError
from robocell.control import GroupCommand
from robocell.gym import pick_cube_config
from test_task import Idle, load


class Cube(rc.tasks.Task):
    """A cube on the table; subclasses return something wrong."""

    def prepare(self, spec: rc.SceneSpec, rng: rc.tasks.Rng) -> None:
        cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, mass=0.1)
        cube.rgba, cube.friction = [1, 0.5, 0, 1], [1, 0.02, 0.001]
        spec.objects.append(cube)

    def instruction(self) -> str:
        return "touch the cube"

    def objects(self) -> list[str]:
        return ["cube"]

    def base_range(self) -> rc.tasks.BaseRange:
        return rc.tasks.BaseRange(distance=[0.35, 0.4], height_offset=-0.25)


class Touch(Cube):
    def judge(self, scene: rc.Scene) -> Any:
        return rc.tasks.TaskVerdict()


class Judges(Touch):
    def judge(self, scene: rc.Scene) -> Any:
        return None


class JudgesNan(Touch):
    def judge(self, scene: rc.Scene) -> Any:
        return rc.tasks.TaskVerdict(reward=float("nan"))


class Overdone(Touch):
    def judge(self, scene: rc.Scene) -> Any:
        return rc.tasks.TaskVerdict(progress=7)


class Rewards(Cube):
    def success(self, scene: rc.Scene) -> bool:
        return False

    def reward(self, scene: rc.Scene) -> Any:
        return "much"


class Counts(Touch):
    def subtasks(self) -> list[str]:
        return ["one"]

    def judge(self, scene: rc.Scene) -> Any:
        return rc.tasks.TaskVerdict(subtask=3)


class Arranges(Touch):
    def arrange(self, scene: rc.Scene, rng: rc.tasks.Rng) -> Any:
        return "no"


class Observes(Touch):
    def signals(self) -> Any:
        return {"a": ([0, 0], [1, 1])}

    def observe(self, scene: rc.Scene) -> Any:
        return {"a": [0.5]}


class Starts(Touch):
    def starts(self, rng: rc.tasks.Rng) -> Any:
        return {"cubee": rc.Pose()}


class Names(Touch):
    def objects(self) -> list[str]:
        return ["cubee"]


class NamesTwice(Touch):
    def objects(self) -> list[str]:
        return ["cube", "cube"]


class SignalsNoPath(Touch):
    def signals(self) -> Any:
        return {"..": ([0], [1])}


class SignalsInsideEachOther(Touch):
    def signals(self) -> Any:
        return {"a": ([0], [1]), "a/b": ([0], [1])}


class Exits(Touch):
    def judge(self, scene: rc.Scene) -> Any:
        raise SystemExit(3)


class RangesBackwards(Touch):
    def base_range(self) -> rc.tasks.BaseRange:
        return rc.tasks.BaseRange(distance=[0.5, 0.3])


class RangesNan(Touch):
    def base_range(self) -> rc.tasks.BaseRange:
        return rc.tasks.BaseRange(height_offset=float("nan"))


class RangesBehind(Touch):
    def base_range(self) -> rc.tasks.BaseRange:
        return rc.tasks.BaseRange(distance=[-1, -0.5])


class PreparesTimestep(Cube):
    def prepare(self, spec: rc.SceneSpec, rng: rc.tasks.Rng) -> None:
        super().prepare(spec, rng)
        spec.timestep = 0.01

    def judge(self, scene: rc.Scene) -> Any:
        return rc.tasks.TaskVerdict()


def ball_of(radius: float) -> rc.SceneObject:
    ball = rc.SceneObject(name="ball", shape=rc.Shape.SPHERE, size=[radius, 0, 0], mass=0.1)
    ball.rgba, ball.friction = [1, 0.5, 0, 1], [1, 0.02, 0.001]
    return ball


class PreparesTwice(Touch):
    def prepare(self, spec: rc.SceneSpec, rng: rc.tasks.Rng) -> None:
        ball = ball_of(0.03)
        spec.objects.append(ball)
        spec.objects.append(ball)


class PreparesMillimetres(Touch):
    def prepare(self, spec: rc.SceneSpec, rng: rc.tasks.Rng) -> None:
        spec.objects.append(ball_of(150))


class Mute(Touch):
    def instruction(self) -> str:
        return " "


class Prepares(Touch):
    def prepare(self, spec: rc.SceneSpec, rng: rc.tasks.Rng) -> None:
        spec.objects.append(rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[-1, 1, 1]))


def run_of(folder: Path, task: type[rc.tasks.Task], **fields: Any) -> rc.RunConfig:
    folder.mkdir()
    run = load(folder)
    name = f"{task.__name__.lower()}_of_hooks"
    rc.register_task(name)(task)
    run.task, run.max_attempts, run.output = {"kind": name}, 4, str(folder / "hooks")
    for field, value in fields.items():
        setattr(run, field, value)
    rc.generate.prepare_dataset(run, validate=False)
    return run


def failure_of(
    folder: Path, task: type[rc.tasks.Task], expert: Callable[..., rc.tasks.Expert], **fields: Any
) -> str:
    """Why one attempt failed; the error that ends the item after three of them says the same."""
    run = run_of(folder / "three", task, **fields)
    with pytest.raises((TypeError, rc.Error)) as caught:
        rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    run = run_of(folder / "two", task, max_attempts=2, **fields)
    result = rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    assert sum(result.failures.values()) == 2
    texts = {re.sub(r"t = [\d.]+ s", "t", text) for text in result.failures}
    assert texts == {re.sub(r"t = [\d.]+ s", "t", str(caught.value))}
    assert not list(rc.Dataset(run.output))
    return texts.pop()


def failure_once(
    folder: Path, task: type[rc.tasks.Task], expert: Callable[..., rc.tasks.Expert], **fields: Any
) -> str:
    """Why the only attempt failed. What errors do to an item is tried with those of tasks."""
    run = run_of(folder / "once", task, max_attempts=1, **fields)
    result = rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    (text,) = result.failures
    assert result.failures[text] == 1
    assert not list(rc.Dataset(run.output))
    return text


def place(function: Callable[..., Any]) -> str:
    code = inspect.unwrap(function).__code__
    return f"({__file__}:{code.co_firstlineno}, in {code.co_name})"


@pytest.mark.parametrize(
    ("task", "method", "text"),
    [
        (Judges, "judge", "Judges.judge() must return a TaskVerdict, got None"),
        (JudgesNan, "judge", "the task's reward is nan at t; rewards must be finite numbers"),
        (Rewards, "reward", "Rewards.reward() must return a number, got 'much'"),
        (Arranges, "arrange", "Arranges.arrange() must return a Refusal or None, got 'no'"),
        (Observes, "observe", "Observes.observe().a has shape (1), and (2) was declared"),
        (Starts, "starts", "no body 'cubee'"),
        (Names, "objects", "no object 'cubee'"),
        (SignalsNoPath, "signals", "'..' is not a valid part of a path"),
        (RangesBackwards, "base_range", "the distance of a base range is [0.5, 0.3]"),
        (Prepares, "prepare", "prepare added object 'cube', which is not valid"),
        # Others of the same methods.
        *(
            pytest.param(*case, marks=pytest.mark.proof)
            for case in (
                (
                    Overdone,
                    "judge",
                    "the task's progress is 7 at t; it must be a number from 0 to 1",
                ),
                (Counts, "judge", "the task's subtask is 3; it must be 0 to 0"),
                (NamesTwice, "objects", "objects() names 'cube' twice"),
                (SignalsInsideEachOther, "signals", "one name is a folder of the other"),
                (RangesBehind, "base_range", "the distance of a base range is [-1, -0.5]"),
                (RangesNan, "base_range", "the height_offset of a base range is nan"),
            )
        ),
    ],
)
def test_an_invalid_task_result_ends_the_rollout(
    tmp_path: Path, task: type[Cube], method: str, text: str
):
    said = failure_of(tmp_path, task, lambda *_: Idle())
    assert text in said
    assert said.endswith(place(getattr(task, method)))


@pytest.mark.parametrize(
    ("task", "text"),
    [
        (JudgesNan, "the task's reward is nan at t; rewards must be finite numbers"),
        (Overdone, "the task's progress is 7 at t; it must be a number from 0 to 1"),
        (Counts, "the task's subtask is 3; it must be 0 to 0, an index into subtasks(): one"),
    ],
)
def test_environments_reject_the_same_verdicts(
    tmp_path: Path, task: type[rc.tasks.Task], text: str
):
    def said(step: Callable[[], Any]) -> str:
        with pytest.raises(rc.ArgumentError) as caught:
            step()
        return re.sub(r"t = [\d.]+ s", "t", str(caught.value))

    run = run_of(tmp_path / "run", task)
    run_env = rc.envs.RunEnv(run)
    run_env.reset(0)
    at = place(task.judge)
    assert said(lambda: run_env.act({})) == f"run '{run.run}': {text} {at}"
    with pytest.raises(rc.Error, match="the episode is over; call reset"):
        run_env.act({})
    config = rc.EnvConfig(
        robots={"robot": rc.models.robot_file("rc7")}, task=run.task, name="duo", add_floor=True
    )
    env = rc.Env(config)
    env.reset(seed=0)
    action = {"robot": {"joints": [0] * 7, "gripper": 1}}
    assert said(lambda: env.step(action)) == f"environment 'duo': {text} {at}"
    with pytest.raises(rc.Error, match="call reset to go on"):
        env.step(action)


class Lies(Touch):
    def resting_objects(self) -> list[str]:
        return ["cubee"]


@pytest.mark.parametrize(
    ("task", "method", "text"),
    [
        (Starts, "starts", "no body 'cubee'"),
        (Lies, "resting_objects", "no object 'cubee'"),
        (Arranges, "arrange", "Arranges.arrange() must return a Refusal or None, got 'no'"),
        (Names, "objects", "no object 'cubee'"),
        (RangesBackwards, "base_range", "the distance of a base range is [0.5, 0.3]"),
    ],
)
def test_environments_and_runs_reject_a_start_alike(
    tmp_path: Path, task: type[rc.tasks.Task], method: str, text: str
):
    def said(make: Callable[[], Any]) -> type:
        with pytest.raises((TypeError, rc.Error)) as caught:
            make()
        assert text in str(caught.value)
        assert str(caught.value).endswith(place(getattr(task, method)))
        return caught.type

    run = run_of(tmp_path / "run", task)
    in_run = said(lambda: rc.envs.RunEnv(run).reset(0))
    config = rc.EnvConfig(
        robots={"robot": rc.models.robot_file("rc7")}, task=run.task, name="duo", add_floor=True
    )
    assert said(lambda: rc.Env(config).reset(seed=0)) is in_run


@pytest.mark.parametrize(
    ("action", "text"),
    [
        (None, "Acts.act() must return {robot: {group: GroupCommand}}: got None"),
        ({"rc8": {}}, "no robot 'rc8'"),
        ({"rc7": {"arms": GroupCommand.opening(1)}}, "no group 'arms'"),
        ({"rc7": {"arm": GroupCommand.joints([0.0])}}, "7"),
        ({"rc7": {"arm": GroupCommand.joints(np.full(7, np.nan))}}, "nan"),
    ],
)
def test_an_invalid_action_ends_the_rollout(tmp_path: Path, action: Any, text: str):
    class Acts(Idle):
        def act(self, scene: rc.Scene, rng: rc.tasks.Rng) -> Any:
            return action

    said = failure_once(tmp_path, Touch, lambda *_: Acts())
    assert text in said
    assert said.endswith(place(Acts.act))


@pytest.mark.parametrize("numbers", [[1.0, 2.0, 3.0], [float("nan"), 0.0], None])
def test_an_invalid_feature_value_ends_the_rollout(tmp_path: Path, numbers: Any):
    @rc.features.register_feature("pair_of_hooks", shape=[2])
    def pair(scene: rc.Scene) -> Any:
        return numbers

    said = failure_once(tmp_path, Touch, lambda *_: Idle(), features=["pair_of_hooks"])
    assert "feature 'pair_of_hooks'" in said or "feature 'features/pair_of_hooks' is nan" in said
    assert said.endswith(place(pair))


def test_one_invalid_result_costs_one_rollout(tmp_path: Path):
    class Once(Idle):
        wrong: ClassVar = [True]

        def failure(self) -> Any:
            return None if self.wrong and self.wrong.pop() else "idle"

    run = run_of(tmp_path / "run", Touch, max_attempts=2)
    result = rc.generate.Runner(run, expert=lambda *_: Once()).run(rc.generate.make_plan(run)[0])
    text = "Once.failure() must return a str, got None " + place(Once.failure)
    assert result.failures == {text: 1, "idle": 1}


def test_one_none_action_costs_one_rollout(tmp_path: Path):
    class Once(Idle):
        wrong: ClassVar = [True]

        def act(self, scene: rc.Scene, rng: rc.tasks.Rng) -> Any:
            return None if self.wrong and self.wrong.pop() else super().act(scene, rng)

    run = run_of(tmp_path / "run", Touch, max_attempts=2)
    result = rc.generate.Runner(run, expert=lambda *_: Once()).run(rc.generate.make_plan(run)[0])
    text = "Once.act() must return {robot: {group: GroupCommand}}: got None " + place(Once.act)
    assert result.failures == {text: 1, "idle": 1}


def test_errors_name_the_function_that_makes_a_task(tmp_path: Path):
    @rc.register_task("nothing_of_hooks")
    def nothing() -> Any:
        return 7

    run = run_of(tmp_path / "run", Touch)
    run.task, run.output = {"kind": "nothing_of_hooks"}, str(tmp_path / "nothing")
    with pytest.raises(TypeError, match="must return a Task, got 7") as caught:
        rc.generate.Runner(run, expert=lambda *_: Idle())
    assert str(caught.value).endswith(place(nothing))


@pytest.mark.parametrize(
    "values", [np.zeros(6), np.zeros((3, 2)), [[0.0, 0.0]] * 3, 1.0, [1.0], np.zeros((1, 2, 3))]
)
def test_a_feature_of_the_wrong_shape_ends_the_rollout(tmp_path: Path, values: Any):
    @rc.features.register_feature("table_of_hooks", shape=[2, 3])
    def table(scene: rc.Scene) -> Any:
        return values

    said = failure_once(tmp_path, Touch, lambda *_: Idle(), features=["table_of_hooks"])
    found = "(" + ", ".join(map(str, np.shape(values))) + ")"
    assert f"feature 'table_of_hooks' has shape {found}, and (2, 3) was declared" in said
    assert said.endswith(place(table))


@pytest.mark.parametrize("value", [True, np.True_, np.array(True)])
def test_a_feature_can_be_boolean(tmp_path: Path, value: Any):
    rc.features.register_feature("flag_of_hooks")(lambda scene: value)
    run = run_of(tmp_path / "run", Touch, features=["flag_of_hooks"], max_attempts=1, keep="all")
    rc.generate.Runner(run, expert=lambda *_: Idle()).run(rc.generate.make_plan(run)[0])
    assert rc.Dataset(run.output)[0]["features/flag_of_hooks"].tolist() == [1, 1, 1]


@pytest.mark.parametrize(("shape", "value"), [((), [1.0]), ((1,), 1.0), ((1,), np.ones(1))])
def test_a_scalar_feature_can_have_shape_one(tmp_path: Path, shape: Any, value: Any):
    rc.features.register_feature("one_of_hooks", shape=shape)(lambda scene: value)
    run = run_of(tmp_path / "run", Touch, features=["one_of_hooks"], max_attempts=1, keep="all")
    rc.generate.Runner(run, expert=lambda *_: Idle()).run(rc.generate.make_plan(run)[0])
    assert rc.Dataset(run.output)[0]["features/one_of_hooks"].shape == (3, *shape)


@pytest.mark.parametrize(
    ("task", "message"),
    [
        (PreparesTwice, r"prepare\(\) added object '\w+' twice to scene .*append each object once"),
        (PreparesMillimetres, r"object 'ball' is 300 m large.*in millimetres it would be 0.3 m"),
    ],
)
def test_objects_that_no_scene_can_have_are_refused_before_the_first_episode(
    tmp_path: Path, task: type[rc.tasks.Task], message: str
):
    with pytest.raises(rc.ArgumentError, match=message) as caught:
        run_of(tmp_path / "run", task)
    name = f"{task.__name__.lower()}_of_hooks"
    assert f"task '{name}': prepare() added" in str(caught.value)
    assert "test_hooks.py:" in str(caught.value)
    with pytest.raises(rc.Error, match=message):
        rc.Env(pick_cube_config(task={"kind": name}))


def test_an_instruction_without_words_is_warned_of(tmp_path: Path):
    run = run_of(tmp_path / "run", Mute)
    rc.tasks.register_expert("mute_of_hooks")(lambda run, start: Idle())
    run.expert = "mute_of_hooks"
    (finding,) = rc.diagnose.check_run(run)
    assert finding.subject == "task"
    assert finding.severity == rc.diagnose.Severity.WARNING
    warning = finding.line
    assert "task 'mute_of_hooks': instruction() has no words" in warning
    assert "such as 'pick up the mug'" in warning
    assert "test_hooks.py:" in warning


def test_rejects_a_task_that_changes_the_timestep_before_the_first_episode(tmp_path: Path):
    with pytest.raises(rc.ArgumentError) as caught:
        run_of(tmp_path / "run", PreparesTimestep)
    assert "prepare() changed the timestep of scene 'tiny' from 0.002 s to 0.01 s" in str(
        caught.value
    )
    assert str(caught.value).endswith(place(PreparesTimestep.prepare))


def test_sys_exit_in_a_hook_ends_the_rollout(tmp_path: Path):
    run = run_of(tmp_path / "run", Exits, max_attempts=2)
    result = rc.generate.Runner(run, expert=lambda *_: Idle()).run(rc.generate.make_plan(run)[0])
    line = Exits.judge.__code__.co_firstlineno + 1
    assert result.failures == {f"SystemExit: 3 ({__file__}:{line}, in judge)": 2}


def test_a_sampler_scene_with_another_timestep_ends_the_rollout(tmp_path: Path):
    class Slow(rc.tasks.TaskSampler):
        def __init__(self, run: rc.RunConfig) -> None:
            super().__init__()
            self.run = run

        def sample(self, request: Any, rng: rc.tasks.Rng) -> Any:
            spec = rc.SceneSpec(name="slow", timestep=0.004, add_floor=True, add_skybox=True)
            spec.robots.append(rc.RobotSpec(name="rc7", config=self.run.robot))
            return rc.tasks.EpisodeStart(rc.Scene.build(spec), Touch(), "")

    run = run_of(tmp_path / "run", Touch, max_attempts=2)
    runner = rc.generate.Runner(run, sampler=Slow, expert=lambda *_: Idle())
    (said,) = runner.run(rc.generate.make_plan(run)[0]).failures
    assert "scene 'slow' was built with a timestep of 0.004 s, and `rates` has one of 0.002 s" in (
        said
    )


def test_rejects_a_scene_source_with_another_timestep(tmp_path: Path):
    @rc.scenes.register_scene_source("slow_of_hooks")
    class Slow(rc.scenes.SceneSource):
        timestep = 0.003

        def size(self) -> int:
            return 1

        def make(self, index: int) -> rc.SceneSpec:
            return rc.SceneSpec(base="tabletop", timestep=self.timestep, add_skybox=True)

    run = load(tmp_path)
    run.scenes, run.output = {"source": "slow_of_hooks"}, str(tmp_path / "slow")
    with pytest.raises(rc.SpecError) as caught:
        rc.generate.prepare_dataset(run)
    assert "scene 0 with a timestep of 0.003 s, and `rates` has one of 0.002 s" in str(caught.value)
    assert "sim_ms: 3" in str(caught.value)
    Slow.timestep = 0.002
    rc.generate.prepare_dataset(run)


def test_rejects_a_fixed_base_before_the_first_episode(tmp_path: Path):
    rc.register_task("fixed_of_hooks")(Touch)
    rc.tasks.register_expert("fixed_of_hooks")(lambda run, start: Idle())
    run = load(tmp_path)
    run.task, run.output = {"kind": "fixed_of_hooks"}, str(tmp_path / "fixed")
    run.robot.base = {"kind": "fixed"}
    with pytest.raises(rc.SpecError) as caught:
        rc.generate.prepare_dataset(run)
    assert (
        "robot.base.kind: the robot stands where `start` or base_range() of the task puts it"
        in (str(caught.value))
    )


def test_a_misspelt_field_suggests_both_candidates():
    with pytest.raises(rc.SpecError, match=r"'goalz'.* Did you mean 'goal' or 'goals'\?"):
        rc.RunConfig.from_yaml("run: a\ntask: {kind: pick_and_place, goalz: [tray]}\n", "a.yaml")


class PanicError(BaseException):
    """What extensions in Rust raise."""


class Raises(Idle):
    """Raises at the end of the first action."""

    error: ClassVar[BaseException] = ValueError("two\nlines")

    def done(self) -> bool:
        raise self.error


def evaluated(
    folder: Path, expert: Callable[..., rc.tasks.Expert], task: type[rc.tasks.Task] = Touch
) -> rc.generate.ItemResult:
    """One rollout of an evaluation."""
    run = run_of(folder / "run", task, keep="first")
    return rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (ValueError("two\nlines"), "ValueError: two lines"),
        (rc.IoError("no disk"), "no disk"),
        (asyncio.CancelledError("late"), "CancelledError: late"),
        (PanicError("on a None value"), "PanicError: on a None value"),
        (SystemExit(2), "SystemExit: 2"),
    ],
)
def test_in_an_evaluation_an_error_of_the_expert_fails_the_rollout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException, text: str
):
    monkeypatch.setattr(Raises, "error", error)
    line = Raises.done.__code__.co_firstlineno + 1
    result = evaluated(tmp_path, lambda *_: Raises())
    assert result.committed
    assert result.failures == {f"policy error: {text} ({__file__}:{line}, in done)": 1}


def test_in_an_evaluation_an_expert_that_cannot_be_made_fails_the_rollout(tmp_path: Path):
    def make(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        raise ImportError("no weights")

    line = make.__code__.co_firstlineno + 1
    result = evaluated(tmp_path, make)
    assert result.failures == {
        f"policy error: ImportError: no weights ({__file__}:{line}, in make)": 1
    }


def test_a_spec_error_of_the_maker_ends_an_evaluation(tmp_path: Path):
    def make(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        raise rc.SpecError("no such weights")

    with pytest.raises(rc.SpecError, match="no such weights"):
        evaluated(tmp_path, make)


@pytest.mark.parametrize(
    "error",
    [
        KeyboardInterrupt(),
        GeneratorExit(),
        LostPolicyError("gone"),
        UnmadePolicyError("no weights"),
    ],
)
def test_an_interrupt_or_the_want_of_a_policy_is_no_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
):
    monkeypatch.setattr(Raises, "error", error)
    with pytest.raises(type(error)):
        evaluated(tmp_path, lambda *_: Raises())
    assert not list(rc.Dataset(tmp_path / "run" / "hooks"))


def test_the_trace_of_a_policy_error_is_logged_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(Raises, "error", ValueError("of this test alone"))
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        evaluated(tmp_path / name, lambda *_: Raises())
    said = capfd.readouterr().err
    assert said.count("policy error: ValueError: of this test alone") == 2
    assert said.count("raise self.error") == 1


class Judging(Touch):
    def judge(self, scene: rc.Scene) -> Any:
        raise RuntimeError("out of cubes")


def test_in_an_evaluation_an_error_of_the_task_takes_no_other_start(tmp_path: Path):
    with pytest.raises(rc.Error, match="something else than the policy raised") as raised:
        evaluated(tmp_path, lambda *_: Idle(), Judging)
    line = Judging.judge.__code__.co_firstlineno + 1
    said = f"RuntimeError: out of cubes ({__file__}:{line}, in judge)"
    assert str(raised.value).endswith(said)
    cause = raised.value.__cause__
    assert isinstance(cause, RuntimeError)
    assert str(cause) == "out of cubes"
    assert not list(rc.Dataset(tmp_path / "run" / "hooks"))
