"""What classes written in Python give to C++: anything wrong names class, method and value."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from test_task import Idle, load

Expert = Callable[[rc.RunConfig, rc.tasks.EpisodeStart], rc.tasks.Expert]


class Returns(Idle):
    """An expert one of whose methods returns what it was made with."""

    def __init__(self, method: str, value: Any) -> None:
        super().__init__()
        setattr(type(self), method, lambda *_: value)


def expert_returning(method: str, value: Any) -> Expert:
    own = type("Mine", (Returns,), {})
    return lambda run, start: own(method, value)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> rc.RunConfig:
    return load(tmp_path_factory.mktemp("returned"), max_attempts=1)


def told(run: rc.RunConfig, **parts: Any) -> str:
    """Why the only attempt failed: without the place, which is in this file."""
    result = rc.generate.Runner(run, **parts).run(rc.generate.make_plan(run)[0])
    assert not list(rc.Dataset(run.output))
    (text,) = result.failures
    return re.sub(rf" \({re.escape(__file__)}:\d+, in [^)]+\)$", "", text)


OPEN = rc.control.GroupCommand.opening(1)
ACTION = "Mine.act() must return {robot: {group: GroupCommand}}: "


@pytest.mark.parametrize(
    ("method", "value", "message"),
    [
        ("act", None, ACTION + "got None"),
        ("act", {"arm": OPEN}, ACTION + "['arm'] is a GroupCommand: the outer keys are robots"),
        ("act", {"rc7": [0.0]}, ACTION + "['rc7'] is a list, not {group: GroupCommand}"),
        (
            "act",
            {"rc7": {"arm": np.zeros(7)}},
            ACTION + "['rc7']['arm'] is a numpy.ndarray, not a GroupCommand such as ",
        ),
        ("act", {1: {}}, ACTION + "[1] is not the name of a robot"),
        ("done", None, "Mine.done() must return True or False, got None"),
        ("failure", None, "Mine.failure() must return a str, got None"),
        ("phase", "grasp", "Mine.phase() must return a whole number, got 'grasp'"),
        ("phase_names", "grasp", "Mine.phase_names() must return a list of str, got 'grasp'"),
    ],
)
def test_rejects_invalid_expert_results(run: rc.RunConfig, method: str, value: Any, message: str):
    assert message in told(run, expert=expert_returning(method, value))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (None, "Mine.results_json() must return a str, got None"),
        ("two grasps", "results_json() must return a JSON object as text, such as "),
        ("[2]", "got '[2]'"),
    ],
)
def test_rejects_results_that_are_no_json_object(tmp_path: Path, value: Any, message: str):
    run = load(tmp_path, max_attempts=1, keep=rc.generate.Keep.ALL)
    assert message in told(run, expert=expert_returning("results_json", value))


def test_an_episode_has_the_results_of_its_expert(tmp_path: Path):
    run = load(tmp_path, max_attempts=1, keep=rc.generate.Keep.ALL)
    expert = expert_returning("results_json", '{"grasps": 2}')
    rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    assert rc.Dataset(run.output)[0].results == {"grasps": 2}


def test_accepts_a_numpy_bool(run: rc.RunConfig):
    result = rc.generate.Runner(run, expert=expert_returning("done", np.True_)).run(
        rc.generate.make_plan(run)[0]
    )
    assert result.accepted == 1


def test_a_method_that_is_missing_is_named(run: rc.RunConfig):
    class Lazy(rc.tasks.Expert):
        pass

    assert told(run, expert=lambda *_: Lazy()).startswith(
        "Lazy must define begin(); an Expert has "
    )
    assert "phase_names" in told(run, expert=lambda *_: Lazy())

    class Sampler(rc.tasks.TaskSampler):
        pass

    assert told(run, sampler=lambda _: Sampler()) == (
        "Sampler must define sample(); a TaskSampler has sample"
    )


def test_rejects_an_instance_instead_of_a_factory(run: rc.RunConfig):
    class Own(rc.tasks.StartSampler):
        pass

    text = "an instance of {0}; give the function that makes it, such as lambda *_: {0}(...)"
    with pytest.raises(TypeError) as caught:
        rc.generate.Runner(run, sampler=Own(run))  # type: ignore[arg-type]
    assert "`sampler` must be a function (run) -> TaskSampler" in str(caught.value)
    assert text.format("Own") in str(caught.value)
    with pytest.raises(TypeError, match="an instance of Idle; give the function that makes it"):
        rc.generate.Runner(run, expert=Idle())  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("phase", "names", "message"),
    [
        (7, ["reach", "lift"], "phase() is 7; it must be 0 to 1, an index into phase_names(): "),
        (-1, ["reach"], "phase() is -1; it must be 0 to 0"),
        (1, [], "phase() is 1; phase_names() is empty, so it must be 0"),
    ],
)
def test_rejects_a_phase_without_a_name(
    run: rc.RunConfig, phase: int, names: list[str], message: str
):
    class Mine(Idle):
        def phase(self) -> int:
            return phase

        def phase_names(self) -> list[str]:
            return names

    assert message in told(run, expert=lambda *_: Mine())


@pytest.mark.parametrize("reward", [float("nan"), float("-inf")])
def test_rejects_a_reward_that_is_not_a_number(run: rc.RunConfig, reward: float):
    class Task(rc.tasks.PickTask):
        def reward(self, scene: rc.Scene) -> float:
            return reward

    class Sampler(rc.tasks.StartSampler):
        def make_task(self) -> rc.tasks.Task:
            return Task(self.run.task)

    text = told(run, sampler=Sampler, expert=lambda *_: Idle())
    assert re.search(f"the task's reward is {reward} at t = .* must be finite", text)


def test_a_forgotten_super_init_is_named(run: rc.RunConfig):
    class Forgetful(Idle):
        def __init__(self) -> None:
            pass

    class Sampler(rc.tasks.StartSampler):
        def __init__(self, run: rc.RunConfig) -> None:
            pass

    text = "{0}.__init__() must call super().__init__(...) before the {0} can be used"
    assert told(run, expert=lambda *_: Forgetful()) == text.format("Forgetful")
    with pytest.raises(TypeError) as caught:
        rc.generate.Runner(run, sampler=Sampler)
    assert str(caught.value) == text.format("Sampler")


def test_errors_name_the_stage_or_task_with_an_invalid_result(run: rc.RunConfig):
    class Task(rc.tasks.PickTask):
        def reward(self, scene: rc.Scene) -> float:
            return None  # type: ignore[return-value]

    class Sampler(rc.tasks.StartSampler):
        def make_task(self) -> rc.tasks.Task:
            return Task(self.run.task)

    class Placed(rc.tasks.StartSampler):
        def choose_base_placement(self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng) -> Any:
            return (0.4, 0.0)

    assert told(run, sampler=Sampler) == "Task.reward() must return a number, got None"
    expected = "Placed.choose_base_placement() must return a BasePlacement, got (0.4, 0.0)"
    assert told(run, sampler=Placed) == expected


def test_rejects_factories_that_are_not_functions(run: rc.RunConfig):
    message = (
        "Runner: `expert` must be a function (run, start) -> Expert, got an instance of Idle; "
    )
    with pytest.raises(TypeError, match=re.escape(message)):
        rc.generate.Runner(run, expert=Idle())  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="`sampler` must be a function"):
        rc.generate.Runner(run, sampler=5)  # type: ignore[arg-type]
