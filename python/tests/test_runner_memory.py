"""A runner and a function of the same script refer to each other: the collector must see it."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import weakref
from pathlib import Path

import pytest

import robocell as rc

DEMO = Path(__file__).resolve().parents[2] / "examples" / "demo.yaml"

SCRIPT = f"""
import robocell as rc

run = rc.RunConfig.load({str(DEMO)!r})
runner = rc.generate.Runner(run, lambda run, start: print(runner))
"""

WITH_A_SAMPLER = f"""
import robocell as rc


class Mine(rc.tasks.StartSampler):
    def make_task(self):
        return Judge(self.run.task)


class Judge(rc.tasks.PickTask):
    def reward(self, scene):
        return runner and super().reward(scene)


run = rc.RunConfig.load({str(DEMO)!r})
run.task.objects = ["box"]
runner = rc.generate.Runner(run, sampler=Mine)
sampler = Mine(run)
for attempt in range(20):
    request, rng = rc.tasks.SampleRequest(attempt=attempt), rc.tasks.Rng.stream(attempt, "test")
    start = sampler.sample(request, rng)
    if isinstance(start, rc.tasks.EpisodeStart):
        break
assert type(start.task) is Judge
"""


WITH_A_SOURCE = f"""
import robocell as rc


@rc.scenes.register_scene_source("source_of_test")
class Mine(rc.scenes.SceneSource):
    def size(self):
        return 1

    def make(self, index):
        return runner and rc.SceneSpec(name="empty")


run = rc.RunConfig.load({str(DEMO)!r})
run.scenes = {{"source": "source_of_test"}}
runner = rc.generate.Runner(run)
environment = rc.envs.RunEnv(run)
sampler = rc.tasks.StartSampler(run)
"""

WITH_A_REGISTERED_SAMPLER = f"""
import robocell as rc


@rc.tasks.register_sampler("sampler_of_test")
class Mine(rc.tasks.StartSampler):
    def choose_base_placement(self, request, rng):
        return runner and rc.tasks.BasePlacement(0.35, -0.2)


run = rc.RunConfig.load({str(DEMO)!r})
run.sampler = "sampler_of_test"
runner = rc.generate.Runner(run)
"""

WITH_FEATURES = """
import robocell as rc


class Mine(rc.tasks.Task):
    def judge(self, scene):
        return features and rc.tasks.TaskVerdict(reward=1.0)

    def instruction(self):
        return "wait"


spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
spec.robots = [rc.RobotSpec(name="r", config=rc.RobotConfig.load(rc.models.robot_file("rc7")))]
scene = rc.Scene.build(spec)
scene.on_reset(lambda context: print(features))
task = Mine()
features = rc.features.CellFeatures(scene, task)
assert features.read()
"""

WITH_A_RECORDER = """
import tempfile
import robocell as rc
from robocell.data import EnvRecorder
from robocell.gym import pick_cube_config


@rc.register_task("task_of_test")
class Mine(rc.tasks.Task):
    def judge(self, scene):
        return recorder and rc.tasks.TaskVerdict(reward=1.0)

    def instruction(self):
        return "wait"


folder = tempfile.TemporaryDirectory()
env = rc.Env(pick_cube_config(relative_to="last_step", task={"kind": "task_of_test"}))
recorder = EnvRecorder(env, folder.name)
env.reset(seed=1)
env.step({"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}})
recorder.save()
again = rc.envs.from_dataset(folder.name)
again.reset(seed=1)
"""

WITH_A_HOOK_THAT_RAISES = f"""
import robocell as rc


@rc.register_task("task_of_test")
class Mine(rc.tasks.Task):
    def prepare(self, spec, rng):
        cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, mass=0.1)
        cube.rgba, cube.friction = [1, 0.5, 0, 1], [1, 0.02, 0.001]
        spec.objects.append(cube)

    def arrange(self, scene, rng):
        raise ValueError("no place for " + str(environment and "it"))

    def judge(self, scene):
        return rc.tasks.TaskVerdict()

    def instruction(self):
        return "wait"


run = rc.RunConfig.load({str(DEMO)!r})
run.cameras.streams.clear()
run.task = {{"kind": "task_of_test"}}
environment = rc.envs.RunEnv(run)
try:
    environment.reset(0)
except ValueError as error:
    assert "no place for it" in str(error)
"""

SCRIPTS = [
    SCRIPT,
    WITH_A_HOOK_THAT_RAISES,
    WITH_A_SAMPLER,
    WITH_A_SOURCE,
    WITH_A_REGISTERED_SAMPLER,
    WITH_FEATURES,
    WITH_A_RECORDER,
]


@pytest.mark.parametrize("text", SCRIPTS)
def test_a_script_that_exits_reports_no_leaks(tmp_path: Path, text: str):
    script = tmp_path / "script.py"
    script.write_text(text)
    result = subprocess.run(
        [sys.executable, script],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert result.stderr == ""


def test_a_circle_of_a_runner_and_its_expert_function_is_collected():
    class Maker:
        def __call__(self, run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
            raise NotImplementedError

    maker = Maker()
    maker.runner = rc.generate.Runner(rc.RunConfig.load(DEMO), maker)  # type: ignore[attr-defined]
    gone = weakref.ref(maker)
    del maker
    gc.collect()
    assert gone() is None


def test_a_runner_keeps_its_function_alive():
    def make(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        raise NotImplementedError

    alive = weakref.ref(make)
    runner = rc.generate.Runner(rc.RunConfig.load(DEMO), make)
    del make
    gc.collect()
    assert alive() is not None
    del runner
    gc.collect()
    assert alive() is None
