"""Bodies of a model by name, whose poses can be read and written."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell._suggestions import did_you_mean
from robocell.compat.molmo_spaces._elements import name_of
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose
from robocell.compat.molmo_spaces.utils.pose import (
    pos_quat_to_pose_mat,
    pose_mat_to_pos_quat,
)

__all__ = ["MlSpacesBody", "create_mlspaces_body"]


class MlSpacesBody:
    """A body of a `mujoco.MjData`.

    Attributes:
        body_id: Id of the body.
        name: Name of the body.
    """

    def __init__(self, data: mujoco.MjData, body_id: int) -> None:
        """Takes the data and the id."""
        self._data = data
        self.body_id = int(body_id)
        self.name = name_of(data.model, "body", self.body_id)

    @property
    def pose(self) -> NDArray[np.float64]:
        """Pose (4, 4) in the world.

        Of a body with a free joint and of a mocap body it can be set, and is what was set, before
        and after `mujoco.mj_forward`. Setting that of any other body raises ArgumentError.
        """
        model, data = self._data.model, self._data
        mocap = model.body_mocapid[self.body_id]
        if mocap >= 0:
            return pos_quat_to_pose_mat(data.mocap_pos[mocap], data.mocap_quat[mocap])
        free = self._free_address()
        if free is not None:
            return pos_quat_to_pose_mat(data.qpos[free : free + 3], data.qpos[free + 3 : free + 7])
        return body_pose(data, self.body_id)

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        pos, quat = pose_mat_to_pos_quat(pose)
        mocap, free = self._data.model.body_mocapid[self.body_id], self._free_address()
        if mocap >= 0:
            self._data.mocap_pos[mocap], self._data.mocap_quat[mocap] = pos, quat
        elif free is not None:
            self._data.qpos[free : free + 7] = [*pos, *quat]
        else:
            raise rc.ArgumentError(
                f"body '{self.name}' cannot be moved: it has no free joint and is no mocap body"
            )

    @property
    def position(self) -> NDArray[np.float64]:
        """Position (3,) in the world, m."""
        return self.pose[:3, 3]

    @property
    def quat(self) -> NDArray[np.float64]:
        """Rotation in the world, as a quaternion wxyz (4,)."""
        return pose_mat_to_pos_quat(self.pose)[1]

    def _free_address(self) -> int | None:
        model = self._data.model
        joint = model.body_jntadr[self.body_id]
        if joint >= 0 and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            return int(model.jnt_qposadr[joint])
        return None


def create_mlspaces_body(data: mujoco.MjData, body_name: str | int) -> MlSpacesBody:
    """Returns a body by its name or id. Raises NotFoundError with the nearest name."""
    model = data.model
    if not isinstance(body_name, str):
        if not 0 <= int(body_name) < model.nbody:
            raise rc.NotFoundError(f"no body {body_name}: the model has 0 to {model.nbody - 1}")
        return MlSpacesBody(data, int(body_name))
    body_id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body_name)
    if body_id < 0:
        names = [name_of(model, "body", each) for each in range(1, model.nbody)]
        raise rc.NotFoundError(
            f"no body '{body_name}' in the model of {model.nbody} bodies."
            f"{did_you_mean(body_name, names)}"
        )
    return MlSpacesBody(data, body_id)
