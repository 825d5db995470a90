"""One thread at a time uses a scene: any call of a second one raises."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from robocell.gym import pick_cube_config
from test_closed import uses
from test_env_tasks import Reach
from test_task import Idle, load

IN_USE = "scene 'cell' is in use by another thread ({}): a scene, with its robots, renderers"
WAIT_S = 60
# These never change.
ALWAYS = {
    "Viewer": {"title"},
    "Scene": {"name"},
    "Robot": {"name", "prefix", "scene"},
    "MoveGroup": {"name", "kind"},
    "Controller": {"kind"},
    "Env": {"config"},
}


def cell() -> rc.Scene:
    """The built-in robot beside a cube."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    spec.objects.append(cube("cube"))
    return rc.Scene.build(spec)


def cube(name: str) -> rc.SceneObject:
    fields = {"shape": "box", "size": [0.02] * 3, "rgba": [1] * 4, "mass": 0.1}
    return rc.SceneObject(name=name, friction=[0.8, 0.02, 0.001], pos=[0.4, 0, 0.02], **fields)


class Door:
    """Somebody's function of another thread stands in it until this one lets it go."""

    def __init__(self) -> None:
        self.reached, self.opened = threading.Event(), threading.Event()

    def __call__(self, *_: object) -> None:
        self.reached.set()
        assert self.opened.wait(WAIT_S)

    @contextmanager
    def held(self, call: Callable[[], Any]) -> Iterator[None]:
        """While `call` stands in the door, in another thread."""
        with ThreadPoolExecutor(1) as pool:
            result = pool.submit(call)
            try:
                assert self.reached.wait(WAIT_S)
                yield
            finally:
                self.opened.set()
            result.result(WAIT_S)


@contextmanager
def resetting(scene: rc.Scene) -> Iterator[None]:
    """While another thread resets the scene."""
    door = Door()
    hook = scene.on_reset(door)
    with door.held(scene.reset):
        yield
    scene.remove_reset_hook(hook)


def test_handles_in_a_list_count_as_in_use():
    scenes = [cell() for _ in range(12)]
    robots = [scene.robot("a") for scene in scenes]
    busy = IN_USE.format("Scene.reset")
    for i in (1, 11):
        with resetting(scenes[i]):
            assert busy in refused(lambda: rc.control.Stepper(scenes[0], robots))
            assert busy in refused(lambda: rc.control.Stepper(scenes[0], robots=tuple(robots)))
    with pytest.raises(rc.ArgumentError, match="belongs to another scene"):
        rc.control.Stepper(scenes[0], robots)
    for scene in scenes:
        scene.forward()  # all are let go of


def refused(call: Callable[[], Any]) -> str:
    with pytest.raises(rc.Error) as caught:
        call()
    return str(caught.value)


def test_rejects_every_call_of_a_second_thread(tmp_path: Path):
    scene = cell()
    robot = scene.robot("a")
    handles = {
        "scene": scene,
        "robot": robot,
        "chain": rc.Robot.from_scene(scene, "base_link", "link7"),
        "arm": robot.arm,
        "gripper": robot.gripper,
        "base": robot.base,
        "gripper controller": robot.controller("gripper"),
        "stepper": rc.control.Stepper(scene, [robot]),
        "renderer": rc.render.Renderer(scene),
        "video": rc.render.VideoRecorder(scene, tmp_path / "v.mp4", 64, 48),
        "viewer": rc.viewer.open(scene, on_screen=False),
    }
    kinds = ["cartesian_pose", "joint_impedance", "cartesian_impedance", "differential_ik"]
    for kind in kinds:
        handles[kind] = robot.set_controller("arm", kind)
    with resetting(scene):
        for what, handle in handles.items():
            asked = uses(handle, ALWAYS)
            assert asked
            for name, use in asked.items():
                assert refused(use).startswith(IN_USE.format("Scene.reset")), (what, name)
        assert (scene.name, robot.name, handles["arm"].name) == ("cell", "a", "arm")
        assert repr(scene) == "<Scene 'cell', in use by another thread>"
        assert len({scene, robot.scene}) == 1
    assert scene.time() == 0
    assert repr(scene) == "<Scene 'cell', t=0 s>"
    handles["video"].record_frame()
    handles["video"].finish()


def test_arguments_and_kept_handles_count_as_in_use(tmp_path: Path):
    scene = cell()
    robot = scene.robot("a")
    task, kept = rc.tasks.Task(), rc.kinematics.CollisionFilter(robot)
    calls: list[Callable[[], Any]] = [
        lambda: rc.Robot.of(scene, "a"),
        lambda: rc.Robot.of(name="a", scene=scene),
        lambda: rc.Robot.from_scene(scene, "base_link", "link7"),
        lambda: rc.Robot(robot),
        lambda: rc.robots.robots_of(scene),
        lambda: rc.diagnose.check_robot(robot),
        lambda: rc.diagnose.validate_robot(robot),
        lambda: rc.control.Stepper(scene, [robot]),
        lambda: rc.render.Renderer(scene),
        lambda: rc.render.VideoRecorder(scene, tmp_path / "v.mp4"),
        lambda: rc.kinematics.CollisionFilter(robot),
        kept.update,
        lambda: task.reward(scene),
    ]
    with resetting(scene):
        for number, call in enumerate(calls):
            assert refused(call).startswith(IN_USE.format("Scene.reset")), number


def test_kinematics_are_shared_while_the_scene_rests_and_chains_always():
    scene = cell()
    robot = scene.robot("a")
    kinematics, chain, q = robot.kinematics, robot.chain, robot.jnt_pos_msr
    here = kinematics.fk(q).matrix
    door = Door()
    target, seed = kinematics.fk(q), q + 0.01
    keep = lambda rows: (door(), np.ones(len(rows), bool))[1]  # noqa: E731
    with door.held(lambda: kinematics.ik(target, seed=seed, filter=keep)):
        assert np.array_equal(kinematics.fk(q).matrix, here)
    with resetting(scene):
        for name, use in uses(kinematics).items():
            told = refused(use)
            assert told.startswith(
                "kinematics of robot 'a': its scene 'cell' is in use by another thread"
            ), name
            assert "use robot.chain, a copy with the same functions" in told
        assert np.array_equal(chain.fk(q).matrix, here)
        assert chain.ik(target, seed=seed).success


def test_long_kinematics_calls_finish_with_their_initial_arm():
    scene = cell()
    robot = scene.robot("a")
    kinematics, q = robot.kinematics, robot.jnt_pos_msr
    targets = kinematics.fk(q + np.linspace(-0.3, 0.3, 8)[:, None])

    def search(keep: Callable[[np.ndarray], np.ndarray]) -> list[np.ndarray]:
        one = kinematics.ik(targets[0], filter=keep).q
        batch = kinematics.ik_batch(targets, filter=keep).q
        return [one, batch, kinematics.ik_solutions(targets[0], starts=20, filter=keep)]

    alone, door, found = search(lambda rows: np.ones(len(rows), bool)), Door(), []
    keep = lambda rows: (door(), np.ones(len(rows), bool))[1]  # noqa: E731
    with door.held(lambda: found.extend(search(keep))):
        scene.add_object(cube("other"))
        robot.refresh_tool_inertia()
        scene.reset()
    for mine, other in zip(found, alone, strict=True):
        assert np.array_equal(mine, other)


def test_the_error_explains_the_fix():
    scene = cell()
    with resetting(scene):
        text = refused(scene.step)
    assert "is used by one thread at a time. Give each thread its own scene" in text
    assert "compile_scene, then freeze(), then Scene.from_compiled in each thread" in text


def test_hooks_use_the_scene_that_calls_them():
    scene = cell()
    robot, renderer, seen = scene.robot("a"), rc.render.Renderer(scene), []

    def hook(context: rc.scene.ResetContext) -> None:
        context.scene.set_body_pose("cube", [0.5, 0, 0.5], [0, 0, 0, 1])
        robot.set_joint_pos(robot.jnt_pos_msr)
        seen.extend([scene.time(), renderer.render("", 16, 16)["rgb"].shape])
        seen.append(rc.Robot.of(scene, "a").tcp_in_world.translation.shape)

    scene.on_reset(hook)
    scene.reset()
    assert seen == [0, (16, 16, 3), (3,)]
    assert np.allclose(scene.body_pose("cube").translation, [0.5, 0, 0.5])


def test_a_hook_that_waits_for_another_thread_does_not_deadlock():
    scene, told = cell(), []
    with ThreadPoolExecutor(1) as pool:
        scene.on_reset(lambda context: told.append(pool.submit(refused, scene.step).result(WAIT_S)))
        scene.reset()
    assert told[0].startswith(IN_USE.format("Scene.reset"))


def test_an_exception_releases_the_scene():
    scene = cell()

    def sulk(context: rc.scene.ResetContext) -> None:
        raise ValueError("no")

    hook = scene.on_reset(sulk)
    for call, error in [
        (scene.reset, ValueError),
        (lambda: scene.step_n(-1), rc.ArgumentError),
        (lambda: scene.step_n("many"), TypeError),
        (lambda: scene.robot("b"), rc.NotFoundError),
    ]:
        with pytest.raises(error):
            call()
        with ThreadPoolExecutor(1) as pool:
            assert pool.submit(scene.step).result(WAIT_S).ok
    scene.remove_reset_hook(hook)
    scene.close()
    with ThreadPoolExecutor(1) as pool, pytest.raises(rc.ClosedError):
        pool.submit(scene.step).result(WAIT_S)


def test_competing_threads_take_turns():
    """Or an Error; nothing else comes of it."""
    scene = cell()
    robot, renderer = scene.robot("a"), rc.render.Renderer(scene)
    present = {"cube"}

    def come_and_go() -> None:
        name = "other"
        if name in present:
            scene.remove_object(name)
        else:
            scene.add_object(cube(name))
        present.symmetric_difference_update({name})

    calls = [
        lambda: scene.step_n(200),
        scene.reset,
        come_and_go,
        lambda: (robot.update(), robot.jnt_pos_msr, scene.contacts()),
        lambda: renderer.render("", 64, 48),
    ]
    done, told = [0] * len(calls), set()
    deadline = time.monotonic() + WAIT_S

    def work(number: int) -> None:
        while min(done) < 3 and time.monotonic() < deadline:
            try:
                calls[number]()
                done[number] += 1
                time.sleep(0.002)  # Python's lock may be another's
            except rc.Error as error:
                told.add(str(error).split(" (")[0])

    with ThreadPoolExecutor(len(calls)) as pool:
        list(pool.map(work, range(len(calls))))
    assert min(done) >= 3, done
    assert told == {"scene 'cell' is in use by another thread"}
    assert set(scene.object_names) == present
    assert np.isfinite(scene.state()).all()


class Waiting(Reach):
    """Stands in a door when an episode begins, if there is one."""

    door: Door | None = None

    def begin(self, scene: rc.Scene) -> None:
        super().begin(scene)
        assert scene.time() == 0, "its own thread may use it"
        if Waiting.door:
            Waiting.door()


@pytest.fixture
def waiting() -> Iterator[rc.EnvConfig]:
    """An environment whose task stands in Waiting.door."""
    rc.register_task("waiting")(Waiting)
    yield pick_cube_config(task={"kind": "waiting"}, root_frame_objects={}, name="cell")
    Waiting.door = None


def test_the_scene_of_an_environment_that_another_thread_uses(waiting: rc.EnvConfig):
    env = rc.Env(waiting)
    env.reset(seed=0)
    scene = env.scene
    Waiting.door = Door()
    with Waiting.door.held(lambda: env.reset(seed=1)):
        assert refused(scene.step).startswith(IN_USE.format("Env.reset"))
        assert "environment 'cell' is being reset by another thread" in refused(lambda: env.scene)
    Waiting.door = None
    with resetting(scene):
        for name, use in uses(env, ALWAYS).items():
            assert refused(use).startswith(IN_USE.format("Scene.reset")), name
    env.reset(seed=0)
    env.close()


def test_the_scene_of_a_batch_of_environments(waiting: rc.EnvConfig):
    """It is their thread that uses it."""
    batch = rc.envs.EnvBatch(waiting, 1, 1)
    scene = batch.scene
    Waiting.door = Door()
    with Waiting.door.held(lambda: batch.reset(seeds=[1])):
        assert refused(scene.step).startswith(IN_USE.format("Env.reset"))
    Waiting.door = None
    with resetting(scene):
        for call in (lambda: batch.reset(seeds=[1]), batch.close):
            assert refused(call).startswith(IN_USE.format("Scene.reset"))
    batch.reset(seeds=[1])
    batch.close()


def test_the_scene_of_an_episode_that_is_made(tmp_path: Path):
    run = load(tmp_path, max_attempts=1)
    door, scenes = Door(), []

    class Slow(Idle):
        def act(
            self, scene: rc.Scene, rng: rc.tasks.Rng
        ) -> dict[str, dict[str, rc.control.GroupCommand]]:
            door()
            return super().act(scene, rng)

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        scenes.append(start.scene)
        return Slow()

    with door.held(
        lambda: rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    ):
        told = refused(scenes[0].step)
        assert told.startswith(IN_USE.replace("cell", scenes[0].name).format("RunRollout"))
    scenes[0].step()
