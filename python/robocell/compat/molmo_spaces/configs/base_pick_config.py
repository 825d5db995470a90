"""The configuration of pick experiments."""

from __future__ import annotations

from robocell.compat.molmo_spaces.configs.abstract_exp_config import MlSpacesExpConfig
from robocell.compat.molmo_spaces.configs.camera_configs import (
    CameraSystemConfig,
    FrankaDroidCameraSystem,
)
from robocell.compat.molmo_spaces.configs.robot_configs import BaseRobotConfig, FrankaRobotConfig

__all__ = ["PickBaseConfig"]


class PickBaseConfig(MlSpacesExpConfig):
    """Picks in houses of procthor-10k, with 66 ms per action and at most 500 actions."""

    robot_config: BaseRobotConfig = FrankaRobotConfig()
    camera_config: CameraSystemConfig = FrankaDroidCameraSystem()
