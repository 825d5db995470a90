"""Policies: what is trained on a dataset acts in the cells that the dataset was made in.

    class Mine(Policy):
        def act(self, observation):
            q = self.network(observation["robots/rc7/arm/qpos"], observation["objects/target/pose"])
            return {"robots/rc7/action/arm": q}  # (n,): one action, (k, n): a chunk of k

Observations and actions have the names of a dataset's columns, so that nothing has to be mapped:
an observation is the row of state that the dataset records before each action, and its image
streams; an action is one or more of the columns `robots/<robot>/action/...`.
"""

from __future__ import annotations

import importlib
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robocell._core import (
    ArgumentError,
    EpisodeStart,
    Expert,
    GroupCommand,
    NotFoundError,
    Pose,
    Renderer,
    Rng,
    Robot,
    RunConfig,
    Scene,
    SpecError,
)
from robocell.tasks import register_expert

Observation = dict[str, NDArray[Any]]
Action = Mapping[str, ArrayLike]


@dataclass(frozen=True)
class Context:
    """What a policy is told when a rollout begins.

    Attributes:
        instruction: What is to be done, in words.
        run: The cell's configuration.
        seed: For policies that draw numbers; it follows from run, episode and attempt.
    """

    instruction: str
    run: RunConfig
    seed: int


class Policy:
    """Acts from observations alone. Subclass it with `act`, and `reset` where it remembers."""

    def reset(self, context: Context) -> None:
        """Forgets the last rollout."""

    def act(self, observation: Observation) -> Action:
        """The next action, or the next few.

        Args:
            observation: The columns of the present state by their names: `time`,
                `robots/<robot>/<group>/qpos` and `/qvel` (rad, m), `base_pose`, `tcp_pose`,
                `tcp_pose_in_base` (xyz in metres, quaternion xyzw), `opening`,
                `objects/<object>/pose`, and an image (height, width, 3) for each stream.

        Returns:
            Columns `robots/<robot>/action/<group>`, absolute joint positions or an opening, or
            `robots/<robot>/action/tcp_pose`, the TCP in the robot's base frame. An array with one
            dimension more is a chunk: its actions are taken one after the other before `act` is
            called again.
        """
        raise NotImplementedError


class PolicyExpert(Expert):
    """Lets a policy act in rollouts. It sees what a dataset records, not the simulation."""

    def __init__(self, run: RunConfig, start: EpisodeStart, policy: Policy) -> None:
        super().__init__()
        self._run, self._task, self._policy = run, start.task, policy
        self._objects = list(start.task.objects())
        self._chunk: deque[dict[str, NDArray[np.float64]]] = deque()
        self._renderer: Renderer | None = None

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Resets the policy."""
        self._robot = scene.robot(self._run.robot.name)
        self._chunk.clear()
        context = Context(self._task.instruction(), self._run, rng.integer(2**31))
        self._policy.reset(context)

    def act(self, scene: Scene, rng: Rng) -> dict[str, dict[str, GroupCommand]]:
        """The next action of the policy's chunk, or of a new one."""
        if not self._chunk:
            self._chunk.extend(self._actions(self._policy.act(self.observation(scene))))
        commands = {}
        for name, values in self._chunk.popleft().items():
            group, command = self._command(name, values)
            commands[group] = command
        return {self._robot.name: commands}

    def observation(self, scene: Scene) -> Observation:
        """The row that a dataset records of this state, with its images."""
        robot, name = self._robot, f"robots/{self._robot.name}"
        row: Observation = {"time": np.array(scene.time())}
        arms = 0
        for group in robot.group_names:
            part = robot.group(group)
            if len(part.joint_pos):
                row[f"{name}/{group}/qpos"] = np.array(part.joint_pos)
                row[f"{name}/{group}/qvel"] = np.array(part.joint_vel)
            arms += part.kind == "arm"
        row[f"{name}/base_pose"] = _row(robot.base_in_world)
        if arms:
            row[f"{name}/tcp_pose"] = _row(robot.tcp_in_world)
            row[f"{name}/tcp_pose_in_base"] = _row(robot.fk_frame())
        if robot.has_gripper:
            row[f"{name}/opening"] = np.array(robot.gripper.opening)
        for entry in self._objects:
            body = scene.compiled.object(entry).root_body
            row[f"objects/{entry}/pose"] = _row(scene.body_pose(body))
        return row | self._images(scene)

    def _images(self, scene: Scene) -> Observation:
        if not self._run.cameras.streams:
            return {}
        if self._renderer is None:
            self._renderer = Renderer(scene)
        width, height = self._run.cameras.resolution
        images: Observation = {}
        for stream in self._run.cameras.streams:
            drawn = self._renderer.render(
                stream.camera, stream.width or int(width), stream.height or int(height)
            )
            images[stream.name] = drawn["rgb"]
        return images

    def _actions(self, action: Action) -> list[dict[str, NDArray[np.float64]]]:
        """A chunk as single actions."""
        if not isinstance(action, Mapping) or not action:
            raise TypeError(
                f"{type(self._policy).__name__}.act() must return a dict of columns "
                f"'robots/{self._robot.name}/action/...' to numbers, got {action!r}"
            )
        arrays = {name: np.asarray(values, dtype=np.float64) for name, values in action.items()}
        sizes = {name: self._size(name) for name in arrays}
        lengths = set()
        for name, array in arrays.items():
            if array.shape == () and sizes[name] == 1:
                array = arrays[name] = array.reshape(1)
            if array.ndim not in (1, 2) or array.shape[-1] != sizes[name] or not array.size:
                raise ArgumentError(
                    f"{type(self._policy).__name__}.act(): '{name}' has {sizes[name]} numbers, or "
                    f"(k, {sizes[name]}) for a chunk; got the shape {array.shape}"
                )
            if not np.isfinite(array).all():
                raise ArgumentError(
                    f"{type(self._policy).__name__}.act(): '{name}' is not finite: {array}"
                )
            lengths.add(array.shape[0] if array.ndim == 2 else 0)
        if len(lengths) > 1:
            raise ArgumentError(
                f"{type(self._policy).__name__}.act(): columns of one chunk differ in length: "
                f"{sorted(lengths)}"
            )
        (length,) = lengths
        if length == 0:
            return [arrays]
        return [{name: array[i] for name, array in arrays.items()} for i in range(length)]

    def _size(self, name: str) -> int:
        known = self._columns()
        if name not in known:
            raise NotFoundError(
                f"{type(self._policy).__name__}.act(): no action '{name}'. "
                f"The actions of this cell: {', '.join(known)}"
            )
        return known[name]

    def _columns(self) -> dict[str, int]:
        robot, name = self._robot, f"robots/{self._robot.name}/action"
        columns = {}
        for group in robot.group_names:
            kind = robot.group(group).kind
            if kind == "gripper":
                columns[f"{name}/{group}"] = 1
            elif kind == "arm":
                columns[f"{name}/{group}"] = len(robot.group(group).joint_pos)
                columns[f"{name}/tcp_pose"] = 7
        return columns

    def _command(self, name: str, values: NDArray[np.float64]) -> tuple[str, GroupCommand]:
        part = name.rpartition("/")[2]
        if part == "tcp_pose":
            return _arm_of(self._robot), GroupCommand.leaf_pose(
                Pose(translation=values[:3], quaternion=values[3:] / np.linalg.norm(values[3:]))
            )
        if self._robot.group(part).kind == "gripper":
            return part, GroupCommand.opening(float(np.clip(values[0], 0, 1)))
        return part, GroupCommand.joints(values)

    def done(self) -> bool:
        """Never by itself: the rollout ends at success or when its steps are used up."""
        return False

    def ends_at_success(self) -> bool:
        """A policy does not know when it is done."""
        return True

    def failure(self) -> str:
        """What came of it is the task's to say."""
        return ""

    def phase(self) -> int:
        """There is one."""
        return 0

    def phase_names(self) -> list[str]:
        """None."""
        return []


def _row(pose: Pose) -> NDArray[np.float64]:
    return np.concatenate([pose.translation, pose.quaternion])


def _arm_of(robot: Robot) -> str:
    return next(group for group in robot.group_names if robot.group(group).kind == "arm")


def register_policy(name: str, make: Callable[[RunConfig], Policy]) -> None:
    """Makes a policy known as a kind of expert, for the `expert` of a run.

    It is made once in each process, as `make(run)`, and reset for each rollout.
    """
    made: list[Policy] = []

    def expert(run: RunConfig, start: EpisodeStart) -> Expert:
        if not made:
            made.append(make(run))
        return PolicyExpert(run, start, made[0])

    module = getattr(make, "__module__", None)
    expert.__module__ = module or __name__
    register_expert(name)(expert)


def register_named_policy(name: str, folder: Path) -> None:
    """Registers `module:Class`, `file.py:Class` or `file.py:function` under that text.

    The class is made as `Class()`, or as `Class(run)` when it takes an argument.
    """
    import inspect

    from robocell.generate.run_source import import_module

    module_name, _, attribute = name.rpartition(":")
    module = import_module(module_name, folder)
    maker = getattr(module, attribute, None)
    if not callable(maker):
        raise SpecError(
            f"policy '{name}': module '{module_name}' has no class or function '{attribute}'"
        )

    def make(run: RunConfig) -> Policy:
        try:
            takes_run = bool(inspect.signature(maker).parameters)
        except ValueError:
            takes_run = False
        policy = maker(run) if takes_run else maker()
        if not hasattr(policy, "act") or not hasattr(policy, "reset"):
            raise SpecError(
                f"policy '{name}': expected an object with reset(context) and act(observation), "
                f"as robocell.policy.Policy has, got a {type(policy).__name__}"
            )
        return policy

    make.__module__ = module.__name__
    register_policy(name, make)


class RandomPolicy(Policy):
    """Moves the arm's joints at random around where they are: what a policy has to beat."""

    def __init__(self, run: RunConfig) -> None:
        self._name = run.robot.name
        self._rng = np.random.default_rng(0)

    def reset(self, context: Context) -> None:
        """Begins its numbers anew."""
        self._rng = np.random.default_rng(context.seed)

    def act(self, observation: Observation) -> Action:
        """A step of up to 0.1 rad for each joint, and any opening."""
        q = observation[f"robots/{self._name}/arm/qpos"]
        return {
            f"robots/{self._name}/action/arm": q + self._rng.uniform(-0.1, 0.1, q.shape),
            f"robots/{self._name}/action/gripper": self._rng.uniform(0, 1, 1),
        }


def import_attribute(name: str) -> Any:
    """`module:attribute`."""
    module, _, attribute = name.partition(":")
    return getattr(importlib.import_module(module), attribute)
