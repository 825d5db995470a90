"""Simulates an arm's motion with other values of its model."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import mujoco
import mujoco.rollout
import numpy as np

from robocell._core import ArgumentError, Robot
from robocell._identify.trajectory import ArmTrajectory, Numbers

KINDS = ("damping", "frictionloss", "armature", "gain")
FAR_S = 1.0  # beyond the times of a motion: longer than delays and steps
UNITS = {
    "damping": "N m s/rad or N s/m",
    "frictionloss": "N m or N",
    "armature": "kg m^2 or kg",
    "gain": "N m/rad or N/m",
    "delay": "s",
}


class ArmRollouts:
    """An arm alone: its model with other values, and the positions that it then has.

    Values are (4, joints), one row for each of `KINDS`, and the delay of the commands.
    """

    def __init__(self, robot: Robot, trajectory: ArmTrajectory) -> None:
        self.joints = [name.removeprefix(robot.prefix) for name in robot.joint_names]
        if trajectory.measured.shape[1] != len(self.joints):
            raise ArgumentError(
                f"the trajectory has {trajectory.measured.shape[1]} joints; the arm of robot "
                f"'{robot.name}' has {len(self.joints)}: {', '.join(self.joints)}"
            )
        scene = robot.scene
        self._model: Any = scene.model
        self._trajectory = trajectory
        model = self._model
        self._dofs = np.array([model.joint(name).dofadr[0] for name in robot.joint_names])
        self._qpos = np.array([model.joint(name).qposadr[0] for name in robot.joint_names])
        self._actuators = np.array(
            [model.actuator(name).id for name in robot.arm.actuator_names], dtype=int
        )
        is_servo = [
            model.actuator_trntype[a] == mujoco.mjtTrn.mjTRN_JOINT
            and model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_AFFINE
            and model.actuator_gainprm[a, 0] > 0
            and np.isclose(model.actuator_biasprm[a, 1], -model.actuator_gainprm[a, 0])
            for a in self._actuators
        ]
        if len(is_servo) != len(self.joints) or not all(is_servo):
            raise ArgumentError(
                f"robot '{robot.name}': identification needs a position servo on each joint of the "
                "arm"
            )
        self._data: Any = mujoco.MjData(model)
        self._start(scene, robot)
        self._steps = max(2, round(trajectory.time[-1] / model.opt.timestep) + 1)
        self._times = np.arange(self._steps) * model.opt.timestep
        self._gears = model.actuator_gear[self._actuators, 0]

    def _start(self, scene: Any, robot: Robot) -> None:
        """Takes over the state of the scene, with the arm at the first measured positions."""
        data, model, of_scene = self._data, self._model, scene.data
        spec = mujoco.mjtState.mjSTATE_INTEGRATION
        state = np.empty(mujoco.mj_stateSize(model, spec))
        mujoco.mj_getState(model, of_scene, state, spec)
        mujoco.mj_setState(model, data, state, spec)
        data.qpos[self._qpos] = self._trajectory.measured[0]
        data.qvel[:] = 0
        data.qacc_warmstart[:] = 0
        mujoco.mj_forward(model, data)
        full = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self._state = np.empty(mujoco.mj_stateSize(model, full))
        mujoco.mj_getState(model, data, self._state, full)
        self._ctrl = np.array(data.ctrl)

    def values(self) -> Numbers:
        """Returns the values of the model."""
        m = self._model
        return np.stack(
            [
                m.dof_damping[self._dofs].reshape(len(self._dofs), -1)[:, 0],
                m.dof_frictionloss[self._dofs],
                m.dof_armature[self._dofs],
                m.actuator_gainprm[self._actuators, 0],
            ]
        ).astype(float)

    def scales(self) -> Numbers:
        """Returns values that are usual for such joints, to begin with and to scale by."""
        m, data = self._model, self._data
        full = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, data, full)
        inertia = np.maximum(np.diag(full)[self._dofs], 1e-6)
        gain = np.maximum(m.actuator_gainprm[self._actuators, 0], 1e-3)
        own = self.values()
        return np.stack(
            [
                np.maximum(own[0], 0.1 * np.sqrt(gain * inertia)),
                np.maximum(own[1], 0.002 * gain),
                np.maximum(own[2], 0.1 * inertia),
                gain,
            ]
        )

    def positions(
        self, values: Sequence[Numbers], delays: Sequence[float], starts: Sequence[Numbers]
    ) -> Numbers:
        """Returns the positions (sets, n, joints) at the trajectory's times, for sets of values.

        `starts` are (2, joints): what is added to the first measured positions and to velocities of
        zero.
        """
        models = [self._with(each) for each in values]
        ctrl = np.stack([self._control(delay) for delay in delays])
        first = 1 + self._qpos
        begin = np.tile(self._state, (len(models), 1))
        begin[:, first] += [start[0] for start in starts]
        begin[:, 1 + self._model.nq + self._dofs] += [start[1] for start in starts]
        states, _ = mujoco.rollout.rollout(models, [self._data], begin, ctrl)
        # A state is that after its control.
        qpos = np.concatenate([begin[:, None, first], states[:, :, first]], axis=1)
        times = np.arange(self._steps + 1) * self._model.opt.timestep
        at = self._trajectory.time
        low = np.clip(np.searchsorted(times, at, side="right") - 1, 0, self._steps - 1)
        share = ((at - times[low]) / self._model.opt.timestep)[:, None]
        return np.asarray(qpos[:, low] * (1 - share) + qpos[:, low + 1] * share)

    def _with(self, values: Numbers) -> Any:
        model: Any = copy.copy(self._model)
        gain_before = self._model.actuator_gainprm[self._actuators, 0]
        damping = model.dof_damping
        if damping.ndim == 2:
            damping[self._dofs, 0] = values[0]
        else:
            damping[self._dofs] = values[0]
        model.dof_frictionloss[self._dofs] = values[1]
        model.dof_armature[self._dofs] = values[2]
        scale = values[3] / gain_before
        model.actuator_gainprm[self._actuators, 0] = values[3]
        model.actuator_biasprm[self._actuators, 0] *= scale
        model.actuator_biasprm[self._actuators, 1] *= scale
        mujoco.mj_setConst(model, mujoco.MjData(model))
        return model

    def _control(self, delay: float) -> Numbers:
        """Returns the controls of all steps with the commands delayed."""
        time, command = self._trajectory.time, self._trajectory.command
        ctrl = np.tile(self._ctrl, (self._steps, 1))
        for joint, actuator in enumerate(self._actuators):
            if self._trajectory.holds:
                late = self._held(command[:, joint], delay)
            else:
                late = np.interp(self._times - delay, time, command[:, joint])
            ctrl[:, actuator] = late * self._gears[joint]
        return ctrl

    def _held(self, command: Numbers, delay: float) -> Numbers:
        """Returns the mean of held commands over each step, which is smooth in the delay."""
        time, timestep = self._trajectory.time, self._model.opt.timestep
        knots = np.concatenate([[-FAR_S], time, [time[-1] + FAR_S]])
        integral = np.zeros(len(knots))
        integral[1:] = np.cumsum(np.concatenate([command[:1], command]) * np.diff(knots))
        edges = np.arange(self._steps + 1) * timestep - delay
        return np.asarray(np.diff(np.interp(edges, knots, integral)) / timestep)
