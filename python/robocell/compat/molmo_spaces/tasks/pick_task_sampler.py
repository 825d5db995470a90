"""The sampler of picks, whose place of the robot can be replaced."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import robocell as rc
from robocell.compat.molmo_spaces.env.env import CPUMujocoEnv
from robocell.compat.molmo_spaces.utils.pose import pose_mat_to_7d

__all__ = ["PickTaskSampler"]

LIFT = 0.05  # m, of the goal above the start


class PickTaskSampler:
    """Places the robot for a pick. Objects, scenes and checks are robocell's.

    A subclass may define `_sample_and_place_robot`. Runs call it once for each place that is tried,
    and check reach and collisions of the result.

    Attributes:
        config: A copy of the experiment; its `task_config` has the object of the episode.
    """

    def __init__(self, config: Any) -> None:
        """Copies the experiment, so that `task_config` is this sampler's own."""
        self.config = config.model_copy(deep=True)
        self._propose: Callable[[], rc.Pose | None] | None = None

    def _sample_and_place_robot(self, env: CPUMujocoEnv) -> None:
        """Puts the robot's base, which is at the origin, where the robot is to stand.

        Unless a subclass replaces it, somewhere in the ranges of `task_sampler_config`.

        Sets `robot_base_pose` and the poses of the object in `config.task_config`. Raises Error if
        no place is free.
        """
        if self._propose is None:
            raise rc.Error(
                f"{type(self).__name__}: a place is drawn only while a run samples a start. "
                "Outside of runs, define _sample_and_place_robot in a subclass"
            )
        pose = self._propose()
        if pose is None:
            raise rc.Error("no free place for the robot around the object")
        env.current_robot.robot_view.base.pose = pose.matrix
        self.config.task_config.robot_base_pose = pose_mat_to_7d(pose.matrix).tolist()

    def place(
        self,
        env: CPUMujocoEnv,
        object_name: str,
        object_pose: rc.Pose,
        propose: Callable[[], rc.Pose | None],
    ) -> rc.Pose | None:
        """Returns where `_sample_and_place_robot` puts the base; None if there is no place.

        Args:
            env: The environment, with the robot.
            object_name: Body of the object.
            object_pose: Where the object is going to lie, in the world.
            propose: Returns a place of robocell's, or None.
        """
        task = self.config.task_config
        matrix = object_pose.matrix
        task.pickup_obj_name = object_name
        task.pickup_obj_start_pose = pose_mat_to_7d(matrix).tolist()
        matrix = matrix.copy()
        matrix[2, 3] += LIFT
        task.pickup_obj_goal_pose = pose_mat_to_7d(matrix).tolist()
        failed = False

        def propose_once() -> rc.Pose | None:
            nonlocal failed
            pose = propose()
            failed = pose is None
            return pose

        self._propose = propose_once
        try:
            self._sample_and_place_robot(env)
        except rc.Error:
            if failed:
                return None
            raise
        finally:
            self._propose = None
        return rc.Pose(env.current_robot.robot_view.base.pose)
