"""The parts of a run that registered experiments provide: sampler of starts, and features.

`register_config` registers them when the experiment's module is imported, in each worker too.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell.compat.molmo_spaces._groups import OwnMoveGroup
from robocell.compat.molmo_spaces.env.env import CPUMujocoEnv
from robocell.compat.molmo_spaces.robots.robot_views.abstract import GripperGroup, RobotBaseGroup
from robocell.compat.molmo_spaces.tasks.pick_task_sampler import PickTaskSampler

PREFIX = "molmo_spaces_"
MODULES_OF_EXPERIMENTS: dict[str, type] = {}


def sampler_kind(name: str) -> str:
    """Returns the name of an experiment's sampler in run files."""
    return PREFIX + name


def register_parts(name: str, kind: type) -> None:
    """Registers the sampler of an experiment's class."""
    MODULES_OF_EXPERIMENTS[name] = kind
    sampler = type(f"{name}Starts", (ExperimentStarts,), {"experiment_class": kind})
    rc.tasks.register_sampler(sampler_kind(name))(sampler)


class ExperimentStarts(rc.tasks.StartSampler):
    """Starts of an experiment: robocell's, with the user's groups and place of the robot.

    Attributes:
        experiment: The experiment.
        sampler: The user's PickTaskSampler.
    """

    experiment_class: type

    def __init__(self, run: rc.RunConfig) -> None:
        """Makes the experiment."""
        super().__init__(run)
        self.experiment: Any = self.experiment_class()
        self.sampler = sampler_class(self.experiment)(self.experiment)

    def propose_base_pose(
        self,
        robot: rc.Robot,
        support: rc.scenes.Support,
        target_in_world: rc.Pose,
        placement: rc.tasks.BasePlacement,
        rng: rc.tasks.Rng,
    ) -> rc.Pose | None:
        """Returns the place that the user's sampler chooses, or robocell's."""
        inherited = super().propose_base_pose
        own = type(self.sampler)._sample_and_place_robot
        if own is PickTaskSampler._sample_and_place_robot:
            return inherited(robot, support, target_in_world, placement, rng)
        scene = robot.scene
        body = scene.compiled.object("target").root_body
        scene.set_body_pose(body, target_in_world)
        robot.base.pose = rc.Pose()  # where the original's scenes begin
        scene.forward()
        seed = rng.integer(2**31)
        random.seed(seed)
        np.random.seed(seed)  # noqa: NPY002
        return self.sampler.place(
            environment(scene, self.experiment),
            body,
            target_in_world,
            lambda: inherited(robot, support, target_in_world, placement, rng),
        )

    def sample(
        self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
    ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
        """Returns a start whose robot has the user's groups."""
        start = super().sample(request, rng)
        if isinstance(start, rc.tasks.EpisodeStart):
            install_groups(start.scene.robot(self.run.robot.name), self.experiment)
        return start


def sampler_class(experiment: Any) -> type[PickTaskSampler]:
    """Returns the experiment's class of samplers. Raises ArgumentError for any other class."""
    kind = experiment.task_sampler_config.task_sampler_class or PickTaskSampler
    if not issubclass(kind, PickTaskSampler):
        raise rc.ArgumentError(
            f"task_sampler_class: {kind.__name__} is not a subclass of PickTaskSampler"
        )
    return kind


def environment(scene: rc.Scene, experiment: Any) -> CPUMujocoEnv:
    """Returns the user's robot in a scene of robocell, on the scene's own model and data."""
    robot = scene.robots[0]
    config = experiment.model_copy(
        update={
            "robot_config": experiment.robot_config.model_copy(
                update={"robot_namespace": robot.prefix}
            )
        }
    )
    return CPUMujocoEnv(config, scene.model, scene.data)


def install_groups(robot: rc.Robot, experiment: Any) -> None:
    """Replaces groups of a robot by the user's where these read or write otherwise.

    A gripper stays robocell's, which its planner measures, and so does the base that it places.
    """
    known = set(robot.group_names)
    view = experiment.robot_config.robot_view_factory(robot.scene.data, robot.prefix)
    for name in view.move_group_ids():
        group = view.get_move_group(name)
        if isinstance(group, GripperGroup | RobotBaseGroup):
            continue
        if name not in known or _is_different(group):
            robot.set_group(OwnMoveGroup(group))


_SAME = ("joint_pos", "joint_vel", "ctrl", "noop_ctrl", "ctrl_limits", "joint_pos_limits")


def _is_different(group: Any) -> bool:
    """Returns True if a user's class redefines how a group is read, written or held."""
    ours = "robocell.compat."
    for name in (*_SAME, "get_jacobian", "leaf_frame_to_world", "integrate_joint_vel"):
        owner = next(kind for kind in type(group).__mro__ if name in vars(kind))
        if not owner.__module__.startswith(ours):
            return True
    return False


class _Sensors:
    """The user's sensors on the scene that was read last."""

    def __init__(self, experiment_class: type) -> None:
        self.experiment_class = experiment_class
        self.scene: rc.Scene | None = None
        self.generation = -1
        self.env: CPUMujocoEnv | None = None
        self.sensors: dict[str, Any] = {}

    def read(self, scene: rc.Scene, uuid: str) -> NDArray[np.float64]:
        if self.env is None or self.scene != scene or self.generation != scene.generation:
            self.env = environment(scene, self.experiment_class())
            self.sensors = {
                sensor.uuid: sensor for sensor in self.env.current_robot.create_robot_sensors()
            }
            self.scene, self.generation = scene, scene.generation
        return np.asarray(self.sensors[uuid].get_observation(self.env, None, 0), dtype=np.float64)


def register_sensors(name: str, sensors: Sequence[tuple[str, tuple[int, ...], str]]) -> None:
    """Registers the sensors (uuid, shape, unit) of an experiment's robot as features."""
    own = _Sensors(MODULES_OF_EXPERIMENTS[name])
    for uuid, shape, unit in sensors:

        def read(scene: rc.Scene, uuid: str = uuid) -> NDArray[np.float64]:
            return own.read(scene, uuid)

        rc.features.register_feature(uuid, shape=shape, units=unit)(read)
