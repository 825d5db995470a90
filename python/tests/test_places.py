"""Starts with objects on top of, inside and next to each other."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import pytest

import robocell as rc
from robocell.scenes import ObjectPlace, Relation, SpatialRelation
from test_task import Idle

EXAMPLES = Path(__file__).parents[2] / "examples"


def pick() -> rc.RunConfig:
    run = rc.RunConfig.load(EXAMPLES / "demo.yaml")
    run.cameras.streams.clear()
    run.start.visible_from = []
    return run


def first_start(run: rc.RunConfig, seed: int = 3) -> rc.tasks.EpisodeStart:
    sampler, refusals = rc.tasks.StartSampler(run), []
    for attempt in range(30):
        request = rc.tasks.SampleRequest(scene=0, episode=0, attempt=attempt)
        result = sampler.sample(request, rc.tasks.Rng.stream(seed, f"attempt {attempt}"))
        if not isinstance(result, rc.tasks.Refusal):
            return result
        refusals.append(f"{result.reason}: {result.detail}")
    raise AssertionError(refusals)


def test_a_run_places_objects_as_configured():
    run = pick()
    run.start.places = {"object_1": {"next_to": "target", "gap": [0.02, 0.06]}}
    scenes = [first_start(run, seed).scene for seed in range(6)]
    with_others = [scene for scene in scenes if "object_1" in scene.object_names]
    assert with_others
    for scene in with_others:
        assert SpatialRelation(scene, "object_1", Relation.NEXT_TO, "target").holds()
        assert not SpatialRelation(scene, "object_1", "on_top_of", "target").holds()


def test_places_are_part_of_a_run_file():
    run = pick()
    run.start.places["target"] = ObjectPlace(next_to="mug")
    again = rc.RunConfig.from_yaml(run.to_yaml())
    assert again.start.places["target"].next_to == "mug"
    run.start.places["target"].next_to = ""
    with pytest.raises(rc.SpecError, match="Set one of on_top_of, inside and next_to"):
        run.validate()


def test_an_unknown_place_error_suggests_the_nearest():
    run = pick()
    run.start.places = {"target": {"next_to": "object_11"}}
    with pytest.raises(
        rc.SpecError, match=r"start\.places\.target: .*'object_11'.*Did you mean 'object_1'"
    ):
        first_start(run)


class Tower(rc.tasks.Task):
    """A cube that begins on a brick."""

    began: ClassVar[list[bool]] = []

    def prepare(self, spec, rng):
        for name, half in (("cube", 0.015), ("brick", 0.03)):
            block = rc.SceneObject(name=name, shape=rc.Shape.BOX, size=[half] * 3, mass=0.1)
            block.rgba, block.friction = [1, 0, 0, 1], [1, 0.02, 0.001]
            spec.objects.append(block)

    def places(self):
        return {"cube": {"on_top_of": "brick"}}

    def begin(self, scene):
        self.began.append(SpatialRelation(scene, "cube", "on_top_of", "brick").holds())

    def judge(self, scene):
        return rc.tasks.TaskVerdict(success=False)

    def instruction(self):
        return "take the tower apart"

    def objects(self):
        return ["cube", "brick"]


@pytest.mark.parametrize("runs_own", [pytest.param(False, marks=pytest.mark.proof), True])
def test_a_run_can_replace_the_places_of_a_task(tmp_path: Path, runs_own: bool):
    rc.register_task("tower_of_test")(Tower)
    run = pick()
    run.task = {"kind": "tower_of_test"}
    run.output, run.keep = str(tmp_path / "out"), rc.generate.Keep.ALL
    run.rates.max_steps, run.episodes = 2, 1
    if runs_own:
        run.start.places = {"cube": {"next_to": "brick"}}
    Tower.began.clear()
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run, expert=lambda run, start: Idle())
    runner.run(next(iter(rc.generate.make_plan(run))))
    assert set(Tower.began) == {not runs_own}


@pytest.mark.parametrize(
    ("places", "named"),
    [({"cube": "brick"}, "places"), ({"cube": {"onto": "brick"}}, "onto"), (3, "places")],
)
def test_errors_name_wrong_places_of_a_task(tmp_path: Path, places: object, named: str):
    class Odd(Tower):
        def places(self):
            return places

    rc.register_task("odd_of_test")(Odd)
    run = pick()
    run.task = {"kind": "odd_of_test"}
    run.output, run.rates.max_steps, run.episodes = str(tmp_path / "out"), 2, 1
    with pytest.raises((rc.Error, TypeError), match=named):
        rc.generate.prepare_dataset(run)
    rc.generate.prepare_dataset(run, validate=False)
    runner = rc.generate.Runner(run, expert=lambda run, start: Idle())
    with pytest.raises((rc.Error, TypeError), match=named):
        runner.run(next(iter(rc.generate.make_plan(run))))


def test_places_are_checked_before_the_first_start(tmp_path: Path):
    run = pick()
    run.output = str(tmp_path / "out")
    run.start.places = {"target": {"inside": "tabel"}}
    with pytest.raises(rc.SpecError, match=r"start\.places\.target: .*Did you mean 'table'"):
        rc.diagnose.check_run(run)
    with pytest.raises(rc.SpecError, match=r"start\.places\.target: .*Did you mean 'table'"):
        rc.generate.prepare_dataset(run)
    assert not (tmp_path / "out").exists()


def tower_env(**fields: object) -> rc.EnvConfig:
    rc.register_task("tower_of_envs")(Tower)
    rc7 = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    return rc.EnvConfig(robots={"rc7": rc7}, task={"kind": "tower_of_envs"}, **fields)


def test_environments_have_the_places_of_their_task():
    env = rc.Env(tower_env())
    for seed in range(4):
        env.reset(seed=seed)
        env.scene.step_n(200)
        assert SpatialRelation(env.scene, "cube", "on_top_of", "brick").holds()
    env.close()


def test_places_of_an_environment_override_its_task():
    config = tower_env(places={"cube": {"next_to": "brick", "gap": [0.02, 0.05]}})
    again = rc.EnvConfig.from_yaml(config.to_yaml())
    assert again.places["cube"].next_to == "brick"
    env = rc.Env(config)
    for seed in range(4):
        env.reset(seed=seed)
        assert SpatialRelation(env.scene, "cube", "next_to", "brick").holds()
    env.close()


def test_wrong_places_of_an_environment_are_reported_at_construction():
    config = tower_env(places={"cube": {"on_top_of": "brik"}})
    with pytest.raises(rc.SpecError, match=r"places\.cube: .*Did you mean 'brick'"):
        rc.Env(config)
