"""`robocell replay`: equal episodes pass, a changed one shows its first difference."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest

import robocell
from command_line import refused, robocell_command, write_run
from made_once import made_once
from robocell import _core

IDS = ["s0000_e0000", "s0000_e0001"]
QPOS = "robots/rc7/arm/qpos"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes without cameras."""

    def make(folder: Path) -> None:
        result = robocell_command("generate", write_run(folder, cameras={"streams": []}))
        assert result.returncode == 0, result.stderr

    return made_once(tmp_path_factory, "replay", make) / "out"


@pytest.fixture
def changed(dataset: Path, tmp_path: Path) -> Path:
    """A copy in which joint 2 of the second episode is a microradian off in row 9."""
    copy = shutil.copytree(dataset, tmp_path / "copy")
    steps, description = copy / IDS[1] / "steps.h5", copy / IDS[1] / "episode.json"
    with h5py.File(steps, "r+") as file:
        file[QPOS][9, 1] += 1e-6
    content = json.loads(description.read_text())
    content["files"]["steps.h5"]["sha256"] = hashlib.sha256(steps.read_bytes()).hexdigest()
    content["run"]["json_sha256"] = "0" * 64
    description.write_text(_core.self_hashed_json(json.dumps(content, indent=2)))
    return copy


def test_the_recorded_controls_give_the_recorded_episodes(dataset: Path):
    result = robocell_command("replay", dataset, "--tolerance", 0)
    assert result.returncode == 0, result.stdout + result.stderr
    for name, line in zip(IDS, result.stdout.splitlines(), strict=True):
        episode = robocell.Dataset(dataset)[name]
        ticks = episode.rows("control")
        assert line == f"{name}: {len(episode)} rows, {ticks} control ticks: identical"


def test_the_first_difference_is_named_with_row_tick_and_joint(changed: Path):
    result = robocell_command("replay", changed)
    assert result.returncode == 1, result.stdout + result.stderr
    assert f"{IDS[0]}: " in result.stdout.splitlines()[0]
    assert f"{IDS[1]}: differs first in row 9 (control tick 891, t = " in result.stdout
    assert "joint 'joint2' of rc7/arm: " in result.stdout
    assert "1 of 2 episodes differ" in result.stdout
    assert robocell_command("replay", changed, "--tolerance", 1e-5).returncode == 0
    assert robocell_command("replay", changed, IDS[0]).returncode == 0


def test_the_difference_is_a_value_in_python(changed: Path):
    result = robocell.data.verify_replay(robocell.Dataset(changed)[IDS[1]])
    assert not result.ok
    assert (result.first.row, result.first.tick, result.first.column) == (9, 891, QPOS)
    assert result.first.recorded - result.first.replayed == pytest.approx(1e-6, rel=1e-3)
    assert result.first.units == "rad"
    assert result.first.others == 0
    assert result.rows == 9


def test_the_scene_of_an_episode_is_read_with_the_folders_of_its_models(dataset: Path):
    # The demo's robot names its model relative to its own file.
    episode = robocell.Dataset(dataset)[IDS[0]]
    scene = robocell.Scene.build(robocell.data.recorded_scene(episode))
    assert [robot.name for robot in scene.robots] == ["rc7"]


def test_rejects_invalid_replay_arguments(dataset: Path, tmp_path: Path):
    assert "no dataset" in refused("replay", tmp_path / "none")
    text = refused("replay", "--check", dataset, "s0000_e0009")  # as it had to be written once
    assert "s0000_e0009" in text
    assert IDS[1] in text
    around = refused("replay", dataset.parent)
    assert (
        f"is not a dataset: it has neither a dataset.json nor episodes, it holds {dataset.name}"
        in (around)
    )
    assert f". Did you mean '{dataset}'?" in around
    (tmp_path / ".quarantine").mkdir()
    assert "has no episodes" in refused("replay", tmp_path)


def test_a_damaged_episode_is_reported_and_the_others_are_replayed(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    described = copy / IDS[0] / "episode.json"
    described.write_bytes(described.read_bytes()[:100])
    message = (
        f"episode '{copy / IDS[0]}': episode.json is damaged: it is cut short: its text ends after "
        f"100 bytes, in the middle. `robocell verify {copy}` names all that is damaged, `robocell "
        f"verify --repair {copy}` sets it aside"
    )
    result = robocell_command("replay", copy)
    assert result.returncode == 3
    assert result.stderr == f"error: {message}\n"
    first, last = result.stdout.splitlines()
    assert first.startswith(f"{IDS[1]}: ")
    assert last == "1 of 2 episodes cannot be read"
    result = robocell_command("report", copy)
    assert result.returncode == 3
    assert result.stderr == f"error: {message}\n"
    assert "1 episode, " in result.stdout
    assert f"Did you mean '{copy}'?" in refused("report", tmp_path)


MANIFEST_DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "cut": lambda whole: whole[:100],
    "no text": lambda _: b"\xff",
    "empty": lambda _: b"",
    "a list": lambda _: b"[]",
    "a field renamed": lambda whole: whole.replace(b'"versions"', b'"version_s"'),
}


@pytest.mark.parametrize(
    "damage",
    ["cut", *(pytest.param(name, marks=pytest.mark.proof) for name in list(MANIFEST_DAMAGES)[1:])],
)
def test_replay_with_code_rejects_a_damaged_manifest(dataset: Path, tmp_path: Path, damage: str):
    copy, module = shutil.copytree(dataset, tmp_path / "copy"), tmp_path / "mine_of_test.py"
    module.touch()
    manifest = copy / "dataset.json"
    whole = manifest.read_bytes()
    damaged = MANIFEST_DAMAGES[damage](whole)
    assert damaged != whole
    manifest.write_bytes(damaged)
    text = refused("replay", copy, IDS[0], "--import", module, code=3)
    assert text.startswith(f"error: '{manifest}' is damaged: ")
    assert f"`robocell verify --repair {copy}` sets it aside" in text


def test_replay_with_code_works_without_a_manifest(dataset: Path, tmp_path: Path):
    copy, module = shutil.copytree(dataset, tmp_path / "copy"), tmp_path / "mine_of_test.py"
    module.touch()
    words = ("replay", copy, IDS[0], "--import", module)
    manifest = copy / "dataset.json"
    manifest.unlink()
    result = robocell_command(*words)
    assert result.returncode == 0, result.stderr
    assert "has no dataset.json: the code that was imported is not compared" in result.stderr
    assert f"{IDS[0]}: " in result.stdout
    manifest.mkdir()
    assert f"'{manifest}' is not a file" in refused(*words, code=3)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An episode of an environment, with its configuration beside the dataset."""
    folder = tmp_path_factory.mktemp("recorded")
    rc7 = robocell.models.robot_file("rc7")
    (folder / "env.yaml").write_text(f"robots: {{robot: {rc7}}}\nsim: {{frequency: 10}}\n")
    env = robocell.Env(robocell.EnvConfig.load(folder / "env.yaml"))
    with robocell.data.EnvRecorder(env, folder / "out"):
        env.reset(seed=1)
        for i in range(3):
            env.step({"robot": {"joints": [0.02 * i] * 7, "gripper": 1}})
    env.close()
    return folder / "out"


def test_episodes_of_an_environment_are_replayed(recorded: Path, tmp_path: Path):
    env = recorded.parent / "env.yaml"
    for options in ((), ("--actions",), ("--env", env)):
        result = robocell_command("replay", recorded, *options, "--tolerance", 0)
        assert result.returncode == 0, result.stdout
        assert re.fullmatch(
            r"episode-000000: 3 rows, \d+ control ticks: identical\n", result.stdout
        )
    shorter = tmp_path / "shorter.yaml"
    shorter.write_text(env.read_text().replace("frequency: 10", "max_convergence_time: 0.004"))
    result = robocell_command("replay", recorded, "--env", shorter)
    assert result.returncode == 1
    assert "episode-000000: differs first in row 2" in result.stdout
    assert ": robot.tquat[" in result.stdout


def test_a_recorded_dataset_has_a_report_and_no_run(recorded: Path):
    result = robocell_command("report", recorded)
    assert result.returncode == 0
    assert "no report.json" not in result.stderr
    assert "0 % (1 episode)" in result.stdout
    said = refused("evaluate", recorded, "--policy", "expert")
    assert "which has no expert: experts act in runs" in said
    said = refused("evaluate", recorded, "--policy", "replay")
    assert "an environment without a task, so nothing says which rollouts succeed" in said
    said = refused("evaluate", recorded.parent / "env.yaml", "--policy", "random")
    assert "is the file of an environment" in said
    assert "Record episodes in the environment with robocell.data.EnvRecorder" in said


def test_a_replay_does_not_wait_for_real_time(tmp_path: Path):
    rc7 = robocell.models.robot_file("rc7")
    (tmp_path / "env.yaml").write_text(
        f"robots: {{robot: {rc7}}}\nsim: {{async_control: true, frequency: 0.02, realtime: true}}\n"
    )
    config = robocell.EnvConfig.load(tmp_path / "env.yaml")
    config.sim.realtime = False
    env = robocell.Env(config)
    with robocell.data.EnvRecorder(env, tmp_path / "out"):
        env.reset(seed=1)
        env.step({"robot": {"joints": [0] * 7, "gripper": 1}})
    env.close()
    started = time.monotonic()
    result = robocell_command(
        "replay", tmp_path / "out", "--env", tmp_path / "env.yaml", "--tolerance", 0
    )
    assert result.returncode == 0, result.stderr
    assert time.monotonic() - started < 40, "the step alone is 50 s"


def test_errors_explain_what_replaying_actions_requires(dataset: Path, recorded: Path):
    for options in (("--actions",), ("--env", "rc7")):
        (said,) = refused("replay", dataset, *options).splitlines()
        assert f"was generated by a run: leave out {options[0]}, so that the recorded" in said
    assert "no cell 'none'" in refused("replay", recorded, "--env", "none")
    result = robocell_command("replay", recorded, "--env", "xarm7")
    assert result.returncode == 2
    assert "is of another configuration: feature 'action/robot/joints'" in result.stderr


PUSH = """
import robocell as rc


@rc.register_task("push_of_replay")
class Push(rc.tasks.Task):
    def begin(self, scene):
        self.start = scene.body_pose("cube_green_cube").translation
{hook}
    def judge(self, scene):
        way = scene.robot("robot").tcp_in_world.translation - self.start
        return rc.tasks.TaskVerdict(reward=float(way @ way))

    def instruction(self):
        return "push it"
"""
OWN_MEMORY = """
    def memory(self):
        return list(self.start)

    def recall(self, memory):
        self.start = memory
"""


@pytest.mark.parametrize(
    "hook",
    [pytest.param("", marks=pytest.mark.proof), OWN_MEMORY],
    ids=["attributes", "memory"],
)
def test_replays_a_task_that_keeps_its_start(tmp_path: Path, hook: str):
    """In a process whose task has never begun."""
    module = tmp_path / "push_of_replay.py"
    module.write_text(PUSH.format(hook=hook))
    record = tmp_path / "record.py"
    record.write_text(f"""
import robocell as rc
from robocell.gym import pick_cube_config
from push_of_replay import Push

env = rc.Env(pick_cube_config(task={{"kind": "push_of_replay"}}))
with rc.data.EnvRecorder(env, {str(tmp_path / "out")!r}) as recorder:
    for seed in (1, 2):
        env.reset(seed=seed)
        if seed == 2:
            env.step({{"robot": {{"tquat": [0, 0.01, 0, 0, 0, 0, 1], "gripper": 0}}}})
            state = env.get_state()
            recorder.discard()
            env.reset(seed=3)
            env.set_state(state)
        for _ in range(3):
            env.step({{"robot": {{"tquat": [0, 0.01, -0.02, 0, 0, 0, 1], "gripper": 1}}}})
env.close()
""")
    subprocess.run([sys.executable, record], check=True, cwd=tmp_path)
    words = ("replay", tmp_path / "out", "--actions", "--import", module, "--tolerance", 0)
    result = robocell_command(*words)
    assert result.returncode == 0, result.stderr + result.stdout
    starts = [e.metadata["environment"]["start"] for e in robocell.Dataset(tmp_path / "out")]
    assert starts == ["reset", "state"]


def test_a_task_error_during_replay_names_its_line(tmp_path: Path):
    module = tmp_path / "push_of_replay.py"
    module.write_text(PUSH.format(hook=""))
    code = f"""
import robocell as rc
from robocell.gym import pick_cube_config
from push_of_replay import Push

Push.start = [0, 0, 0]
env = rc.Env(pick_cube_config(task={{"kind": "push_of_replay"}}))
with rc.data.EnvRecorder(env, {str(tmp_path / "out")!r}):
    env.reset(seed=1)
    env.step({{"robot": {{"tquat": [0, 0.01, 0, 0, 0, 0, 1], "gripper": 0}}}})
env.close()
"""
    text = module.read_text()
    (tmp_path / "record.py").write_text(code)
    module.write_text(text.replace("self.start = scene", "fail = scene"))
    subprocess.run([sys.executable, "record.py"], check=True, cwd=tmp_path)
    result = robocell_command("replay", tmp_path / "out", "--actions", "--import", module)
    assert result.returncode == 2
    line = module.read_text()[: module.read_text().index("self.start\n")].count("\n") + 1
    assert result.stderr == (
        "error: episode-000000 cannot be replayed: AttributeError: 'Push' object has no attribute "
        f"'start' ({module}:{line}, in judge)\n"
    )
