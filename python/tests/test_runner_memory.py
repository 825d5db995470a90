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


class Mine(rc.tasks.PickTaskSampler):
    def make_task(self, target, kind, objects):
        return Judge(target, kind, objects)


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


@pytest.mark.parametrize("text", [SCRIPT, WITH_A_SAMPLER])
def test_a_script_that_ends_with_a_runner_says_nothing_of_leaks(tmp_path: Path, text: str):
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
