"""Experts and tasks written in Python: what they are handed stays valid or says that it is over."""

from __future__ import annotations

import gc
import pickle
import weakref
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from command_line import write_run


class Idle(rc.tasks.Expert):
    """Does nothing for some actions, then has failed."""

    def __init__(self, actions: int = 3) -> None:
        super().__init__()
        self.left = actions
        self.kept: list[object] = []
        self.draws: list[float] = []

    def begin(self, scene: rc.Scene, rng: rc.tasks.Rng) -> None:
        self.kept = [scene, rng, rng.fork("mine")]
        self.draws.append(rng.uniform())

    def act(
        self, scene: rc.Scene, rng: rc.tasks.Rng
    ) -> dict[str, dict[str, rc.control.GroupCommand]]:
        self.draws.append(rng.uniform())
        self.left -= 1
        return {}

    def done(self) -> bool:
        return self.left <= 0

    def failure(self) -> str:
        return "idle"

    def phase(self) -> int:
        return 0

    def phase_names(self) -> list[str]:
        return ["idle"]


def load(tmp_path: Path, **fields: object) -> rc.RunConfig:
    """A small run without cameras that writes below `tmp_path`."""
    run = rc.RunConfig.load(write_run(tmp_path))
    run.output = str(tmp_path / "out")
    run.cameras.streams.clear()
    for name, value in fields.items():
        setattr(run, name, value)
    rc.generate.prepare_dataset(run)
    return run


def make(
    run: rc.RunConfig, expert: Callable[[rc.RunConfig, rc.tasks.EpisodeStart], rc.tasks.Expert]
):
    """The result of the run's first item."""
    return rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])


def test_arguments_of_an_expert_factory_can_be_kept(tmp_path):
    kept: list[tuple[rc.RunConfig, rc.tasks.EpisodeStart]] = []

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        kept.append((run, start))
        return Idle()

    result = make(load(tmp_path, max_attempts=2), expert)
    assert result.accepted == len(kept)
    gc.collect()
    for run, start in kept:
        assert run.run == "tiny"
        assert start.target_object == "target"
        assert start.task.instruction().startswith("pick up")
        assert start.task.objects()[0] == "target"
        start.task.success(start.scene)
        start.scene.step_n(10)
        assert start.scene.time() > 0


def test_an_expert_stays_alive_while_in_use(tmp_path):
    alive: list[weakref.ref] = []

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        made = Idle()
        made.note = object()
        alive.append(weakref.ref(made))
        gc.collect()
        return made

    result = make(load(tmp_path, max_attempts=2), expert)
    assert result.failures == {"idle": result.accepted}
    gc.collect()
    assert [ref() for ref in alive] == [None] * result.accepted


def test_a_kept_stream_raises_an_error(tmp_path):
    experts: list[Idle] = []

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        experts.append(Idle())
        return experts[-1]

    make(load(tmp_path, max_attempts=1), expert)
    scene, rng, mine = experts[0].kept
    with pytest.raises(rc.Error, match=r"lent for one call, which is over; keep rng.fork"):
        rng.uniform()
    assert 0 <= mine.uniform() < 1
    assert len(set(experts[0].draws)) == len(experts[0].draws) == 4  # one stream, drawn on
    scene.step()


def test_the_same_run_draws_the_same_numbers(tmp_path):
    draws = []
    for name in ("a", "b"):
        folder = tmp_path / name
        folder.mkdir()
        experts: list[Idle] = []

        def expert(run, start, experts=experts):
            experts.append(Idle())
            return experts[-1]

        make(load(folder, max_attempts=1), expert)
        draws.append(experts[0].draws)
    assert draws[0] == draws[1]


def test_a_factory_must_return_an_expert(tmp_path):
    with pytest.raises(TypeError, match=r"expert\(\) must return an Expert, got 7"):
        make(load(tmp_path), lambda run, start: 7)


def test_errors_quote_the_invalid_result_of_a_method(tmp_path):
    class Wordless(Idle):
        def failure(self):
            return None

    class Vague(Idle):
        def phase(self):
            return "first"

    with pytest.raises(TypeError, match=r"Wordless.failure\(\) must return a str, got None"):
        make(load(tmp_path), lambda run, start: Wordless())
    with pytest.raises(TypeError, match=r"Vague.phase\(\) must return a whole number, got 'fi"):
        make(load(tmp_path), lambda run, start: Vague())


def test_numbers_of_numpy_are_numbers(tmp_path):
    class Counting(Idle):
        def done(self):
            return np.int64(self.left) <= 0

        def phase(self):
            return np.int64(0)

    assert make(load(tmp_path), lambda run, start: Counting()).failures["idle"] > 0


def test_an_exception_of_an_expert_propagates(tmp_path):
    class Broken(Idle):
        def act(self, scene, rng):
            raise KeyError("no such idea")

    with pytest.raises(KeyError, match="no such idea"):
        make(load(tmp_path), lambda run, start: Broken())
    assert not list((tmp_path / "out").glob("s*"))


def test_experts_called_from_python_draw_from_the_stream_given():
    rng, same = rc.tasks.Rng.stream(1, "test"), rc.tasks.Rng.stream(1, "test")
    expert = Idle()
    expert.begin(
        rc.Scene.build(rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)), rng
    )
    assert expert.draws == [same.uniform()]
    assert rng.uniform() == same.uniform()


def test_judge_of_the_base_class_uses_reward_and_success():
    class Parts(rc.tasks.Task):
        def instruction(self) -> str:
            return "wait"

        def reward(self, scene: rc.Scene) -> float:
            return 0.25

        def success(self, scene: rc.Scene) -> bool:
            return True

    class Whole(Parts):
        def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
            verdict = super().judge(scene)
            return rc.tasks.TaskVerdict(reward=2 * verdict.reward, success=verdict.success)

    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    verdict = Whole().judge(rc.Scene.build(spec))
    assert (verdict.reward, verdict.success) == (0.5, True)


def test_verdicts_can_be_pickled():
    verdict = rc.tasks.TaskVerdict(reward=0.1, success=True, progress=1 / 3, subtask=2)
    again = pickle.loads(pickle.dumps(verdict))
    for field in ("reward", "success", "progress", "subtask"):
        assert getattr(again, field) == getattr(verdict, field)
