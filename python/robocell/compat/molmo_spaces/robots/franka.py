"""A Franka FR3 with a Robotiq 2F-85 on a pedestal, made of two models of the Menagerie."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco

import robocell as rc
from robocell.compat.molmo_spaces._assembly import load_spec, without_meshes
from robocell.compat.molmo_spaces.controllers.abstract import Controller
from robocell.compat.molmo_spaces.controllers.joint_pos import JointPosController
from robocell.compat.molmo_spaces.controllers.joint_rel_pos import JointRelPosController
from robocell.compat.molmo_spaces.env.abstract_sensors import Sensor
from robocell.compat.molmo_spaces.env.sensors import TCPPoseSensor
from robocell.compat.molmo_spaces.kinematics.mujoco_kinematics import MlSpacesKinematics
from robocell.compat.molmo_spaces.kinematics.parallel.warp_kinematics import SimpleWarpKinematics
from robocell.compat.molmo_spaces.robots.abstract import Robot
from robocell.compat.molmo_spaces.robots.robot_views.abstract import RobotView

__all__ = ["FrankaRobot"]


class FrankaRobot(Robot):
    """An arm that is commanded by joint positions, or by changes of them."""

    def __init__(self, mj_data: mujoco.MjData, exp_config: Any) -> None:
        """Takes the data that the robot is in, and the experiment."""
        super().__init__(mj_data, exp_config)
        config = exp_config.robot_config
        _, factory = config.require_classes()
        self._robot_view = factory(mj_data, config.robot_namespace)
        self._kinematics = MlSpacesKinematics(config)
        self._parallel_kinematics = SimpleWarpKinematics(config)
        relative = config.command_mode.get("arm") == "joint_rel_position"
        arm = JointRelPosController if relative else JointPosController
        self._controllers: dict[str, Controller] = {
            "arm": arm(self._robot_view.get_move_group("arm")),
            "gripper": JointPosController(self._robot_view.get_move_group("gripper")),
        }

    @property
    def namespace(self) -> str:
        """Prefix of the robot's names in the model."""
        return self.exp_config.robot_config.robot_namespace

    @property
    def robot_view(self) -> RobotView:
        """Base, arm and gripper."""
        return self._robot_view

    @property
    def kinematics(self) -> MlSpacesKinematics:
        """Kinematics of single poses."""
        return self._kinematics

    @property
    def parallel_kinematics(self) -> SimpleWarpKinematics:
        """Kinematics of many poses."""
        return self._parallel_kinematics

    @property
    def controllers(self) -> dict[str, Controller]:
        """Controllers of arm and gripper."""
        return self._controllers

    def create_robot_sensors(self) -> list[Sensor]:
        """Returns a sensor of the TCP."""
        return [*super().create_robot_sensors(), TCPPoseSensor(uuid="tcp_pose")]

    def get_arm_move_group_ids(self) -> list[str]:
        """Returns the arm."""
        return ["arm"]

    def reset(self) -> None:
        """Puts the groups at `init_qpos`."""
        self._robot_view.set_qpos_dict(self.exp_config.robot_config.init_qpos)

    @staticmethod
    def robot_model_root_name() -> str:
        """Root body of the FR3."""
        return "fr3_link0"

    @classmethod
    def add_robot_to_scene(
        cls,
        robot_config: Any,
        spec: mujoco.MjSpec,
        prefix: str,
        pos: list[float],
        quat: list[float],
        randomize_textures: bool = False,
        strip_meshes: bool = False,
    ) -> None:
        """Adds a mocap body with the pedestal, and the arm on it."""
        del randomize_textures
        at = [*pos, 0.0] if len(pos) == 2 else pos
        base = spec.worldbody.add_body(name=f"{prefix}base", pos=at, quat=quat, mocap=True)
        height = 0.0
        if robot_config.base_size is not None:
            height = robot_config.base_size[2]
            base.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=[length / 2 for length in robot_config.base_size],
                pos=[0, 0, height / 2],
                rgba=[0.4, 0.4, 0.4, 1],
            )
        robot_spec = cls._load_robot_spec(robot_config, strip_meshes=strip_meshes)
        base.add_frame(pos=[0, 0, height]).attach_body(cls._root_of(robot_spec), prefix, "")

    @classmethod
    def _load_robot_spec(cls, robot_config: Any, strip_meshes: bool = False) -> mujoco.MjSpec:
        """Reads the arm and puts the gripper on its flange."""
        arm = super()._load_robot_spec(robot_config, strip_meshes)
        folder = Path(rc.menagerie.folder("robotiq_2f85"))
        hand = load_spec(folder / "2f85.xml")
        if strip_meshes:
            hand = without_meshes(hand)
        site = arm.site("attachment_site")
        mount = site.parent.add_frame(pos=site.pos, quat=site.quat)
        mount.attach_body(hand.worldbody.first_body(), "gripper/", "")
        return arm
