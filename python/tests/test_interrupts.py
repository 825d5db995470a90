"""Ctrl-C while C++ works: it is heard at once, and what was finished stays."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell.data import EnvRecorder, replay_actions
from robocell.gym import VectorGymEnv, pick_cube_config
from test_robot import cell
from test_task import Idle, load

# Between the signal and the exception. Time on processors, far below what the work takes, does not
# depend on what else the machine does; time on the clock bounds waits.
PROMPTLY_S, SOON_S = 1.0, 20.0


@contextmanager
def interrupted(after_s: float = 0.3) -> Iterator[None]:
    """Sends Ctrl-C while the block runs; it must end promptly with KeyboardInterrupt."""
    sent: list[tuple[float, float]] = []

    def send() -> None:
        sent.append((time.process_time(), time.monotonic()))
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after_s, send)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            yield
        assert sent, "the work ended before the signal"
        worked, began = sent[0]
        assert time.process_time() - worked < PROMPTLY_S
        assert time.monotonic() - began < SOON_S
    finally:
        timer.cancel()
        timer.join()


def test_many_steps_end():
    scene = cell()
    with interrupted():
        scene.step_n(2_000_000_000)
    assert 0 < scene.time() < 4e6
    assert scene.step()


def test_a_step_of_an_environment_ends():
    sim = {"async_control": True, "frequency": 1e-3, "on_collision": "report"}
    env = rc.Env(pick_cube_config(sim=sim))
    env.reset(seed=0)
    stay = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
    with interrupted():
        env.step(stay)
    with pytest.raises(rc.Error, match="ended its last reset or step halfway; call reset to go on"):
        env.step(stay)
    env.reset()
    env.close()


def test_waiting_for_real_time_ends():
    sim = {"async_control": True, "frequency": 0.1, "on_collision": "report", "realtime": True}
    env = rc.Env(pick_cube_config(sim=sim))
    env.reset(seed=0)
    stay = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
    with interrupted(2.0):
        env.step(stay)
    with pytest.raises(rc.Error, match="call reset to go on"):
        env.step(stay)
    env.close()


def test_a_replay_ends(tmp_path: Path):
    stay = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
    quick = rc.Env(pick_cube_config())
    with EnvRecorder(quick, tmp_path):
        quick.reset(seed=0)
        quick.step(stay)
    quick.close()
    sim = {"async_control": True, "frequency": 1e-3, "on_collision": "report"}
    env = rc.Env(pick_cube_config(sim=sim))
    with interrupted():
        replay_actions(env, rc.Dataset(tmp_path)[0])
    with pytest.raises(rc.Error, match="call reset to go on"):
        env.step(stay)
    env.close()


@pytest.mark.parametrize("threads", [1, 2])
def test_a_step_of_a_vector_ends(threads):
    sim = {"async_control": True, "frequency": 1e-3, "on_collision": "report"}
    vector = VectorGymEnv(pick_cube_config(sim=sim), 3, threads=threads)
    vector.reset(seed=0)
    stay = {"robot": {"tquat": np.tile([0, 0, 0, 0, 0, 0, 1.0], (3, 1)), "gripper": np.ones(3)}}
    with interrupted():
        vector.step(stay)
    with pytest.raises(rc.Error, match="ended its last reset or step halfway; call reset to go on"):
        vector.step(stay)
    observation, _ = vector.reset(seed=0)
    assert vector.observation_space.contains(observation)
    with interrupted():
        vector.step(stay)
    vector.close()


class InterruptsTheSecond(rc.tasks.Task):
    """Sends Ctrl-C into the step of the second copy, when the first has stepped."""

    def bind(self, scene: rc.Scene, setting: rc.tasks.TaskSetting) -> None:
        self.first = setting.place.endswith("[0]'")

    def reward(self, scene: rc.Scene) -> float:
        if self.first:
            threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGINT)).start()
        return 1.0

    def success(self, scene: rc.Scene) -> bool:
        return True

    def instruction(self) -> str:
        return "be interrupted"


def test_an_interrupted_vector_requires_a_reset():
    rc.register_task("interrupts_the_second")(InterruptsTheSecond)
    config = pick_cube_config(
        sim={"async_control": True, "frequency": 0.01, "on_collision": "report"},
        task={"kind": "interrupts_the_second"},
    )
    vector = VectorGymEnv(config, 3, threads=1)
    vector.reset(seed=0)
    stay = {"robot": {"tquat": np.tile([0, 0, 0, 0, 0, 0, 1.0], (3, 1)), "gripper": np.ones(3)}}
    with pytest.raises(KeyboardInterrupt):
        vector.step(stay)
    vector.reset(options={"reset_mask": np.array([False, True, True])})
    with pytest.raises(rc.Error, match=r"'pick_cube\[0\]': an error ended its last reset or step"):
        vector.step(stay)
    vector.close()


def test_interruptible_steps_return_one_result():
    one, other = cell(), cell()
    result = one.step_n(1000)
    assert result.ok
    assert result.steps == 1000
    for _ in range(1000):
        other.step()
    np.testing.assert_array_equal(one.state(), other.state())
    assert one.step_n(0).steps == 0


def test_a_diverged_part_ends_the_steps():
    scene = cell()
    scene.data.qvel[0] = 1e12
    result = scene.step_n(1000)
    assert result.diverged
    assert result.steps < 1000


def test_a_long_policy_tick_ends():
    scene = cell()
    stepper = rc.control.Stepper(scene, [scene.robot("a")], control_ticks=2_000_000_000)
    with interrupted():
        stepper.advance({})
    assert stepper.policy_ticks == 0


@pytest.mark.parametrize("threads", [1, 2])
def test_a_large_batch_of_inverse_kinematics_ends(threads):
    kinematics = cell().robot("a").kinematics
    out_of_reach = np.tile(np.eye(4), (200_000, 1, 1))
    out_of_reach[:, 0, 3] = 0.1
    out_of_reach[:, 2, 3] = 30.0
    with interrupted():
        kinematics.ik_batch(out_of_reach, threads=threads)


def test_looking_for_all_solutions_ends():
    robot = cell().robot("a")
    target = robot.fk_frame()
    for ik_solutions in (robot.kinematics.ik_solutions, robot.chain.ik_solutions):
        with interrupted():
            ik_solutions(target, starts=1_000_000, prefer="manipulability")


class Endless(Idle):
    """Never done."""

    def done(self) -> bool:
        return False


def endless(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
    return Endless()


def test_interrupting_an_endless_episode_keeps_finished_ones(tmp_path):
    run = load(tmp_path, keep=rc.generate.Keep.ALL, max_attempts=2)
    run.rates.max_steps = 1_000_000
    made: list[rc.tasks.Expert] = []

    def first_short_then_endless(
        run: rc.RunConfig, start: rc.tasks.EpisodeStart
    ) -> rc.tasks.Expert:
        made.append(Endless() if made else Idle())
        return made[-1]

    run.max_attempts = 20
    rc.generate.prepare_dataset(run)
    with interrupted(3.0):
        rc.generate.Runner(run, expert=first_short_then_endless).run(rc.generate.make_plan(run)[0])
    assert len(rc.Dataset(tmp_path / "out").ids) == 1
    assert rc.data.verify(tmp_path / "out").ok


def test_the_scripted_expert_is_interruptible(tmp_path):
    run = load(tmp_path)
    runner = rc.generate.Runner(run)
    with interrupted(0.05):
        for item in rc.generate.make_plan(run) * 100:
            runner.run(item)


def test_a_handler_that_only_sets_the_stop_flag_ends_the_run_without_an_exception(tmp_path):
    run = load(tmp_path)
    run.rates.max_steps = 1_000_000
    rc.generate.prepare_dataset(run)
    stop = rc.generate.StopFlag()
    before = signal.signal(signal.SIGTERM, lambda *_: stop.set())
    timer = threading.Timer(1.5, os.kill, (os.getpid(), signal.SIGTERM))
    timer.start()
    try:
        result = rc.generate.Runner(run, expert=endless).run(rc.generate.make_plan(run)[0], stop)
    finally:
        signal.signal(signal.SIGTERM, before)
        timer.join()
    assert result.stopped
    assert not result.committed


@pytest.mark.parametrize("work", ["step_n", "ik_batch"])
def test_other_threads_run_meanwhile(work):
    """The interpreter is released during long work."""
    scene = cell()
    robot = scene.robot("a")
    targets = np.tile(robot.fk_frame().matrix, (100_000, 1, 1))
    done: dict[str, Callable[[], object]] = {
        "step_n": lambda: scene.step_n(20_000),
        "ik_batch": lambda: robot.kinematics.ik_batch(targets),
    }
    thread = threading.Thread(target=done[work])
    thread.start()
    turns = 0
    while thread.is_alive():
        time.sleep(0.001)
        turns += 1
    thread.join()
    assert turns > 10
