"""The environment that samplers and sensors see: a model, its data and the robot in it."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

import robocell as rc
from robocell.compat.molmo_spaces.robots.abstract import Robot

__all__ = ["CPUMujocoEnv"]


class CPUMujocoEnv:
    """A robot in a `mujoco.MjModel`.

    Attributes:
        config: The experiment.
        mj_model: The model.
        mj_datas: The data, one.
        robots: The robot, one; its class is `robot_config.robot_factory`.
    """

    def __init__(
        self, exp_config: Any, mj_model: mujoco.MjModel, mj_data: mujoco.MjData | None = None
    ) -> None:
        """Makes the robot in new data, or in data that it is given, such as `scene.data`."""
        factory = exp_config.robot_config.robot_factory
        if factory is None:
            raise rc.ArgumentError(
                f"{type(exp_config.robot_config).__name__}.robot_factory is not set: name your "
                "subclass of Robot there"
            )
        self.config = exp_config
        self.mj_model = mj_model
        data = mujoco.MjData(mj_model) if mj_data is None else mj_data
        self.mj_datas = [data]
        self.robots: list[Robot] = [factory(data, exp_config)]
        if mj_data is None:
            self.reset()

    @property
    def current_model(self) -> mujoco.MjModel:
        """The model."""
        return self.mj_model

    @property
    def current_data(self) -> mujoco.MjData:
        """The data."""
        return self.mj_datas[0]

    @property
    def current_robot(self) -> Robot:
        """The robot."""
        return self.robots[0]

    @property
    def n_batch(self) -> int:
        """Number of data: 1."""
        return 1

    def reset(self) -> None:
        """Resets the data, and puts the robot where it begins."""
        mujoco.mj_resetData(self.mj_model, self.current_data)
        mujoco.mj_forward(self.mj_model, self.current_data)
        self.current_robot.reset()
        mujoco.mj_forward(self.mj_model, self.current_data)
        for controller in self.current_robot.controllers.values():
            controller.reset()

    def step(self, n_steps: int = 1) -> None:
        """Computes the robot's controls once and makes this many steps of the engine.

        Raises DivergedError, with the time, if positions are no longer finite.
        """
        self.current_robot.compute_control()
        mujoco.mj_step(self.mj_model, self.current_data, n_steps)
        if not np.all(np.isfinite(self.current_data.qpos)):
            raise rc.DivergedError(f"the simulation diverged at {self.current_data.time:g} s")
