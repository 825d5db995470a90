"""The recorded lift is real: stock MuJoCo makes it again from the recorded controls alone."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import plain_replay
import pytest
from commands import ROOT, robocell_command
from generated_run import GeneratedRun, read_json, scene_spec, target_kind
from recorded_scene import ROBOT_PREFIX, RecordedScene

import robocell


def replay_alone(scene: RecordedScene, episode: Path) -> dict[str, object]:
    """The replay in a process that has only stock MuJoCo."""
    command = [sys.executable, plain_replay.__file__, scene.binary, episode / "steps.h5"]
    words = [str(word) for word in command]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


@pytest.mark.parametrize(
    "kind",
    [
        "box",
        "mug",
        *(pytest.param(kind, marks=pytest.mark.proof) for kind in ("cylinder", "sphere", "nut")),
    ],
)
def test_recorded_controls_lift_the_object_again_in_stock_mujoco(
    xarm7_run: GeneratedRun, tmp_path: Path, kind: str
):
    episode = next(e for e in xarm7_run.episodes() if target_kind(e) == kind)
    result = replay_alone(RecordedScene(episode, tmp_path), episode)
    assert result["modules_of_ours"] == []
    assert result["rows"] > 10
    assert result["joint_error"] <= 1e-9
    assert result["object_error"] <= 1e-9
    assert result["rise"] >= xarm7_run.run.task.lift_height
    assert result["touching"], "something holds it"
    assert all(body.startswith(ROBOT_PREFIX) for body in result["touching"]), result["touching"]


def test_the_command_reports_no_difference(any_run: GeneratedRun):
    result = robocell_command("replay", "--check", any_run.dataset)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.count(": identical") == len(any_run.episodes())


@pytest.mark.proof
def test_replaying_an_episode_of_the_built_in_robot_lifts_the_object(
    rc7_run: GeneratedRun, tmp_path: Path
):
    for episode in rc7_run.episodes():
        result = replay_alone(RecordedScene(episode, tmp_path), episode)
        assert result["joint_error"] <= 1e-9
        assert result["object_error"] <= 1e-9
        assert result["rise"] >= rc7_run.run.task.lift_height


def test_a_dataset_contains_no_model_path_of_the_machine(any_run: GeneratedRun):
    for episode in any_run.episodes():
        metadata = read_json(episode)["metadata"]
        assert str(ROOT) not in metadata["scene_spec"]
        models = robocell.Dataset(any_run.dataset)[episode.name].models
        assert all((any_run.dataset / path).is_file() for path in models.values()), models
        assert set(models) >= {robot.config.model for robot in scene_spec(episode).robots}


def test_a_replay_without_the_gripper_lifts_nothing(xarm7_run: GeneratedRun, tmp_path: Path):
    # Shows that the test above can fail: the rise comes from the grasp.
    scene = RecordedScene(xarm7_run.episodes()[0], tmp_path)
    model, data = plain_replay.load(scene.binary)
    model.actuator(f"{ROBOT_PREFIX}gripper").gainprm[0] = 0
    height = plain_replay.free_address(model, plain_replay.TARGET) + 2
    heights = [data.qpos[height] for _ in plain_replay.rows(model, data, scene.steps)]
    assert heights[-1] <= heights[0] + 0.001
