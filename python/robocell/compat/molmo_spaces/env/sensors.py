"""Sensors of robots."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell.compat.molmo_spaces.env.abstract_sensors import Sensor
from robocell.compat.molmo_spaces.utils.pose import pose_mat_to_7d

__all__ = ["TCPPoseSensor"]


class TCPPoseSensor(Sensor):
    """The TCP of the robot's first gripper in the frame of its base: xyz and wxyz (7,)."""

    unit = "m, 1"

    def __init__(self, uuid: str = "tcp_pose") -> None:
        """Takes the name."""
        super().__init__(uuid)

    def get_observation(
        self, env: Any, task: Any = None, batch_index: int = 0
    ) -> NDArray[np.float64]:
        """Returns position and quaternion (7,) now, as float32."""
        del task
        view = env.robots[batch_index].robot_view
        grippers = view.get_gripper_movegroup_ids()
        if not grippers:
            raise rc.NotFoundError(
                f"sensor '{self.uuid}': robot view '{view.name}' has no GripperGroup, whose leaf "
                f"frame is the TCP. Its move groups: {', '.join(view.move_group_ids())}"
            )
        return pose_mat_to_7d(view.get_gripper(grippers[0]).leaf_frame_to_robot).astype(np.float32)
