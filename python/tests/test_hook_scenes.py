"""Hooks written in Python see a scene whose data is a mujoco.MjData, in environments and runs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import mujoco
import pytest

import robocell as rc
from robocell.generate import Keep
from test_hooks import Cube
from test_task import load

IN_BOTH = {"bind", "arrange", "begin", "judge", "observe", "feature"}
DEMO = Path(__file__).resolve().parents[2] / "examples" / "demo.yaml"
seen: set[str] = set()


def look(hook: str, scene: rc.Scene) -> None:
    """Notes a hook whose scene has the engine's data, which are those of the scene."""
    assert isinstance(scene.data, mujoco.MjData)
    assert scene.data.time == scene.time()
    assert scene.data.qpos.size == scene.model.nq
    seen.add(hook)


@pytest.fixture(autouse=True)
def _forget():
    seen.clear()


class Looks(Cube):
    def bind(self, scene: rc.Scene, setting: rc.tasks.TaskSetting) -> None:
        look("bind", scene)

    def arrange(self, scene: rc.Scene, rng: rc.tasks.Rng) -> rc.tasks.Refusal | None:
        look("arrange", scene)
        return None

    def begin(self, scene: rc.Scene) -> None:
        look("begin", scene)

    def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
        look("judge", scene)
        return rc.tasks.TaskVerdict()

    def signals(self) -> dict[str, Any]:
        return {"contacts": ([0], [10_000])}

    def observe(self, scene: rc.Scene) -> dict[str, Any]:
        look("observe", scene)
        return {"contacts": [scene.data.ncon]}


class Watches(rc.tasks.Expert):
    def __init__(self, *_: object) -> None:
        super().__init__()
        self.left = 2

    def begin(self, scene: rc.Scene, rng: rc.tasks.Rng) -> None:
        look("expert's begin", scene)

    def act(self, scene: rc.Scene, rng: rc.tasks.Rng) -> dict[str, Any]:
        look("expert's act", scene)
        self.left -= 1
        return {}

    def done(self) -> bool:
        return self.left <= 0

    def failure(self) -> str:
        return "only looked"

    def phase(self) -> int:
        return 0

    def phase_names(self) -> list[str]:
        return ["look"]


@pytest.fixture
def feature() -> str:
    def read(scene: rc.Scene) -> float:
        look("feature", scene)
        return float(scene.data.ncon)

    rc.features.register_feature("contacts_of_hooks")(read)
    return "contacts_of_hooks"


def run_that_looks(folder: Path, feature: str) -> rc.RunConfig:
    rc.register_task("looks_at_data")(Looks)
    rc.tasks.register_expert("watches_data")(Watches)
    run = load(folder)
    run.task, run.expert, run.features = {"kind": "looks_at_data"}, "watches_data", [feature]
    run.output = str(folder / "looks")
    return run


def only(run: rc.RunConfig, **parts: Any) -> rc.generate.ItemResult:
    run.max_attempts = 20
    run.rates.max_steps = 3
    rc.generate.prepare_dataset(run, validate=False)
    return rc.generate.Runner(run, **parts).run(rc.generate.make_plan(run)[0])


def test_hooks_see_data_in_a_run(tmp_path: Path, feature: str):
    run = run_that_looks(tmp_path, feature)
    run.keep = Keep.FIRST
    assert only(run).accepted == 1
    assert seen == IN_BOTH | {"expert's begin", "expert's act"}


def test_hooks_see_data_in_a_run_as_an_environment(tmp_path: Path, feature: str):
    env = rc.envs.RunEnv(run_that_looks(tmp_path, feature))
    env.reset(0)
    env.row()
    env.act({})
    assert seen == IN_BOTH
    assert env.scene.data.time > 0


def env_that_looks(feature: str) -> rc.EnvConfig:
    rc.register_task("looks_at_data")(Looks)
    config = rc.EnvConfig.load(rc.models.cell_file("rc7"))
    config.task, config.add_floor, config.features = {"kind": "looks_at_data"}, True, [feature]
    return config


def test_hooks_see_data_in_an_environment(feature: str):
    env = rc.Env(env_that_looks(feature))
    env.reset(seed=0)
    env.step(env.action_range[0])
    assert seen == IN_BOTH


def test_hooks_see_data_in_copies_of_an_environment(feature: str):
    batch = rc.envs.EnvBatch(env_that_looks(feature), count=2, threads=2)
    batch.reset(seeds=[0, 1])
    batch.step([batch.action_range[0]] * 2)
    assert seen == IN_BOTH
    batch.close()


@pytest.mark.parametrize("part", ["feature", "expert", "sampler"])
def test_one_hook_in_python_sees_data_in_a_run_of_built_in_parts(
    tmp_path: Path, feature: str, part: str
):
    class Sampler(rc.tasks.StartSampler):
        def validate_base_pose(
            self, scene: rc.Scene, robot: rc.Robot, target_body: str
        ) -> rc.tasks.Refusal | None:
            look("sampler", scene)
            return super().validate_base_pose(scene, robot, target_body)

    run = load(tmp_path)
    run.keep = Keep.FIRST
    run.output = str(tmp_path / "one")
    run.features = [feature] if part == "feature" else []
    parts = {"expert": Watches} if part == "expert" else {}
    if part == "sampler":
        parts = {"sampler": Sampler}
    only(run, **parts)
    assert seen >= {part if part != "expert" else "expert's act"}


def test_a_sampler_gives_python_a_start_with_data():
    sampler = rc.tasks.StartSampler(rc.RunConfig.load(DEMO))
    for attempt in range(20):
        request, rng = rc.tasks.SampleRequest(attempt=attempt), rc.tasks.Rng.stream(attempt, "test")
        start = sampler.sample(request, rng)
        if isinstance(start, rc.tasks.EpisodeStart):
            break
    look("start", start.scene)


def test_a_run_without_hooks_in_python_keeps_its_own_data(tmp_path: Path):
    """They are made faster, without Python's lock and package."""
    script = f"""
import sys
import robocell as rc

run = rc.RunConfig.load({str(DEMO)!r})
run.cameras.streams.clear()
run.output = {str(tmp_path / "out")!r}
rc.generate.prepare_dataset(run)
assert rc.generate.Runner(run).run(rc.generate.make_plan(run)[0]).committed
assert "mujoco" not in sys.modules
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, "-c", script], env=environment, check=True, timeout=120)
