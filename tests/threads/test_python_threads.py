"""What Python may do from several threads at once: each result is that of one thread alone.

`make check-tsan` runs this file with an extension that ThreadSanitizer watches, which sees races
that do no harm on the day: see scripts/tsan_python.
"""

from __future__ import annotations

import gc
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell.gym import VectorGymEnv, pick_cube_config
from test_env_tasks import reach_config
from test_pick import Never
from test_robot import Lamp
from test_task import Idle, load

THREADS = 3
ROUNDS = 2


def in_parallel(work: Callable[[int], object], threads: int = THREADS) -> list[object]:
    """work(0), work(1) ... at the same time; their results, or the first exception."""
    with ThreadPoolExecutor(threads) as pool:
        together = threading.Barrier(threads)

        def run(number: int) -> object:
            together.wait()
            return work(number)

        return list(pool.map(run, range(threads)))


def cell() -> rc.Scene:
    """The built-in robot beside a cube."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    cube = {"shape": "box", "size": [0.02] * 3, "rgba": [1] * 4, "mass": 0.1}
    spec.objects.append(
        rc.SceneObject(name="cube", friction=[0.8, 0.02, 0.001], pos=[0.4, 0, 0.02], **cube)
    )
    return rc.Scene.build(spec)


def driven(_: int = 0) -> np.ndarray:
    """The state of a cell with hooks and a group of Python's, after two episodes."""
    scene, lamp, seen = cell(), Lamp(), []

    def lift(context: rc.scene.ResetContext) -> None:
        seen.append(context.options.seed)
        context.scene.set_body_pose("cube", [0.5, 0, 0.5], [0, 0, 0, 1])

    scene.on_reset(lift)
    passing = scene.on_reset(lambda context: seen.append(context.info.used_keyframe))
    robot = scene.robot("a")
    robot.set_group(lamp)
    for seed in range(ROUNDS):
        scene.reset(seed=seed)
        robot.apply({"lamp": rc.control.GroupCommand.joints([0.5])})
        for _step in range(20):
            robot.update()
            scene.step()
    scene.remove_reset_hook(passing)
    scene.step_n(50)
    assert seen == [0, True, 1, True]
    assert lamp.commands[-1] == 0.5
    return scene.state()


def test_scenes_with_hooks_and_groups_of_python():
    alone = driven()
    for state in in_parallel(driven):
        np.testing.assert_array_equal(state, alone)


def test_hooks_of_scenes_on_one_frozen_model():
    compiled = rc.scene.compile_scene(cell().copy_spec())
    compiled.freeze()
    calls: list[int] = []

    def work(number: int) -> np.ndarray:
        scene = rc.Scene.from_compiled(compiled)
        scene.on_reset(lambda context: calls.append(number))
        for _ in range(ROUNDS):
            scene.reset(seed=1)
            scene.step_n(50)
        assert scene.model is compiled.model
        return scene.state()

    states = in_parallel(work)
    assert sorted(calls) == sorted([*range(THREADS)] * ROUNDS)
    for state in states:
        np.testing.assert_array_equal(state, states[0])


def test_scenes_survive_release_on_any_thread():
    """Their last owner may be any thread, the collector's too; hooks refer back to them."""

    def work(_: int) -> None:
        for _round in range(ROUNDS):
            scene = cell()
            scene.on_reset(lambda context, scene=scene: scene.time())  # a circle
            scene.reset()
            waiting.append((scene, scene.data, scene.robot("a")))
            if len(waiting) > 1:
                waiting.pop(0)
            gc.collect()

    waiting: list[tuple[object, ...]] = []
    in_parallel(work)
    waiting.clear()
    gc.collect()


class Push(Idle):
    """Moves the arm a little."""

    def failure(self) -> str:
        return ""

    def act(
        self, scene: rc.Scene, rng: rc.tasks.Rng
    ) -> dict[str, dict[str, rc.control.GroupCommand]]:
        super().act(scene, rng)
        return {"rc7": {"arm": rc.control.GroupCommand.relative_joints([0.01] * 7)}}


class Impatient(rc.tasks.StartSampler):
    """Starts whose task, Python's own, is done after two rewards."""

    def make_task(self) -> rc.tasks.Task:
        return Never(self.run.task)


def test_runners_with_samplers_tasks_and_experts_of_python(tmp_path: Path):
    """Each has its own; all write into one dataset."""
    run = load(tmp_path, max_attempts=3)
    plan = rc.generate.make_plan(run)

    def work(number: int) -> rc.generate.ItemResult:
        expert = lambda run, start: Push(4)  # noqa: E731
        return rc.generate.Runner(run, expert=expert, sampler=Impatient).run(plan[number])

    results = in_parallel(work, threads=2)
    assert [result.success for result in results] == [True, True]
    assert rc.data.verify(run.output).good == [item.id for item in plan]


def test_a_batch_of_environments_with_tasks_of_python():
    """C++ threads of its own call them."""
    config = reach_config()

    def episodes(threads: int) -> list[np.ndarray]:
        vector = VectorGymEnv(config, 4, 3, threads=threads)
        seen = [vector.reset(seed=3)[0]["task"]["point"]]
        vector.action_space.seed(1)
        for _ in range(5):
            seen.append(vector.step(vector.action_space.sample())[1])
        vector.close()
        return seen

    alone = episodes(1)
    for seen in in_parallel(lambda number: episodes(THREADS), threads=2):
        for mine, other in zip(seen, alone, strict=True):
            np.testing.assert_array_equal(mine, other)


def test_one_environment_is_used_by_one_thread_at_a_time():
    """Any call of the other one raises."""
    env = rc.Env(pick_cube_config())
    env.reset(seed=0)
    refused: list[str] = []
    deadline = time.monotonic() + 60

    def work(number: int) -> None:
        action = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
        while not refused and time.monotonic() < deadline:
            try:
                env.reset(seed=0) if number else env.step(action)
            except rc.Error as error:
                refused.append(str(error))

    in_parallel(work, threads=2)
    assert refused
    assert all("by another thread: one call at a time" in text for text in refused), refused
    env.close()


def test_one_scene_is_used_by_one_thread_at_a_time():
    """The other one raises; what one thread leaves, the next one finds."""
    scene = cell()
    robot = scene.robot("a")
    calls = [
        lambda: scene.reset(seed=1),
        lambda: scene.step_n(20),
        lambda: (
            robot.update(),
            robot.set_joint_pos(robot.jnt_pos_msr),
            robot.refresh_tool_inertia(),
        ),
    ]
    done, refused = [0] * THREADS, set()
    deadline = time.monotonic() + 60

    def work(number: int) -> None:
        while (min(done) < ROUNDS or not refused) and time.monotonic() < deadline:
            try:
                calls[number]()
                done[number] += 1
                time.sleep(0.002)  # the lock may be another's
            except rc.Error as error:
                refused.add(str(error).split(" (")[0])

    in_parallel(work)
    assert min(done) >= ROUNDS, done
    assert refused == {"scene 'cell' is in use by another thread"}
    scene.reset(seed=1)
    alone = cell()
    alone.reset(seed=1)
    np.testing.assert_array_equal(scene.state(), alone.state())


def test_several_threads_can_call_a_python_filter():
    kinematics = cell().robot("a").kinematics
    low, high = np.array(cell().robot("a").joint_limits).T
    targets = kinematics.fk(np.random.default_rng(1).uniform(low, high, (60, len(low))))
    positive = lambda q: q[:, 0] > 0  # noqa: E731
    alone = kinematics.ik_batch(targets, filter=positive)
    assert alone.success.sum() > 40
    assert (alone.q[alone.success, 0] > 0).all(), "it was asked"
    for found in in_parallel(
        lambda number: kinematics.ik_batch(targets, filter=positive, threads=2)
    ):
        np.testing.assert_array_equal(found.q, alone.q)


def test_threads_render_with_separate_renderers():
    camera = rc.render.OrbitCamera(lookat=[0.3, 0, 0.2], distance=1.5)

    def work(_: int = 0) -> np.ndarray:
        scene = cell()
        renderer = rc.render.Renderer(scene)
        for _round in range(ROUNDS):
            scene.reset()
            image = renderer.render(camera, 64, 48)["rgb"]
        return image

    alone = work()
    assert alone.std() > 0
    for image in in_parallel(work, threads=2):
        np.testing.assert_array_equal(image, alone)


def test_exceptions_of_hooks_reach_their_own_threads():
    def work(number: int) -> str:
        scene = cell()

        def sulk(context: rc.scene.ResetContext) -> None:
            raise ValueError(f"thread {number} would rather not")

        scene.on_reset(sulk)
        with pytest.raises(ValueError) as raised:
            scene.reset()
        return str(raised.value)

    assert in_parallel(work) == [f"thread {number} would rather not" for number in range(THREADS)]
