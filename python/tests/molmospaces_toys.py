"""Small robots in the classes of MolmoSpaces: an arm of two joints, also on wheels, and rc7."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import robocell as rc
from robocell.compat.molmo_spaces.configs.robot_configs import BaseRobotConfig
from robocell.compat.molmo_spaces.controllers.joint_pos import JointPosController
from robocell.compat.molmo_spaces.env.sensors import TCPPoseSensor
from robocell.compat.molmo_spaces.kinematics.mujoco_kinematics import MlSpacesKinematics
from robocell.compat.molmo_spaces.kinematics.parallel.warp_kinematics import SimpleWarpKinematics
from robocell.compat.molmo_spaces.robots.abstract import Robot
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    FreeJointRobotBaseGroup,
    GripperGroup,
    HoloJointsRobotBaseGroup,
    MJCFFrameMixin,
    MocapRobotBaseGroup,
    RobotView,
    RobotViewFactory,
    SimplyActuatedMoveGroup,
)
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose

ARM = """
<body name="link0"><geom type="cylinder" size=".05 .02" mass="1"/>
  <body name="link1" pos="0 0 .1"><joint name="j1" axis="0 1 0" range="-2 2"/>
    <geom type="capsule" size=".02" fromto="0 0 0 .3 0 0" mass=".5"/>
    <body name="link2" pos=".3 0 0"><joint name="j2" axis="0 0 1" limited="false"/>
      <geom type="mesh" mesh="block" mass=".2"/>
      <body name="hand" pos=".2 0 0"><geom type="box" size=".02 .04 .02" mass=".1"/>
        <site name="tcp" pos=".05 0 0" euler="10 80 20"/>
        <body name="left" pos=".04 0 0"><joint name="f1" type="slide" axis="0 1 0" range="0 .03"/>
          <geom name="left" type="box" size=".02 .004 .01" pos="0 .004 0" mass=".02"/></body>
        <body name="right" pos=".04 0 0"><joint name="f2" type="slide" axis="0 -1 0" range="0 .03"/>
          <geom name="right" type="box" size=".02 .004 .01" pos="0 -.004 0" mass=".02"/></body>
      </body></body></body></body>"""
ASSETS = """
<compiler angle="radian"/>
<default><joint damping="1" armature=".01"/></default>
<asset><mesh name="block" vertex="0 0 0 .2 0 0 0 .02 0 0 0 .02"/></asset>"""
FOLLOWS = '<equality><joint joint1="f2" joint2="f1" polycoef="0 1 0 0 0"/></equality>'
SERVOS = """
<position name="a1" joint="j1" kp="100" ctrlrange="-2 2"/>
<position name="a2" joint="j2" kp="100" ctrlrange="-6 6"/>
<position name="grip" joint="f1" kp="100" ctrlrange="0 .03"/>"""
WHEELS = """
<body name="wheels"><joint name="x" type="slide" axis="1 0 0"/>
  <joint name="y" type="slide" axis="0 1 0"/><joint name="yaw" axis="0 0 1"/>
  <geom type="box" size=".1 .1 .02" mass="3"/><site name="base"/>{arm}</body>"""
DRIVES = """
<position name="dx" joint="x" kp="900"/><position name="dy" joint="y" kp="900"/>
<position name="dyaw" joint="yaw" kp="900"/>"""
BESIDE = """
<body name="drone" pos="0 3 1"><freejoint name="free"/><geom size=".1"/>
  <body name="ball" pos="0 0 .3"><joint name="ball" type="ball"/><geom size=".05"/></body></body>
<body name="mocap" pos="0 -3 0" mocap="true">
  <body name="carried" pos=".1 .2 .3" quat="0 1 0 0"><geom size=".1"/></body></body>"""


def _model(bodies: str, servos: str) -> str:
    return (
        f"<mujoco>{ASSETS}<worldbody><site name='origin'/>{bodies}</worldbody>"
        f"{FOLLOWS}<actuator>{servos}</actuator></mujoco>"
    )


HAND = ARM[ARM.index('<body name="hand"') : ARM.rindex("</body></body></body></body>")] + "</body>"
FLYING = _model(
    HAND.replace('pos=".2 0 0">', 'pos="0 0 1"><freejoint name="fly"/>', 1),
    '<position name="grip" joint="f1" kp="100" ctrlrange="0 .03"/>',
)
FIXED = _model(ARM, SERVOS)
MOBILE = _model(WHEELS.format(arm=ARM), DRIVES + SERVOS)
MODEL = _model(WHEELS.format(arm=ARM) + BESIDE, DRIVES + SERVOS)
_folder = tempfile.TemporaryDirectory()
for _name, _text in (("fixed.xml", FIXED), ("mobile.xml", MOBILE), ("flying.xml", FLYING)):
    Path(_folder.name, _name).write_text(_text)


class ArmGroup(MJCFFrameMixin, SimplyActuatedMoveGroup):
    def __init__(self, mj_data: mujoco.MjData, base: Any, namespace: str) -> None:
        model = mj_data.model
        self._root = model.body(f"{namespace}link0").id
        self._tcp = model.site(f"{namespace}tcp").id
        joints = [model.joint(f"{namespace}j{i}").id for i in (1, 2)]
        actuators = [model.actuator(f"{namespace}a{i}").id for i in (1, 2)]
        super().__init__(mj_data, joints, actuators, self._root, base)

    leaf_frame_id = property(lambda self: self._tcp)
    leaf_frame_type = property(lambda self: "site")
    root_frame_to_world = property(lambda self: body_pose(self.mj_data, self._root))


class HandGroup(MJCFFrameMixin, GripperGroup):
    def __init__(self, mj_data: mujoco.MjData, base: Any, namespace: str) -> None:
        model = mj_data.model
        self._tcp = model.site(f"{namespace}tcp").id
        self._fingers = [model.geom(f"{namespace}{side}").id for side in ("left", "right")]
        joints = [model.joint(f"{namespace}f{i}").id for i in (1, 2)]
        actuators = [model.actuator(f"{namespace}grip").id]
        super().__init__(mj_data, joints, actuators, model.body(f"{namespace}hand").id, base)

    leaf_frame_id = property(lambda self: self._tcp)
    leaf_frame_type = property(lambda self: "site")
    root_frame_to_world = property(lambda self: self.leaf_frame_to_world)
    inter_finger_dist_range = property(lambda self: (0.0, 0.06))
    # As pads that wear: a view may compute distances as it likes.
    inter_finger_dist = property(lambda self: float(np.sum(self.joint_pos)))

    def set_gripper_ctrl_open(self, open: bool) -> None:
        self.ctrl = [0.02 if open else 0.0]


class ToyView(RobotView):
    name = "toy"

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        base = MocapRobotBaseGroup(mj_data, mj_data.model.body(f"{namespace}base").id)
        groups = {
            "base": base,
            "arm": ArmGroup(mj_data, base, namespace),
            "gripper": HandGroup(mj_data, base, namespace),
        }
        super().__init__(mj_data, groups)

    base = property(lambda self: self._move_groups["base"])


class MobileView(RobotView):
    name = "toy on wheels"

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        model = mj_data.model
        base = HoloJointsRobotBaseGroup(
            mj_data,
            0,
            model.site(f"{namespace}base").id,
            [model.joint(f"{namespace}{name}").id for name in ("x", "y", "yaw")],
            [model.actuator(f"{namespace}d{name}").id for name in ("x", "y", "yaw")],
            model.body(f"{namespace}wheels").id,
        )
        groups = {
            "base": base,
            "arm": ArmGroup(mj_data, base, namespace),
            "gripper": HandGroup(mj_data, base, namespace),
        }
        super().__init__(mj_data, groups)

    base = property(lambda self: self._move_groups["base"])


class FlyingView(RobotView):
    name = "flying hand"

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        free = mj_data.model.joint(f"{namespace}fly").id
        base = FreeJointRobotBaseGroup(mj_data, free, [], [], floating=True)
        super().__init__(mj_data, {"base": base, "gripper": HandGroup(mj_data, base, namespace)})

    base = property(lambda self: self._move_groups["base"])


class ToyRobot(Robot):
    def __init__(self, mj_data: mujoco.MjData, exp_config: Any) -> None:
        super().__init__(mj_data, exp_config)
        config = exp_config.robot_config
        self._view = config.robot_view_factory(mj_data, config.robot_namespace)
        self._controllers = {
            name: JointPosController(self._view.get_move_group(name)) for name in ("arm", "gripper")
        }

    namespace = property(lambda self: self.exp_config.robot_config.robot_namespace)
    robot_view = property(lambda self: self._view)
    kinematics = property(lambda self: MlSpacesKinematics(self.exp_config.robot_config))
    parallel_kinematics = property(lambda self: SimpleWarpKinematics(self.exp_config.robot_config))
    controllers = property(lambda self: self._controllers)

    def get_arm_move_group_ids(self) -> list[str]:
        return ["arm"]

    def reset(self) -> None:
        self._view.set_qpos_dict(self.exp_config.robot_config.init_qpos)

    @staticmethod
    def robot_model_root_name() -> str:
        return "link0"

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
        at = [*pos, 0.0] if len(pos) == 2 else pos
        base = spec.worldbody.add_body(name=f"{prefix}base", pos=at, quat=quat, mocap=True)
        own = cls._load_robot_spec(robot_config, strip_meshes)
        base.add_frame(pos=[0, 0, 0.1]).attach_body(own.body("link0"), prefix, "")


class ToyConfig(BaseRobotConfig):
    robot_cls: type[Robot] | None = ToyRobot
    robot_factory: Callable[[mujoco.MjData, Any], Robot] | None = ToyRobot
    robot_view_factory: RobotViewFactory | None = ToyView
    name: str = "toy"
    robot_dir: Path | None = Path(_folder.name)
    robot_xml_path: Path = Path("fixed.xml")
    init_qpos: dict[str, list[float]] = {"base": [], "arm": [0.3, 0.4], "gripper": [0.01, 0.01]}


class Rc7Arm(MJCFFrameMixin, SimplyActuatedMoveGroup):
    def __init__(self, mj_data: mujoco.MjData, base: Any, namespace: str) -> None:
        model = mj_data.model
        self._root = model.body(f"{namespace}base_link").id
        self._tcp = model.site(f"{namespace}tcp").id
        joints = [model.joint(f"{namespace}joint{i + 1}").id for i in range(7)]
        actuators = [model.actuator(f"{namespace}servo{i + 1}").id for i in range(7)]
        super().__init__(mj_data, joints, actuators, self._root, base)

    leaf_frame_id = property(lambda self: self._tcp)
    leaf_frame_type = property(lambda self: "site")
    root_frame_to_world = property(lambda self: body_pose(self.mj_data, self._root))


class Rc7Gripper(MJCFFrameMixin, GripperGroup):
    def __init__(self, mj_data: mujoco.MjData, base: Any, namespace: str) -> None:
        model = mj_data.model
        self._tcp = model.site(f"{namespace}tcp").id
        self._pads = [model.geom(f"{namespace}{side}_finger_pad").id for side in ("left", "right")]
        joints = [model.joint(f"{namespace}{side}_finger_joint").id for side in ("left", "right")]
        actuators = [model.actuator(f"{namespace}gripper").id]
        super().__init__(mj_data, joints, actuators, model.body(f"{namespace}hand").id, base)

    leaf_frame_id = property(lambda self: self._tcp)
    leaf_frame_type = property(lambda self: "site")
    root_frame_to_world = property(lambda self: self.leaf_frame_to_world)
    inter_finger_dist_range = property(lambda self: (0.002, 0.09))

    @property
    def inter_finger_dist(self) -> float:
        one, other = self._pads
        return max(0.0, mujoco.mj_geomDistance(self.mj_model, self.mj_data, one, other, 0.1, None))

    def set_gripper_ctrl_open(self, open: bool) -> None:
        self.ctrl = [100 if open else 0]


class Rc7View(RobotView):
    name = "rc7"

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        base = MocapRobotBaseGroup(mj_data, mj_data.model.body(f"{namespace}base").id)
        groups = {
            "base": base,
            "arm": Rc7Arm(mj_data, base, namespace),
            "gripper": Rc7Gripper(mj_data, base, namespace),
        }
        super().__init__(mj_data, groups)

    base = property(lambda self: self._move_groups["base"])


class Rc7Robot(ToyRobot):
    """The built-in arm on a pedestal of 0.25 m."""

    def create_robot_sensors(self) -> list[Any]:
        return [TCPPoseSensor("tcp_pose")]

    @staticmethod
    def robot_model_root_name() -> str:
        return "base_link"

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
        at = [*pos, 0.0] if len(pos) == 2 else pos
        base = spec.worldbody.add_body(name=f"{prefix}base", pos=at, quat=quat, mocap=True)
        base.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.11, 0.11, 0.125], pos=[0, 0, 0.125])
        own = cls._load_robot_spec(robot_config, strip_meshes)
        base.add_frame(pos=[0, 0, 0.25]).attach_body(own.body("base_link"), prefix, "")


class Rc7Config(BaseRobotConfig):
    robot_cls: type[Robot] | None = Rc7Robot
    robot_factory: Callable[[mujoco.MjData, Any], Robot] | None = Rc7Robot
    robot_view_factory: RobotViewFactory | None = Rc7View
    name: str = "rc7"
    robot_dir: Path | None = Path(rc.models.robot_file("rc7")).parent
    robot_xml_path: Path = Path("rc7.xml")
    init_qpos: dict[str, list[float]] = {
        "base": [],
        "arm": [0, -0.15, 0, 1.9, 0, 1.39159, 0],
        "gripper": [0.044, 0.044],
    }
    gravcomp: bool = True


class TwoArms(ToyRobot):
    """Two of the toys in one robot."""

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
        base = spec.worldbody.add_body(name=f"{prefix}base", pos=pos, quat=quat, mocap=True)
        for side, y in (("left/", 0.2), ("right/", -0.2)):
            own = cls._load_robot_spec(robot_config, strip_meshes)
            frame = base.add_frame(pos=[0, y, 0.1])
            frame.attach_body(own.body("link0"), prefix + side, "")

    @staticmethod
    def robot_model_root_name() -> str:
        return "base"


class TwoArmsView(RobotView):
    name = "two toys"

    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        base = MocapRobotBaseGroup(mj_data, mj_data.model.body(f"{namespace}base").id)
        groups: dict[str, Any] = {"base": base}
        for side in ("left", "right"):
            groups[f"{side}_arm"] = ArmGroup(mj_data, base, f"{namespace}{side}/")
            groups[f"{side}_gripper"] = HandGroup(mj_data, base, f"{namespace}{side}/")
        super().__init__(mj_data, groups)

    base = property(lambda self: self._move_groups["base"])
