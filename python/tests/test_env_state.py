"""States of environments as values, saved scenes, objects that vary."""

from __future__ import annotations

import enum
import pickle
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

import numpy as np
import pytest

import robocell as rc
from robocell.gym import VectorGymEnv, pick_cube_config

ELSEWHERE = rc.Pose(translation=[1, -1, 0], rpy=[0, 0, 2])


def config(**fields) -> rc.EnvConfig:
    return pick_cube_config(relative_to="last_step", **fields)


def act(env: rc.Env, steps: int = 3):
    for i in range(steps):
        observation, *_ = env.step(
            {"robot": {"tquat": [0, 0.02, -0.02, 0, 0, 0, 1], "gripper": i % 2}}
        )
    return observation


def same(a, b, tolerance=0.0):
    assert a.keys() == b.keys()
    for key, value in a.items():
        if isinstance(value, dict):
            same(value, b[key], tolerance)
        else:
            assert np.abs(value - b[key]).max() <= tolerance, key


def test_a_state_continues_in_another_environment():
    env, other = rc.Env(config()), rc.Env(config())
    env.reset(seed=1)
    act(env)
    state = pickle.loads(pickle.dumps(env.get_state()))
    then = act(env)
    other.set_state(rc.envs.EnvState(state.numbers))
    same(act(other), then)
    with pytest.raises(rc.ArgumentError, match="must be one of world, root, got 'rot'"):
        other.set_state(state, frame="rot")


def test_a_state_can_be_restored_at_another_root_pose():
    env, other = rc.Env(config()), rc.Env(config(root_frame_to_world=ELSEWHERE))
    env.reset(seed=1)
    state = env.get_state()
    same(other.set_state(state, frame="root"), env.set_state(state), 1e-9)
    same(act(other), act(env), 1e-5)


def test_a_saved_scene_can_be_simulated(tmp_path):
    env = rc.Env(config())
    env.reset(seed=1)
    env.scene.save_xml(tmp_path / "cell.xml")
    saved = rc.Env(config(saved_scene=str(tmp_path / "cell.xml")))
    saved.reset(seed=1)
    same(act(saved), act(env), 1e-3)


def test_copies_of_a_vector_vary_their_objects_independently():
    varied = config(variations={"cube": {"mass": [0.5, 2], "friction": [0.5, 1.5], "colour": 0.3}})
    vector = VectorGymEnv(varied, 2, threads=2)
    single = rc.Env(varied)
    vector.reset(seed=[1, 2])
    action = {"robot": {"tquat": [[0, 0, -0.04, 0, 0, 0, 1]] * 2, "gripper": [[1], [1]]}}
    seen, *_ = vector.step(action)
    masses = []
    for i, seed in enumerate((1, 2)):
        single.reset(seed=seed)
        masses.append(single.scene.model.body("cube_green_cube").mass[0])
        alone, *_ = single.step({"robot": {"tquat": [0, 0, -0.04, 0, 0, 0, 1], "gripper": 1}})
        assert np.array_equal(
            alone["objects"]["cube"]["tquat"], seen["objects"]["cube"]["tquat"][i]
        )
        assert np.array_equal(alone["robot"]["joints"], seen["robot"]["joints"][i])
    assert masses[0] != masses[1]
    assert all(0.025 <= mass <= 0.1 for mass in masses)
    vector.close()


def test_rejects_the_state_of_another_robot():
    """Also where it has as many numbers."""
    env, other = rc.Env(config()), rc.Env(renamed())
    env.reset(seed=1)
    other.reset(seed=1)
    state = env.get_state()
    assert len(state.numbers) == len(other.get_state().numbers)
    before = other.get_state().numbers
    with pytest.raises(rc.ArgumentError, match="the state is of another environment; states fit"):
        other.set_state(state)
    assert np.array_equal(other.get_state().numbers, before)
    act(other)
    env.close()
    other.close()


def renamed() -> rc.EnvConfig:
    """The same cell, whose cube has another name."""
    own = config()
    objects = {"die": own.root_frame_objects["cube"]}
    return config(root_frame_objects=objects, task={"object": "die"})


def test_invalid_states_change_nothing():
    env = rc.Env(config())
    env.reset(seed=1)
    whole = env.get_state().numbers
    task = 9 + int(whole[8]) + 1  # what a task remembers is its own business
    indices = {0, 3, 7, 8, *range(9, len(whole), 7)} - {*range(task, task + int(whole[task - 1]))}
    refused = 0
    for i in sorted(indices):
        for bad in (np.nan, np.inf):
            numbers = whole.copy()
            numbers[i] = bad
            with pytest.raises(rc.ArgumentError) as told:
                env.set_state(rc.envs.EnvState(numbers))
            refused += f"'pick_cube': number {i} of the state is {bad}" in str(told.value)
            assert np.array_equal(env.get_state().numbers, whole)
    assert refused > len(indices)
    act(env)
    env.close()


def test_a_saved_state_needs_a_name():
    env = rc.Env(config())
    env.reset(seed=1)
    with pytest.raises(rc.ArgumentError, match="'pick_cube': a saved state needs a name"):
        env.save("")
    env.close()


class Pushed(rc.tasks.Task):
    """Remembers in attributes what is drawn, and where the cube was; it defines no memory()."""

    class Phase(enum.Enum):
        FAR = 1
        NEAR = 2

    class Tracker:
        def __init__(self) -> None:
            self.best = np.inf

    def __init__(self) -> None:
        super().__init__()
        self.gain = 2.0
        self.tracker = self.Tracker()

    def bind(self, scene, setting):
        self.robot = scene.robot("robot")

    def arrange(self, scene, rng):
        self.point = [rng.uniform(), rng.uniform()]

    def begin(self, scene):
        self.start = scene.body_pose("cube_green_cube")
        self.phase = self.Phase.FAR
        self.seen = {"steps": 0, "poses": (np.zeros(2), None)}
        self.tracker.best = np.inf

    def judge(self, scene):
        self.seen["steps"] += 1
        tcp = self.robot.tcp_in_world.translation
        near = np.linalg.norm(tcp - self.start.translation)
        self.tracker.best = min(self.tracker.best, near)
        self.phase = self.Phase.NEAR
        reward = self.gain * self.tracker.best + sum(self.point) + 0.1 * self.seen["steps"]
        return rc.tasks.TaskVerdict(reward=reward + self.phase.value)

    def instruction(self):
        return "push it"


def rewards_after(env: rc.Env, count: int = 3) -> list[float]:
    return [env.step(STAY_HERE)[1] for _ in range(count)]


STAY_HERE = {"robot": {"tquat": [0.02, 0.01, -0.02, 0, 0, 0, 1], "gripper": 1}}


def pushed_config(task: type[rc.tasks.Task] = Pushed, **fields) -> rc.EnvConfig:
    kind = task.__name__.lower() + "_of_states"
    rc.register_task(kind)(task)
    return pick_cube_config(task={"kind": kind}, relative_to="last_step", **fields)


@pytest.mark.parametrize("steps", [0, 2])
def test_a_task_without_memory_keeps_its_attributes(steps):
    env = rc.Env(pushed_config())
    env.reset(seed=1)
    rewards_after(env, steps)
    env.save("here")
    state = pickle.loads(pickle.dumps(env.get_state()))
    expected = rewards_after(env)
    env.reset(seed=5)
    rewards_after(env, 1)
    env.restore("here")
    assert rewards_after(env) == expected
    fresh = rc.Env(pushed_config())
    fresh.set_state(state)
    assert rewards_after(fresh) == expected
    env.close()
    fresh.close()


def test_fields_of_the_configuration_are_not_part_of_a_state():
    class Graded(Pushed):
        @dataclass
        class Fields:
            gain: float = 2.0

        def __init__(self, fields):
            super().__init__()
            self.gain = fields.gain

    config = pushed_config(Graded)
    env = rc.Env(config)
    env.reset(seed=1)
    state = env.get_state()
    config.task.gain = 0.0
    other = rc.Env(config)
    other.set_state(state)
    assert rewards_after(env, 1)[0] > rewards_after(other, 1)[0]
    env.close()
    other.close()


def test_rejects_attributes_that_a_state_cannot_store():
    class Draws(Pushed):
        def begin(self, scene):
            super().begin(scene)
            self.rng = np.random.default_rng(1)

    env = rc.Env(pushed_config(Draws))
    env.reset(seed=1)
    with pytest.raises(rc.ArgumentError) as caught:
        env.save("here")
    said = str(caught.value)
    assert "task 'Draws': its state cannot be saved, because attribute 'rng' holds a" in said
    assert said.endswith(
        "Define memory(), which returns what the episode has set as numbers, and recall(memory), "
        "which restores it"
    )
    env.close()


def test_rejects_memory_without_recall():
    class Half(Pushed):
        def memory(self):
            return [1.0]

    env = rc.Env(pushed_config(Half))
    env.reset(seed=1)
    with pytest.raises(TypeError, match=r"Half must define recall\(\)"):
        env.save("here")
    env.close()


def test_rejects_task_attributes_at_another_root_pose():
    env = rc.Env(pushed_config())
    env.reset(seed=1)
    state = env.get_state()
    moved = rc.Env(pushed_config(root_frame_to_world=rc.Pose(translation=[1, 0, 0])))
    with pytest.raises(rc.ArgumentError, match=r"has no memory\(\) of its own"):
        moved.set_state(state, frame="root")
    env.close()
    moved.close()


def test_a_guarded_step_needs_no_memory():
    class Random(Pushed):
        def begin(self, scene):
            super().begin(scene)
            self.rng = np.random.default_rng(1)

    env = rc.Env(pushed_config(Random, sim={"on_collision": "guard"}))
    env.reset(seed=1)
    assert len(rewards_after(env)) == 3
    env.close()


def shared_below_the_top() -> dict[str, object]:
    point = np.zeros(2)
    return {"path": (None, point), "by_name": {"first": None, "last": point}}


def a_view() -> dict[str, object]:
    table = np.zeros((3, 2))
    return {"table": table, "row": table[1]}


@pytest.mark.parametrize(
    ("made", "told"),
    [
        (lambda: {"rng": rc.tasks.Rng.stream(1, "x")}, r"'rng' holds a robocell\..*Rng, which"),
        (lambda: {"best": rc.tasks.TaskVerdict(reward=2)}, r"'best' holds a .*TaskVerdict"),
        (lambda: dict.fromkeys(("one", "two"), np.zeros(3)), "'two' is the same object as 'one'"),
        (shared_below_the_top, r"'by_name\['last'\]' is the same object as 'path\[1\]'"),
        (lambda: {"pair": [np.zeros(2)] * 2}, r"'pair\[1\]' is the same object as 'pair\[0\]'"),
        (a_view, "'row' is the same object as 'table' or shares its numbers"),
    ],
)
def test_rejects_attributes_that_would_change_on_restore(made, told: str):
    class Keeps(Pushed):
        def begin(self, scene):
            super().begin(scene)
            vars(self).update(made())

    env = rc.Env(pushed_config(Keeps))
    env.reset(seed=1)
    with pytest.raises(rc.ArgumentError, match=told):
        env.save("here")
    env.close()


def counter():
    count = 0

    def next_one() -> int:
        nonlocal count
        count += 1
        return count

    return next_one


def with_default(seen: list[int] = []) -> int:  # noqa: B006  (what is tested)
    seen.append(0)
    return len(seen)


class Log:
    lines: ClassVar[list[int]] = []


class Keeping(Pushed):
    noted: ClassVar[list[int]] = []
    table: ClassVar[np.ndarray] = np.zeros(2)
    share = Fraction(1, 3)

    def bind(self, scene, setting):
        super().bind(scene, setting)
        self.count, self.log, self.take = counter(), Log(), with_default
        self.add = [1].append
        self.name_of = lambda: type(self).__name__  # has no state of its own

    def begin(self, scene):
        super().begin(scene)
        self.change()

    def change(self):
        pass


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda task: task.count(), "'count' holds a function with a closure, defaults or"),
        (lambda task: task.take(), "'take' holds a function with a closure, defaults or"),
        (lambda task: setattr(task, "new", counter()), "'new' holds a function with a closure"),
        (lambda task: task.add(3), "'add' holds a function with a closure"),
        (lambda task: task.noted.append(1), "'noted' of class 'Changes' has changed, and all"),
        (lambda task: task.table.fill(1), "'table' of class 'Changes' has changed, and all"),
        (lambda task: Log.lines.append(1), "'lines' of class 'Log' has changed, and all tasks"),
        (
            lambda task: setattr(type(task), "rng", np.random.default_rng(1)),
            "'rng' of class 'Changes' is no value that can be kept, and all",
        ),
    ],
)
def test_rejects_what_functions_and_classes_keep_of_an_episode(change, told: str):
    class Changes(Keeping):
        noted: ClassVar[list[int]] = []
        table: ClassVar[np.ndarray] = np.zeros(2)

        def change(self):
            if not hasattr(self, "done"):
                self.done = True
                change(self)

    env = rc.Env(pushed_config(Changes))
    env.reset(seed=1)
    with pytest.raises(rc.ArgumentError, match=told):
        env.save("here")
    env.close()


def test_functions_and_classes_that_stay_do_not_hinder_saving():
    env = rc.Env(pushed_config(Keeping))
    env.reset(seed=1)
    rewards_after(env, 2)
    state = env.get_state()
    expected = rewards_after(env)
    env.set_state(state)
    assert rewards_after(env) == expected
    env.close()


def test_a_first_state_starts_the_task():
    parts = [2]

    class Holds(Pushed):
        def begin(self, scene):
            super().begin(scene)
            self.cup = scene.robot("robot")  # a handle, which no state has
            self.names = [f"part {i}" for i in range(parts[0])]

        def subtasks(self):
            return self.names

        def judge(self, scene):
            reward = super().judge(scene).reward + self.cup.tcp_in_world.translation[2]
            return rc.tasks.TaskVerdict(reward=reward, subtask=len(self.names) - 1)

    env = rc.Env(pushed_config(Holds))
    env.reset(seed=1)
    rewards_after(env, 2)
    state = env.get_state()
    expected = rewards_after(env)
    fresh = rc.Env(pushed_config(Holds))
    fresh.set_state(state)
    assert rewards_after(fresh) == expected
    parts[0] = 3
    env.reset(seed=2)
    rewards_after(env, 1)
    longer = env.get_state()
    fresh.set_state(longer)
    assert rewards_after(fresh) == rewards_after(env)
    env.close()
    fresh.close()


def test_an_error_in_begin_names_its_place():
    class Raises(Pushed):
        fails = False

        def begin(self, scene):
            super().begin(scene)
            if Raises.fails:
                raise ValueError("boom")

    env = rc.Env(pushed_config(Raises))
    env.reset(seed=1)
    state = env.get_state()
    Raises.fails = True
    with pytest.raises(ValueError, match="boom") as caught:
        env.set_state(state)
    assert caught.traceback[-1].path.name == "test_env_state.py"
    env.close()
