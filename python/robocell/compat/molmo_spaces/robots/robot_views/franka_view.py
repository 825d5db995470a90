"""The view of a Franka FR3 with a Robotiq 2F-85, as `robots.franka` assembles them."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    GripperGroup,
    MJCFFrameMixin,
    MocapRobotBaseGroup,
    RobotView,
    SimplyActuatedMoveGroup,
)
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose

__all__ = ["FrankaArmGroup", "FrankaBaseGroup", "FrankaGripperGroup", "FrankaRobotView"]

FARTHEST = 0.1  # m, beyond which finger distances are not computed


class FrankaBaseGroup(MocapRobotBaseGroup):
    """The pedestal."""

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        """Takes the prefix of the names."""
        super().__init__(mj_data, mj_data.model.body(f"{namespace}base").id)


class FrankaArmGroup(MJCFFrameMixin, SimplyActuatedMoveGroup):
    """The seven joints; the leaf is the grasp site of the gripper."""

    def __init__(
        self, mj_data: mujoco.MjData, base_group: FrankaBaseGroup, namespace: str = ""
    ) -> None:
        """Takes the base and the prefix of the names."""
        model = mj_data.model
        names = [f"{namespace}fr3_joint{i + 1}" for i in range(7)]
        self._root_id = model.body(f"{namespace}fr3_link0").id
        self._leaf_id = model.site(f"{namespace}gripper/pinch").id
        super().__init__(
            mj_data,
            [model.joint(name).id for name in names],
            [model.actuator(name).id for name in names],
            self._root_id,
            base_group,
        )

    @property
    def leaf_frame_id(self) -> int:
        """Id of the grasp site."""
        return self._leaf_id

    @property
    def leaf_frame_type(self) -> str:  # type: ignore[override]
        """A site."""
        return "site"

    @property
    def root_frame_to_world(self) -> NDArray[np.float64]:
        """Pose (4, 4) of the arm's root body."""
        return body_pose(self.mj_data, self._root_id)


class FrankaGripperGroup(MJCFFrameMixin, GripperGroup):
    """The 2F-85: two driver joints and one actuator, which opens at 0 and closes at 255."""

    def __init__(
        self, mj_data: mujoco.MjData, base_group: FrankaBaseGroup, namespace: str = ""
    ) -> None:
        """Takes the base and the prefix of the names."""
        model = mj_data.model
        prefix = f"{namespace}gripper/"
        super().__init__(
            mj_data,
            [model.joint(f"{prefix}{side}_driver_joint").id for side in ("left", "right")],
            [model.actuator(f"{prefix}fingers_actuator").id],
            model.body(f"{prefix}base").id,
            base_group,
        )
        self._leaf_id = model.site(f"{prefix}pinch").id
        self._pads = [
            [
                each
                for each in range(model.ngeom)
                if model.geom_bodyid[each] == model.body(f"{prefix}{side}_pad").id
                and model.geom_contype[each] | model.geom_conaffinity[each]
            ]
            for side in ("left", "right")
        ]

    @property
    def leaf_frame_id(self) -> int:
        """Id of the grasp site."""
        return self._leaf_id

    @property
    def leaf_frame_type(self) -> str:  # type: ignore[override]
        """A site."""
        return "site"

    @property
    def root_frame_to_world(self) -> NDArray[np.float64]:
        """The pose of the grasp site."""
        return self.leaf_frame_to_world

    def set_gripper_ctrl_open(self, open: bool) -> None:
        """Opens or closes the gripper."""
        self.ctrl = [0 if open else 255]

    @property
    def inter_finger_dist_range(self) -> tuple[float, float]:
        """Distance of the pads, closed and open, m."""
        return 0.0, 0.085

    @property
    def inter_finger_dist(self) -> float:
        """Distance of the pads, m."""
        left, right = self._pads
        return max(
            0.0,
            min(
                mujoco.mj_geomDistance(self.mj_model, self.mj_data, one, other, FARTHEST, None)
                for one in left
                for other in right
            ),
        )


class FrankaRobotView(RobotView):
    """Base, arm and gripper."""

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        """Takes the prefix of the names."""
        base = FrankaBaseGroup(mj_data, namespace)
        groups = {
            "base": base,
            "arm": FrankaArmGroup(mj_data, base, namespace),
            "gripper": FrankaGripperGroup(mj_data, base, namespace),
        }
        super().__init__(mj_data, groups)

    @property
    def name(self) -> str:
        """Name of the kind of robot."""
        return "franka_droid"

    @property
    def base(self) -> FrankaBaseGroup:
        """The pedestal."""
        return self._move_groups["base"]
