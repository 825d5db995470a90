"""Configurations of robots: the model's file, the classes that read it, and where it begins."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco

import robocell as rc
from robocell.compat.molmo_spaces.configs.abstract_config import Config
from robocell.compat.molmo_spaces.robots.abstract import Robot
from robocell.compat.molmo_spaces.robots.franka import FrankaRobot
from robocell.compat.molmo_spaces.robots.robot_views.abstract import RobotViewFactory
from robocell.compat.molmo_spaces.robots.robot_views.franka_view import FrankaRobotView

__all__ = ["ActionNoiseConfig", "BaseRobotConfig", "FrankaRobotConfig"]


class ActionNoiseConfig(Config):
    """Noise on the commands of arms, in proportion to the motion of the TCP.

    Attributes:
        enabled: Add noise in `Robot.update_control`.
        action_scale_factor: Standard deviation of the position, per metre of the TCP's motion.
        rotation_noise_scale: Standard deviation of the rotation, rad per m of that of the position.
        max_tcp_position_noise: Largest noise along each axis, m.
        max_tcp_rotation_noise: Largest noise about each axis, rad.
    """

    enabled: bool = True
    action_scale_factor: float = 0.1
    rotation_noise_scale: float = 0.1
    max_tcp_position_noise: float = 0.02
    max_tcp_rotation_noise: float = 0.1


class BaseRobotConfig(Config):
    """A robot: its model and the classes that read it.

    Attributes:
        robot_cls: The class of the robot, whose `add_robot_to_scene` puts it into models.
        robot_factory: Makes the robot from data and experiment; a class is one.
        robot_view_factory: Makes the view of the robot from data and namespace; a class is one.
        robot_namespace: Prefix of the robot's names in scenes.
        name: Name of the kind of robot.
        robot_xml_path: The MJCF file, in `robot_dir`.
        robot_dir: Folder of the model. None: a folder of the Menagerie with the name of the robot.
        init_qpos: Joint positions of each group at the beginning, rad or m.
        init_qpos_noise_range: Largest change of these, either way. None: none.
        command_mode: "joint_position" or "joint_rel_position" for each group.
        gravcomp: Compensate gravity on every body of the robot.
        K_stiffness: Position gains of the first actuators. None: those of the model.
        K_damping: Velocity gains of the first actuators. None: those of the model.
        force_limit: Force limits of the first actuators, N or Nm. None: those of the model.
        action_noise_config: Noise on the commands of arms.
    """

    robot_cls: type[Robot] | None = None
    robot_factory: Callable[[mujoco.MjData, Any], Robot] | None = None
    robot_view_factory: RobotViewFactory | None = None
    robot_namespace: str = "robot_0/"
    name: str = "robot"
    robot_xml_path: Path = Path("robot.xml")
    robot_dir: Path | None = None
    init_qpos: dict[str, list[float]] = {}
    init_qpos_noise_range: dict[str, list[float]] | None = None
    command_mode: dict[str, str | None] = {}
    gravcomp: bool = False
    K_stiffness: list[float] | None = None
    K_damping: list[float] | None = None
    force_limit: list[float] | None = None
    action_noise_config: ActionNoiseConfig = ActionNoiseConfig()

    def get_robot_dir(self) -> Path:
        """Returns the folder of the model. Raises NotFoundError where there is none."""
        if self.robot_dir is None:
            return Path(rc.menagerie.folder(self.name))
        if not self.robot_dir.is_dir():
            raise rc.NotFoundError(
                f"{type(self).__name__}.robot_dir: there is no folder '{self.robot_dir}' (looked "
                f"from '{Path.cwd()}'). Put the model's files there, or start the command in the "
                "folder that the path is relative to"
            )
        return self.robot_dir

    def get_robot_xml_path(self) -> Path:
        """Returns the path of the model. Raises NotFoundError with the models beside it."""
        path = self.get_robot_dir() / self.robot_xml_path
        if not path.is_file():
            there = ", ".join(sorted(each.name for each in path.parent.glob("*.xml"))) or "none"
            raise rc.NotFoundError(
                f"{type(self).__name__}.robot_xml_path: there is no file '{path}'. Models in its "
                f"folder: {there}"
            )
        return path

    def require_classes(self) -> tuple[type[Robot], RobotViewFactory]:
        """Returns robot_cls and robot_view_factory. Raises ArgumentError if one is None."""
        for field in ("robot_cls", "robot_view_factory"):
            if getattr(self, field) is None:
                raise rc.ArgumentError(
                    f"{type(self).__name__}.{field} is not set: name your subclass of "
                    f"{'Robot' if field == 'robot_cls' else 'RobotView'} there"
                )
        assert self.robot_cls is not None
        assert self.robot_view_factory is not None
        return self.robot_cls, self.robot_view_factory


class FrankaRobotConfig(BaseRobotConfig):
    """A Franka FR3 with a Robotiq 2F-85 on a pedestal, of the models of the Menagerie.

    Attributes:
        base_size: Length, width and height of the pedestal, m. None: no pedestal.
    """

    robot_cls: type[Robot] | None = FrankaRobot
    robot_factory: Callable[[mujoco.MjData, Any], Robot] | None = FrankaRobot
    robot_view_factory: RobotViewFactory | None = FrankaRobotView
    name: str = "franka_droid"
    robot_xml_path: Path = Path("fr3.xml")
    base_size: list[float] | None = [0.5, 0.5, 0.58]
    init_qpos: dict[str, list[float]] = {
        "base": [],
        "arm": [0, -0.7853, 0, -2.35619, 0, 1.57079, 0],
        "gripper": [0.00296, 0.00296],
    }
    init_qpos_noise_range: dict[str, list[float]] | None = {
        "arm": [0.025, 0.05, 0.075, 0.1, 0.125, 0.15, 0.175]
    }
    command_mode: dict[str, str | None] = {"arm": "joint_position", "gripper": "joint_position"}
    gravcomp: bool = True

    def get_robot_dir(self) -> Path:
        """Returns the folder of the FR3 in the Menagerie, unless `robot_dir` is another one."""
        if self.robot_dir is None:
            return Path(rc.menagerie.folder("franka_fr3"))
        return super().get_robot_dir()
