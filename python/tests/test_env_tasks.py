"""Tasks of environments: pick and place, and those that users write and register."""

from __future__ import annotations

import gc
import os
import pickle
import subprocess
import sys
import weakref
from dataclasses import dataclass
from functools import partial

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import robocell as rc
from robocell.gym import GymEnv, VectorGymEnv, pick_cube_config, pick_place_config

ROOT = rc.Pose(translation=[1, -1, 0.3], rpy=[0, 0, 2])
DOWN = rc.Pose(translation=[0, 0, 0], rpy=[np.pi, 0, 0]).quaternion


def go(env: rc.Env, xyz: np.ndarray, gripper: float):
    return env.step({"robot": {"tquat": [*xyz, *DOWN], "gripper": gripper}})


def absolute(config: rc.EnvConfig) -> rc.EnvConfig:
    config.relative_to = "none"
    config.max_relative_movement = []
    config.sim = {"on_collision": "report", "max_convergence_time": 2}
    return config


@pytest.mark.parametrize("root", [rc.Pose(), ROOT], ids=["here", "elsewhere"])
def test_picks_a_cube_and_places_it_on_the_mat(root):
    config = absolute(pick_place_config(root_frame_to_world=root))
    config.task.rotate = False
    config.add_floor = False
    config.root_frame_objects["ground"] = {
        "shape": "box",
        "size": [1, 1, 0.05],
        "mass": 1,
        "fixed": True,
        "offset": rc.Pose(translation=[0, 0, -0.05]),
    }
    env = rc.Env(config)
    observation, info = env.reset(seed=3)
    assert info["instruction"] == "pick up the cube and put it on the mat"
    cube = observation["objects"]["cube"]["tquat"][:3]
    goal = observation["task"]["goal"]
    assert np.allclose(goal[:2], observation["objects"]["mat"]["tquat"][:2])
    up = [0, 0, 0.12]
    for xyz, gripper in [(cube + up, 1), (cube, 1), (cube, 0), (cube + up, 0), (goal + up, 0)]:
        _, reward, terminated, _, info = go(env, xyz, gripper)
        assert not terminated
    assert reward > 0.5
    low = np.add(goal, [0, 0, 0.004])
    for xyz, gripper in [(low, 0), (low, 1), (goal + up, 1)]:
        observation, reward, terminated, _, info = go(env, xyz, gripper)
    assert (reward, terminated, info["is_success"]) == (1, True, True)
    assert (info["progress"], info["subtask"]) == (1, 0)
    assert np.linalg.norm(observation["objects"]["cube"]["tquat"][:3] - goal) < 0.03
    env.close()


def test_the_registered_environment_and_its_vector():
    env = gym.make("robocell/PickPlace-v0")
    assert env.spec.max_episode_steps == 400
    check_env(env.unwrapped, skip_render_check=True)
    starts = [env.reset(seed=seed)[0] for seed in (1, 1, 2)]
    goals = [start["task"]["goal"] for start in starts]
    assert np.array_equal(goals[0], goals[1])
    assert not np.array_equal(goals[0], goals[2])
    assert env.observation_space.contains(starts[0])
    env.close()
    vector = gym.make_vec("robocell/PickPlace-v0", num_envs=2)
    observation, _ = vector.reset(seed=[1, 2])
    assert np.array_equal(observation["task"]["goal"], [goals[1], goals[2]])
    vector.close()


class Reach(rc.tasks.Task):
    """The TCP is to come to a point that is drawn at each reset."""

    def __init__(self, near=0.05):
        super().__init__()
        self.near = near
        self.point = np.zeros(3)  # in the shared base frame
        self.steps = 0

    def bind(self, scene, setting):
        assert setting.robots == ["robot"]
        self.robot = scene.robot("robot")

    def arrange(self, scene, rng):
        self.point = np.array([0.4, rng.uniform(-0.2, 0.2), 0.3])

    def begin(self, scene):
        self.steps = 0

    def distance(self, scene):
        tcp = scene.shared_base_frame_to_world.inverse() * self.robot.tcp_in_world
        return np.linalg.norm(tcp.translation - self.point)

    def reward(self, scene):
        self.steps += 1
        return -self.distance(scene)

    def success(self, scene):
        return self.distance(scene) < self.near

    def instruction(self):
        return "reach the point"

    def signals(self):
        return {"point": ([-1] * 3, [1] * 3), "steps": ([0], [10])}

    def observe(self, scene):
        return {"point": self.point, "steps": [self.steps]}

    def memory(self):
        return [*self.point, self.steps]

    def recall(self, memory):
        self.point, self.steps = memory[:3], int(memory[3])


def reach_config(**fields) -> rc.EnvConfig:
    rc.register_task("reach")(Reach)
    return absolute(
        pick_cube_config(task={"kind": "reach"}, root_frame_objects={}, name="reach", **fields)
    )


class FindTheCube(Reach):
    """The cube is put where the point is; ``arrange`` draws after ``starts``."""

    def starts(self, rng):
        self.point = np.array([0.4, rng.uniform(-0.2, 0.2), 0.0195])  # into the floor
        return {"cube_green_cube": rc.Pose(translation=self.point)}

    def arrange(self, scene, rng):
        at = scene.body_pose("cube_green_cube").translation
        assert np.allclose(at, self.point, atol=1e-12)
        assert len(scene.contacts("cube_green_cube")) > 0
        self.drawn = rng.uniform(0, 1)

    def objects(self):
        return ["cube"]


class RestBesideTheArm(FindTheCube):
    """Draws places all around the arm; the reset takes those where the cube rests."""

    asked = 0

    def starts(self, rng):
        RestBesideTheArm.asked += 1
        self.point = np.array([rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), 0.0195])
        return {"cube_green_cube": rc.Pose(translation=self.point)}

    def resting_objects(self):
        return ["cube"]


def test_starts_are_drawn_until_objects_rest():
    rc.register_task("rest_beside_the_arm")(RestBesideTheArm)
    env = rc.Env(pick_cube_config(task={"kind": "rest_beside_the_arm"}))
    RestBesideTheArm.asked = 0
    for seed in range(40):
        env.reset(seed)
        touched = {c.body1 for c in env.scene.contacts("cube_green_cube")}
        touched |= {c.body2 for c in env.scene.contacts("cube_green_cube")}
        assert touched == {"world", "cube_green_cube"}
    assert RestBesideTheArm.asked > 40
    env.close()


def test_bodies_start_at_the_poses_of_the_task():
    rc.register_task("find_the_cube")(FindTheCube)
    config = pick_cube_config(task={"kind": "find_the_cube"})
    env = rc.Env(config)
    seen = [env.reset(seed)[0] for seed in (1, 1, 2)]
    for observation in seen:
        cube = observation["objects"]["cube"]["tquat"]
        assert np.allclose(cube, [*observation["task"]["point"], 0, 0, 0, 1], atol=1e-12)
    assert np.array_equal(seen[0]["task"]["point"], seen[1]["task"]["point"])
    assert not np.array_equal(seen[0]["task"]["point"], seen[2]["task"]["point"])
    env.close()


@pytest.mark.parametrize(
    ("starts", "error", "text"),
    [
        ({"cube": rc.Pose()}, rc.ArgumentError, r"no body 'cube'.*, in starts\)"),
        ({"robotrobot_link1": rc.Pose()}, rc.ArgumentError, "neither free nor a mocap body"),
        (
            {"cube_green_cube": [0, 0, 1]},
            TypeError,
            r"starts\(\)\.cube_green_cube must be a Pose, got list",
        ),
        (None, TypeError, r"starts\(\) must be a dict of names of bodies to poses, got None"),
    ],
)
def test_rejects_invalid_starts(starts, error, text):
    class Wrong(FindTheCube):
        def starts(self, rng):
            return starts

    rc.register_task("wrong_starts")(Wrong)
    with pytest.raises(error, match=text):  # a start is tried when it is made
        rc.Env(pick_cube_config(task={"kind": "wrong_starts"}))


def test_a_registered_custom_task_is_used_by_name():
    env = GymEnv(pickle.loads(pickle.dumps(reach_config(root_frame_to_world=ROOT))))
    check_env(env, skip_render_check=True)
    observation, info = env.reset(seed=1)
    assert info["instruction"] == "reach the point"
    assert "objects" not in observation
    point = observation["task"]["point"]
    other = env.reset(seed=2)[0]["task"]["point"]
    assert not np.array_equal(point, other)
    assert np.array_equal(env.reset(seed=1)[0]["task"]["point"], point)
    away = np.add(point, [0, 0, 0.1])
    observation, reward, terminated, _, info = go(env.core, away, 1)
    assert observation["task"]["steps"] == [1], "the reward comes before it"
    assert reward == pytest.approx(-0.1, abs=5e-3)
    assert not terminated
    env.core.save("away")
    _, reward, terminated, _, info = go(env.core, point, 1)
    assert terminated
    assert info["is_success"]
    observation = env.core.restore("away")
    assert observation["task"]["steps"] == [1]
    env.close()


def test_each_copy_of_a_vector_has_its_own_task():
    vector = VectorGymEnv(reach_config(), 3, threads=2)
    observation, _ = vector.reset(seed=[1, 1, 2])
    points = observation["task"]["point"]
    assert np.array_equal(points[0], points[1])
    assert not np.array_equal(points[0], points[2])
    *_, infos = vector.step(vector.action_space.sample())
    assert infos["is_success"].shape == (3,)
    vector.close()


class Counts(rc.tasks.Task):
    """Its progress and its subtask follow from the number of steps."""

    def begin(self, scene):
        self.steps = 0

    def judge(self, scene):
        self.steps += 1
        return rc.tasks.TaskVerdict(progress=self.steps / 4, subtask=self.steps // 2)

    def subtasks(self):
        return ["first", "then", "last"]

    def instruction(self):
        return "count"


def test_infos_have_the_progress_and_the_subtask():
    rc.register_task("counts")(Counts)
    config = pick_cube_config(task={"kind": "counts"})
    expected = [(0.25, 0), (0.5, 1), (0.75, 1), (1, 2)]
    for env in (rc.Env(config), GymEnv(config)):
        env.reset(seed=1)
        stay = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
        infos = [env.step(stay)[-1] for _ in expected]
        assert [(info["progress"], info["subtask"]) for info in infos] == expected
        env.close()
    vector = VectorGymEnv(config, 2, max_episode_steps=3, autoreset_mode="SameStep")
    vector.reset(seed=1)
    for progress, subtask in expected[:2]:
        *_, infos = vector.step(vector.action_space.sample())
        assert infos["progress"].tolist() == [progress] * 2
        assert infos["subtask"].tolist() == [subtask] * 2
        assert infos["_progress"].all()
        assert infos["_subtask"].all()
    *_, infos = vector.step(vector.action_space.sample())
    assert not infos["_progress"].any()
    assert infos["final_info"]["progress"].tolist() == [0.75] * 2
    assert infos["final_info"]["subtask"].tolist() == [1] * 2
    assert vector.core.progress.tolist() == [0] * 2
    vector.close()


def test_tasks_can_be_made_by_functions_and_registered_again():
    config = reach_config()
    rc.register_task("reach")(partial(Reach, near=10))
    env = rc.Env(config)
    env.reset(seed=1)
    assert go(env, np.array([0.4, 0, 0.3]), 1)[2], "near enough"
    env.close()
    assert {"pick", "pick_and_place", "reach"} <= set(rc.tasks.task_kinds())
    with pytest.raises(rc.ArgumentError, match="task 'pick' is registered already"):
        rc.register_task("pick")(Reach)
    with pytest.raises(TypeError, match=r"expected a class derived from Task or a function"):
        rc.register_task("mine")(3)


class Silent(rc.tasks.Task):
    def reward(self, scene):
        return 0

    def instruction(self):
        return "nothing"


@pytest.mark.parametrize(
    ("factory", "error", "message"),
    [
        (lambda: Silent(), TypeError, r"Silent must define success\(\)"),
        (lambda: 3, TypeError, "the function of task 'wrong' must return a Task"),
        (
            lambda: type(
                "Odd", (Silent,), {"success": lambda self, scene: False, "signals": lambda self: 3}
            )(),
            TypeError,
            r"Odd.signals\(\) must be a dict of names to \(lower, upper\), or a list of Feat",
        ),
        (
            lambda: type(
                "Mute",
                (Silent,),
                {
                    "success": lambda self, scene: False,
                    "signals": lambda self: {"a": ([0], [1])},
                    "observe": lambda self, scene: {"b": [1]},
                },
            )(),
            rc.ArgumentError,
            r"Mute.observe\(\) has no 'a', which signals\(\) names",
        ),
        (
            lambda: type(
                "More",
                (Silent,),
                {
                    "success": lambda self, scene: False,
                    "signals": lambda self: {"gap": ([0], [1])},
                    "observe": lambda self, scene: {"gap": [1], "gaps": [0, 1]},
                },
            )(),
            rc.ArgumentError,
            r"More.observe\(\) returns 'gaps', which signals\(\) does not name; it names gap\. Did",
        ),
    ],
    ids=["no success", "no task", "no signals", "not observed", "not named"],
)
def test_errors_name_the_wrong_method_of_a_task(factory, error, message):
    rc.register_task("wrong")(factory)

    def episode():
        env = rc.Env(pick_cube_config(task={"kind": "wrong"}))
        env.reset()
        env.step({"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}})

    with pytest.raises(error, match=message):
        episode()


def test_a_signal_with_lone_bounds_is_one_number():
    signals, values = {"gap": (0, 1), "row": ([0], [1])}, {"gap": 0.5, "row": [0.5]}
    env = rc.Env(
        never("gaps", signals=lambda self: signals, observe=lambda self, scene: dict(values))
    )
    observed = env.reset()[0]["task"]
    assert np.shape(observed["gap"]) == ()
    assert np.shape(observed["row"]) == (1,)
    assert observed["gap"] == 0.5
    env.close()


def test_rejects_an_unknown_task_name():
    with pytest.raises(
        rc.NotFoundError, match=r"task.kind: no task 'pik'. Known tasks: .* mean 'pick'"
    ):
        rc.Env(pick_cube_config(task={"kind": "pik"}))


def never(kind: str, **methods) -> rc.EnvConfig:
    """Of a task that never succeeds, with these methods."""
    methods = {"success": lambda self, scene: False} | methods
    rc.register_task(kind)(lambda: type("Never", (Silent,), methods)())
    return pick_cube_config(task={"kind": kind})


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_rejects_rewards_and_observations_that_are_not_finite(number):
    stay = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}}
    env = rc.Env(never("odd_reward", reward=lambda self, scene: number))
    env.reset()
    text = rf"environment 'pick_cube': the task's reward is {number} at t = [\d.]+ s; rewards"
    with pytest.raises(rc.ArgumentError, match=text):
        env.step(stay)
    env.close()
    env = rc.Env(
        never(
            "odd_signal",
            signals=lambda self: {"a": ([0, 0], [1, 1])},
            observe=lambda self, scene: {"a": [0, number]},
        )
    )
    text = rf"feature 'task/a' is {number} at t = 0.000 s; features must be finite"
    with pytest.raises(rc.ArgumentError, match=text):
        env.reset()
    env.close()


def test_pick_without_an_object_draws_the_target_at_each_reset():
    env = rc.Env(pick_cube_config(task={"kind": "pick", "objects": ["box", "nut"]}))
    said = set()
    for seed in range(8):
        observation, info = env.reset(seed=seed)
        said.add(info["instruction"])
        target = "target_" + info["instruction"].removeprefix("pick up the ")
        body = env.scene.compiled.object(target).root_body
        place = env.row()["objects/target/pose"][:3]
        np.testing.assert_allclose(place, env.scene.body_pose(body).translation, atol=1e-9)
        assert set(observation["objects"]) == {"target", "object_1"}
    assert said == {"pick up the box", "pick up the nut"}
    env.close()


class OneOfTwo(rc.tasks.Task):
    """Draws one of two cubes, and observes it as "target"."""

    def prepare(self, spec, rng):
        look = {"mass": 0.1, "rgba": [1, 0, 0, 1], "friction": [1, 0.02, 0.001]}
        for name in ("red", "blue"):
            spec.objects.append(
                rc.SceneObject(name=name, shape=rc.Shape.BOX, size=[0.02] * 3, **look)
            )

    def starts(self, rng):
        self.drawn = "red" if rng.uniform() < 0.5 else "blue"
        return {}

    def objects(self):
        return ["target"]

    def object_of(self, name):
        return getattr(self, "drawn", "red")

    def instruction(self):
        return f"pick up the {self.drawn} cube"

    def judge(self, scene):
        return rc.tasks.TaskVerdict()


def test_a_task_observes_what_it_draws_under_one_name():
    @rc.register_task("one_of_two")
    class Registered(OneOfTwo):
        pass

    env = rc.Env(pick_cube_config(task={"kind": "one_of_two"}))
    said = set()
    for seed in range(16):
        observation, info = env.reset(seed=seed)
        drawn = info["instruction"].split()[3]
        said.add(drawn)
        body = env.scene.compiled.object(drawn).root_body
        place = env.scene.body_pose(body).translation
        np.testing.assert_allclose(env.row()["objects/target/pose"][:3], place, atol=1e-9)
        assert set(observation["objects"]) == {"target"}
    assert said == {"red", "blue"}
    env.close()

    @rc.register_task("one_of_none")
    class Wrong(OneOfTwo):
        def object_of(self, name):
            return "gren"

    with pytest.raises(rc.Error, match=r"no object 'gren'. Its objects: cube, red"):
        rc.Env(pick_cube_config(task={"kind": "one_of_none"}))


def test_rejects_tasks_without_a_name_or_a_required_field():
    with pytest.raises(rc.ArgumentError, match="must be a name that is not empty"):
        rc.register_task("")(Reach)
    with pytest.raises(rc.SpecError, match=r"task.spread: is about the place that `object` has"):
        rc.Env(pick_cube_config(task={"kind": "pick", "spread": [0.1, 0]}))
    with pytest.raises(rc.NotFoundError, match=r"task.kind: no task ''"):
        rc.Env(pick_cube_config(task={"kind": ""}))
    with pytest.raises(TypeError, match=r"a PickTaskConfig: no field 'goal'"):
        rc.Env(pick_cube_config(task={"object": "cube", "goal": [0.4, 0, 0]}))


ALONE = """
import numpy as np
import robocell as rc
from robocell.gym import pick_cube_config


class Reach(rc.tasks.Task):
    def bind(self, scene, setting):
        self.robot = scene.robot("robot")

    def reward(self, scene):
        return float(np.zeros(1)[0])

    def success(self, scene):
        return False

    def instruction(self):
        return "reach"


rc.register_task("reach")(Reach)
config = pick_cube_config(task={"kind": "reach"})
"""


@pytest.mark.parametrize(
    "made",
    ["env = rc.Env(config)", "env = rc.envs.EnvBatch(config, 2)", "env = GymEnv(config)"],
)
def test_a_script_that_exits_with_an_environment_reports_no_leaks(tmp_path, made):
    script = tmp_path / "script.py"
    script.write_text(f"{ALONE}\nfrom robocell.gym import GymEnv\n{made}\nenv.reset()\n")
    done = subprocess.run(
        [sys.executable, script],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert done.stderr == ""


@pytest.mark.parametrize("make", [rc.Env, lambda config: rc.envs.EnvBatch(config, 2)])
def test_an_environment_and_its_task_are_collected(make):
    class Circle(Silent):
        env = None

        def bind(self, scene, setting):
            self.robot = scene.robot("robot")

        def success(self, scene):
            return False

    rc.register_task("circle")(Circle)
    env = Circle.env = make(pick_cube_config(task={"kind": "circle"}))
    env.reset()
    gone = weakref.ref(env)
    rc.register_task("circle")(lambda: Silent())
    del env
    gc.collect()
    assert gone() is not None, "the class is still here"
    del Circle
    gc.collect()
    assert gone() is None


def _hook_of(env):
    """A hook of the environment's scene that refers to the environment, and a sign of its life."""

    class Hook:
        def __init__(self, env):
            self.env = env

        def __call__(self, reset):
            pass

    hook = Hook(env)
    (getattr(env, "core", env)).scene.on_reset(hook)
    return weakref.ref(hook)


@pytest.mark.parametrize(
    "make", [rc.Env, lambda config: rc.envs.EnvBatch(config, 2), rc.gym.GymEnv]
)
def test_an_environment_and_a_hook_of_its_scene_are_collected(make):
    env = make(pick_cube_config())
    env.reset()
    gone = _hook_of(env)
    gc.collect()
    assert gone() is not None, "the environment is still here"
    env.reset()
    del env
    gc.collect()
    assert gone() is None


def test_a_hook_lives_while_a_handle_to_the_scene_of_its_environment_does():
    env = rc.Env(pick_cube_config())
    gone = _hook_of(env)
    robot = env.scene.robot("robot")
    del env
    gc.collect()
    assert gone() is not None
    del robot
    gc.collect()
    assert gone() is None


def test_a_task_that_keeps_the_scene_does_not_keep_the_environment():
    class Keeper(Silent):
        def bind(self, scene, setting):
            self.scene = scene

        def observe(self, scene):
            self.seen = scene
            return {}

        def success(self, scene):
            return False

    rc.register_task("keeper_of_test")(Keeper)
    env = rc.Env(pick_cube_config(task={"kind": "keeper_of_test"}))
    env.reset()
    gone = _hook_of(env)
    gc.collect()
    assert gone() is not None
    env.reset()
    del env
    gc.collect()
    assert gone() is None


def test_a_start_refused_by_the_task_is_drawn_again_or_reported():
    @rc.register_task("choosy_of_test")
    class Choosy(rc.tasks.Task):
        tries = 0
        checks = 0

        @dataclass
        class Fields:
            never: bool = False

        def __init__(self, fields):
            super().__init__()
            self.never = fields.never

        def arrange(self, scene, rng):
            Choosy.tries += 1
            if self.never or Choosy.tries % 3:
                return rc.tasks.Refusal("too crowded", "by one")
            return None

        def judge(self, scene):
            return rc.tasks.TaskVerdict()

        def instruction(self):
            return "wait"

        def check_start(self, scene):
            Choosy.checks += 1
            return rc.tasks.Refusal("too dark") if Choosy.checks % 2 else None

    config = pick_cube_config()
    config.task = {"kind": "choosy_of_test"}
    env = rc.Env(config)
    env.reset(seed=1)
    assert Choosy.tries % 3 == 0
    assert Choosy.checks > 0
    assert Choosy.checks % 2 == 0
    config.task = {"kind": "choosy_of_test", "never": True}
    with pytest.raises(rc.SpecError, match=r"the task refused: too crowded \(by one\)"):
        rc.Env(config)
