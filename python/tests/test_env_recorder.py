"""Episodes from environments: what they hold, when they are saved, and doing them again."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import textwrap
from contextlib import ExitStack
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import robocell as rc
import robocell.gym
from command_line import robocell_command
from robocell._dataset_run import run_of_dataset
from robocell.data import EnvRecorder, env_of_episode, replay_actions
from robocell.gym import VectorGymEnv, pick_cube_config

DEMO = Path(__file__).resolve().parents[2] / "examples" / "demo.yaml"
DOWN = {"robot": {"tquat": [0, 0.02, -0.02, 0, 0, 0, 1], "gripper": 1}}


def config(**fields) -> rc.EnvConfig:
    return pick_cube_config(relative_to="last_step", **fields)


def test_an_episode_contains_observations_actions_and_rewards(tmp_path: Path):
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path, metadata={"operator": "ann"}) as recorder:
        seen = [env.reset(seed=1)[0]]
        rewards = []
        for _ in range(3):
            observation, reward, *_ = env.step(DOWN)
            seen.append(observation)
            rewards.append(reward)
        assert recorder.rows == 3
        env.reset()
        assert recorder.episodes == ["episode-000000"]
        env.step(DOWN)
    assert recorder.closed
    dataset = rc.Dataset(tmp_path)
    assert dataset.ids == recorder.episodes == ["episode-000000", "episode-000001"]
    episode = dataset[0]
    assert np.array_equal(episode["reward"], rewards)
    assert np.array_equal(episode["action/robot/tquat"], [DOWN["robot"]["tquat"]] * 3)
    joints = episode["observation/robot/joints"]
    assert np.array_equal(joints, [o["robot"]["joints"] for o in seen[:3]])
    cube = episode["observation/objects/cube/tquat"]
    assert np.array_equal(cube, [o["objects"]["cube"]["tquat"] for o in seen[:3]])
    last = episode.results["final_observation"]
    assert last["observation/robot/joints"] == seen[3]["robot"]["joints"].tolist()
    assert episode.metadata["user"] == {"operator": "ann"}
    features = {feature.name: feature for feature in episode.features}
    assert features["observation/robot/tquat"].frame == "shared base frame"
    assert features["action/robot/tquat"].role == "action"
    assert rc.data.verify(tmp_path).ok
    assert "dataset.json" not in str(rc.data.verify(tmp_path)), "a recording has none"
    for each in dataset:
        assert rc.data.verify_replay(each, 0).ok
        assert replay_actions(env, each).ok
        assert replay_actions(env_of_episode(each), each).ok
    env.close()


def test_the_caller_chooses_which_episodes_are_saved(tmp_path: Path):
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path, prefix="teleop") as recorder:
        env.reset(seed=1)
        env.step(DOWN)
        assert recorder.save(success=True, reason="the operator said so") == "teleop-000000"
        assert recorder.save() is None
        env.step(DOWN)  # waits for a reset
        env.set_state(env.get_state())
        env.step(DOWN)
        recorder.discard()
        env.reset()
    (episode,) = rc.Dataset(tmp_path)
    assert (episode.success, episode.end_reason) == (True, "the operator said so")
    with pytest.raises(KeyError):
        give_up(env, tmp_path)
    assert len(rc.Dataset(tmp_path)) == 1
    env.close()


def give_up(env: rc.Env, folder: Path) -> None:
    with EnvRecorder(env, folder):
        env.reset()
        env.step(DOWN)
        raise KeyError


def test_replays_at_another_root_pose(tmp_path: Path):
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path):
        env.reset(seed=1)
        env.step(DOWN)
    env.close()
    elsewhere = rc.Pose(translation=[1, -1, 0], rpy=[0, 0, 2])
    moved = rc.Env(config(root_frame_to_world=elsewhere))
    (episode,) = rc.Dataset(tmp_path)
    assert replay_actions(moved, episode, frame="root", tolerance=1e-5).ok
    result = replay_actions(moved, episode, tolerance=1e-5)
    assert result.first is not None
    assert result.first.what.startswith("objects.cube.tquat[")
    moved.close()


def test_records_copies_of_a_vector_with_autoreset(tmp_path: Path):
    vector = VectorGymEnv(config(), 2, max_episode_steps=2, threads=2)
    actions = {"robot": {"tquat": [DOWN["robot"]["tquat"]] * 2, "gripper": [[1], [1]]}}
    with ExitStack() as stack:
        recorders = [stack.enter_context(EnvRecorder(vector, tmp_path, copy=i)) for i in range(2)]
        vector.reset(seed=3)
        for _ in range(5):  # two steps, the reset in between, two steps
            vector.step(actions)
    assert [r.episodes for r in recorders] == [
        ["copy0-000000", "copy0-000001"],
        ["copy1-000000", "copy1-000001"],
    ]
    alone = rc.Env(config())
    for episode in rc.Dataset(tmp_path):
        assert len(episode["time"]) == 2
        assert rc.data.verify_replay(episode, 0).ok
        assert replay_actions(alone, episode).ok
    vector.close()
    alone.close()


def test_environments_of_gymnasium_with_their_wrappers(tmp_path: Path):
    env = gym.make("robocell/PickCube-v0", max_episode_steps=2)
    with EnvRecorder(env, tmp_path) as recorder:
        env.reset(seed=0)
        env.action_space.seed(0)
        env.step(env.action_space.sample())
        env.step(env.action_space.sample())
        env.reset()
    assert recorder.episodes == ["episode-000000"]
    env.close()


def test_recorded_frames_match_the_observed_ones(tmp_path: Path):
    stream = {"name": "top", "camera": "top"}
    env = rc.Env(
        config(
            camera_adds={"top": {"offset": rc.Pose(translation=[0.4, 0, 1])}},
            cameras={"streams": [stream], "resolution": [32, 24]},
        )
    )
    with EnvRecorder(env, tmp_path / "seen"):
        observation, _ = env.reset(seed=1)
        env.step(DOWN)
    (episode,) = rc.Dataset(tmp_path / "seen")
    shown = observation["frames"]["top"]["rgb"]["data"].astype(float)
    assert np.abs(episode.frame("top", 0) - shown).mean() < 12  # compressed
    with EnvRecorder(env, tmp_path / "blind", images=False):
        env.reset(seed=1)
        env.step(DOWN)
    assert not rc.Dataset(tmp_path / "blind")[0].streams
    env.close()


def test_rejects_environments_that_cannot_be_recorded(tmp_path: Path):
    env = rc.Env(config())
    vector = VectorGymEnv(config(), 2)
    for told, record in {
        "int cannot be recorded: EnvRecorder takes an rc.Env": lambda: EnvRecorder(3, tmp_path),
        "copy says which of the copies is recorded, 0 to 1": lambda: EnvRecorder(vector, tmp_path),
        r"RunEnv is the cell of a run, .*robocell evaluate RUN_OR_DATASET": lambda: EnvRecorder(
            rc.envs.RunEnv(rc.RunConfig.load(DEMO)), tmp_path
        ),
        "copy is for batches": lambda: EnvRecorder(env, tmp_path, copy=0),
        "copy 2 of a batch of environment 'pick_cube' of 2": lambda: EnvRecorder(
            vector, tmp_path, copy=2
        ),
        "'a/b' cannot begin the ids": lambda: EnvRecorder(env, tmp_path, prefix="a/b"),
        "metadata cannot be kept with episodes": lambda: EnvRecorder(
            env, tmp_path, metadata={"weight": float("nan")}
        ),
        "18446744073709551616 does not fit in 64 bits": lambda: EnvRecorder(
            env, tmp_path, metadata={"seeds": [1, {"of": 2**64}]}
        ),
        r"the text '\\udc80' is not valid Unicode": lambda: EnvRecorder(
            env, tmp_path, metadata={"by": "\udc80"}
        ),
        "metadata cannot be kept with": lambda: EnvRecorder(env, tmp_path, metadata={"by": env}),
    }.items():
        with pytest.raises(rc.ArgumentError, match=told):
            record()
    with EnvRecorder(env, tmp_path), pytest.raises(rc.IoError, match="choose another prefix"):
        EnvRecorder(env, tmp_path)
    env.close()
    vector.close()


KILLED = """
import os, signal, sys
import robocell as rc
from robocell.data import EnvRecorder
from robocell.gym import pick_cube_config

env = rc.Env(pick_cube_config(relative_to="last_step"))
recorder = EnvRecorder(env, sys.argv[1])
action = {"robot": {"tquat": [0, 0, -0.02, 0, 0, 0, 1], "gripper": 1}}
for _ in range(2):
    env.reset()
    for _ in range(3):
        env.step(action)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_process_leaves_only_complete_episodes(tmp_path: Path):
    killed = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(KILLED), str(tmp_path)], check=False, env=os.environ
    )
    assert killed.returncode == -signal.SIGKILL
    assert rc.Dataset(tmp_path).ids == ["episode-000000"]
    assert rc.data.verify(tmp_path).good == ["episode-000000"]
    rc.data.remove_leftovers(tmp_path)
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path) as recorder:
        env.reset()
        env.step(DOWN)
    assert recorder.episodes == ["episode-000001"]
    assert sorted(rc.Dataset(tmp_path).ids) == ["episode-000000", "episode-000001"]
    env.close()


def test_an_environment_can_be_closed_before_its_recorder(tmp_path: Path):
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path) as recorder:
        env.reset(seed=1)
        env.step(DOWN)
        env.close()
    assert recorder.episodes == ["episode-000000"]
    with pytest.raises(rc.ArgumentError, match="recorded from an environment, not made by a run"):
        run_of_dataset(tmp_path)


def test_a_full_disk_loses_the_episode_and_raises(tmp_path: Path):
    env = rc.Env(config())
    folder = tmp_path / "out"
    with EnvRecorder(env, folder) as recorder:
        env.reset()
        env.step(DOWN)
        os.rename(folder, tmp_path / "gone")
        with pytest.raises(rc.IoError, match=str(folder)):
            env.reset()
        os.rename(tmp_path / "gone", folder)
        env.step(DOWN)  # waits for a reset
        env.reset()
        env.step(DOWN)
    assert recorder.episodes == ["episode-000000"]
    assert rc.Dataset(folder).ids == ["episode-000000"]
    env.close()


DROPPED_IN_A_STEP = """
import sys, threading
import robocell as rc
from robocell.data import EnvRecorder
from robocell.gym import pick_cube_config

env = rc.Env(pick_cube_config(relative_to="last_step"))
action = {"robot": {"tquat": [0, 0, -0.002, 0, 0, 0, 1], "gripper": 1}}
for i in range(40):
    recorder = EnvRecorder(env, sys.argv[1])
    env.reset(seed=1)
    steps = threading.Thread(target=lambda: [env.step(action) for _ in range(5)])
    steps.start()
    threading.Event().wait(0.0005 * (i % 10))
    del recorder
    steps.join()
with EnvRecorder(env, sys.argv[1]) as recorder:
    env.reset(seed=1)
    env.step(action)
assert recorder.episodes == ["episode-000000"]
"""


def test_a_recorder_can_be_dropped_while_another_thread_steps(tmp_path: Path):
    subprocess.run([sys.executable, "-c", DROPPED_IN_A_STEP, str(tmp_path)], check=True)


def test_a_recorder_can_be_dropped_by_the_recorded_task(tmp_path: Path):
    held: list[EnvRecorder] = []

    @rc.tasks.register_task("recorder_dropper")
    class Dropper(rc.tasks.Task):
        def judge(self, scene):
            held.clear()
            return rc.tasks.TaskVerdict(reward=0.0)

        def instruction(self):
            return "let go"

    env = rc.Env(config(task={"kind": "recorder_dropper"}))
    env.reset(seed=1)
    held.append(EnvRecorder(env, tmp_path))
    env.step(DOWN)
    env.step(DOWN)
    assert not held
    with EnvRecorder(env, tmp_path) as recorder:  # the other one has let go of the folder
        env.step(DOWN)
    assert recorder.episodes == ["episode-000000"]
    env.close()


def test_an_environment_of_the_dataset_observes_each_of_its_columns(tmp_path: Path):
    @rc.tasks.register_task("gap_task")
    class Gap(rc.tasks.Task):
        def judge(self, scene):
            return rc.tasks.TaskVerdict(reward=0.0)

        def instruction(self):
            return "close the gap"

        def signals(self):
            return {"gap": ([0.0], [2.0])}

        def observe(self, scene):
            return {"gap": [1.5]}

    @rc.features.register_feature("recorded_time", units="s")
    def recorded_time(scene):
        return [scene.time()]

    env = rc.Env(config(task={"kind": "gap_task"}, features=["recorded_time"]))
    with EnvRecorder(env, tmp_path):
        env.reset(seed=1)
        env.step(DOWN)
    env.close()
    again = rc.envs.from_dataset(tmp_path, observations=["task/gap", "features/recorded_time"])
    observation, _ = again.reset(seed=0)
    assert observation["task/gap"] == pytest.approx(1.5)
    again.close()


def test_rejects_changed_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    source = tmp_path / "edited_task.py"
    source.write_text(
        textwrap.dedent(
            """
            import robocell as rc

            @rc.tasks.register_task("edited_task")
            class Edited(rc.tasks.Task):
                def judge(self, scene):
                    return rc.tasks.TaskVerdict(reward=1.0)

                def instruction(self):
                    return "wait"
            """
        )
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.import_module("edited_task")
    folder = tmp_path / "out"
    env = rc.Env(config(task={"kind": "edited_task"}))
    with EnvRecorder(env, folder):
        env.reset(seed=1)
        env.step(DOWN)
    (episode,) = rc.Dataset(folder)
    assert replay_actions(env_of_episode(episode), episode).ok
    source.write_text(source.read_text().replace("1.0", "5.0"))
    with pytest.raises(rc.SpecError, match=r"recorded with other code than .*edited_task\.py"):
        env_of_episode(episode)
    with pytest.raises(rc.SpecError, match=r"edited_task\.py"):
        replay_actions(env, episode)
    with pytest.raises(rc.SpecError, match=r"edited_task\.py"):
        rc.envs.from_dataset(folder)
    with pytest.raises(rc.ArgumentError, match=r"edited_task\.py: not the recorded one"):
        EnvRecorder(env, folder, prefix="more")
    env.close()


def test_a_dataset_belongs_to_one_environment(tmp_path: Path):
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path):
        env.reset(seed=1)
        env.step(DOWN)
    env.close()
    other = rc.Env(config(sim={"frequency": 7}))
    with pytest.raises(
        rc.ArgumentError, match=r"sim\.frequency: 20 then, 7 now;.* choose another folder"
    ):
        EnvRecorder(other, tmp_path, prefix="other")
    other.close()
    again = env_of_episode(rc.Dataset(tmp_path)[0])
    with EnvRecorder(again, tmp_path) as recorder:
        again.reset(seed=2)
        again.step(DOWN)
    assert recorder.episodes == ["episode-000001"]
    again.close()


def test_an_environment_of_recorded_episodes_is_recorded(tmp_path: Path):
    env = rc.Env(config())
    with EnvRecorder(env, tmp_path / "first"):
        env.reset(seed=1)
        env.step(DOWN)
    env.close()
    again = rc.envs.from_dataset(tmp_path / "first")
    action = {"action/robot/tquat": DOWN["robot"]["tquat"], "action/robot/gripper": [1]}
    with EnvRecorder(again, tmp_path / "second") as recorder:
        again.reset(seed=1)
        again.step(action)
    assert recorder.episodes == ["episode-000000"]
    first, second = rc.Dataset(tmp_path / "first")[0], rc.Dataset(tmp_path / "second")[0]
    assert set(first.columns) == set(second.columns)
    for name in first.columns:
        assert np.array_equal(first[name], second[name]), name
    assert replay_actions(env_of_episode(second), second).ok
    again.close()


# The child inherits every open file, and ends after the parent has saved.
FORKED = """
import os, sys
import robocell as rc
from robocell.data import EnvRecorder
from robocell.gym import pick_cube_config

still = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
env = rc.Env(pick_cube_config(relative_to="last_step"))
recorder = EnvRecorder(env, sys.argv[1])
env.reset(seed=1)
env.step(still)
tried, tell_tried = os.pipe()
saved, tell_saved = os.pipe()
if os.fork() == 0:
    try:
        recorder.save()
    except rc.Error as error:
        print(error, flush=True)
    del recorder
    os.write(tell_tried, b"1")
    os.read(saved, 1)
    os._exit(0)
env.step(still)
os.read(tried, 1)
recorder.save(success=True)
recorder.close()
os.write(tell_saved, b"1")
os.wait()
"""


def test_a_fork_does_not_affect_the_episode_of_its_parent(tmp_path: Path):
    out = tmp_path / "out"
    ended = subprocess.run(
        [sys.executable, "-c", FORKED, str(out)], capture_output=True, text=True, check=True
    )
    assert "in a fork of process" in ended.stdout
    assert rc.data.verify(out).good == ["episode-000000"]
    assert len(rc.Dataset(out)[0]["reward"]) == 2


OWN_CODE = """
from pathlib import Path
import robocell as rc

@rc.register_task("own_wait")
class Wait(rc.tasks.Task):
    def judge(self, scene):
        if Path(__file__).with_name("broken").exists():
            raise KeyError("start")
        if Path(__file__).with_name("misspelt").exists():
            scene.body_pose("cubee")
        return rc.tasks.TaskVerdict(reward=1.0)

    def instruction(self):
        return "wait"

@rc.features.register_feature("own_number")
def own_number(scene):
    return 1.0
"""


@pytest.mark.proof  # errors of a task are in test_replay.py
def test_replay_errors_of_custom_code_name_the_import_and_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    source = tmp_path / "own_wait.py"
    source.write_text(OWN_CODE)
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.import_module("own_wait")
    made = {"task": config(task={"kind": "own_wait"}), "f": config(features=["own_number"])}
    folders = {name: tmp_path / name for name in made}
    for name in made:
        env = rc.Env(made[name])
        with EnvRecorder(env, folders[name]):
            env.reset(seed=1)
            env.step(DOWN)
        env.close()
    for name, missing in (
        ("task", "no task 'own_wait'"),
        ("f", "no registered feature 'own_number'"),
    ):
        result = robocell_command("replay", folders[name], "--actions")
        assert result.returncode == 2, result.stderr
        assert "the environment that recorded" in result.stderr
        assert missing in result.stderr
        assert "a dataset imports none by itself: name it with --import" in result.stderr
        assert "edited" not in result.stderr
        replayed = ("replay", folders[name], "--actions", "--import", source)
        assert robocell_command(*replayed).returncode == 0
    (tmp_path / "misspelt").touch()
    result = robocell_command("replay", folders["task"], "--actions", "--import", source)
    assert result.returncode == 2
    assert "no body 'cubee'" in result.stderr
    assert f"({source}:11, in judge)" in result.stderr
    (tmp_path / "broken").touch()
    result = robocell_command("replay", folders["task"], "--actions", "--import", source)
    assert result.returncode == 2
    assert f"cannot be replayed: KeyError: 'start' ({source}:9, in judge)" in result.stderr
    assert "Traceback" not in result.stderr
    result = robocell_command("evaluate", folders["task"], "--policy", "expert")
    assert result.returncode == 2
    assert "was recorded from an environment, which has no expert" in result.stderr


def test_an_environment_of_ones_own_offers_what_it_steps(tmp_path: Path):
    class Mine:
        def __init__(self) -> None:
            self.recordable = rc.Env(config())

    mine = Mine()
    assert isinstance(mine, rc.data.Recordable)
    with EnvRecorder(mine, tmp_path) as recorder:
        mine.recordable.reset(seed=1)
        mine.recordable.step(DOWN)
    assert recorder.episodes == ["episode-000000"]
    mine.recordable.close()
    mine.recordable = "not an environment"
    with pytest.raises(rc.ArgumentError, match=r"Mine cannot be recorded: .* needs `recordable`"):
        EnvRecorder(mine, tmp_path)
