"""Values of RCS's configurations that have the wrong type or are not possible, field by field."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

import robocell as rc
from robocell.compat.rcs.envs.base import ControlMode
from robocell.compat.rcs.envs.scenes import (
    CameraAdderConfig,
    SimEnvCreator,
    SimEnvCreatorConfig,
)
from robocell.compat.rcs.envs.tasks import BaseTaskConfig, PickPlaceTaskConfig, PickTaskConfig
from robocell.compat.rcs.sim import (
    CameraType,
    SimCameraConfig,
    SimConfig,
    SimGripperConfig,
    SimRobotConfig,
)

POSE = (3, "expected a Pose, found 3 (int)")
TEXT = (3, "expected a text, found 3 (int)")
NUMBER = ("fast", "expected a number, found 'fast'")
WHOLE = ("500", "expected a whole number, found '500'")
TRUTH = ("no", "expected True or False, found 'no'")
PATH = (None, "expected a path or a model's name, found None")
TEXTS = ("yaw", "expected a list of texts, found 'yaw'; of one it is ['yaw']")
GEOMS = ("g", "expected a list of geoms' names, found 'g'")


def mapping_to(objects: str) -> tuple[object, str]:
    return (["a"], f"expected a dictionary from names to {objects}, found ['a'] (list)")


# Class -> field -> a value of a wrong type, and what is said after the field's place.
WRONG = {
    SimConfig: {
        "async_control": TRUTH,
        "realtime": TRUTH,
        "frequency": NUMBER,
        "max_convergence_steps": WHOLE,
    },
    SimRobotConfig: {
        "robot_type": TEXT,
        "kinematic_model_path": PATH,
        "attachment_site": TEXT,
        "tcp_offset": POSE,
        "joints": TEXTS,
        "actuators": TEXTS,
        "base": TEXT,
        "dof": ("5", "expected a whole number, found '5'"),
        "joint_limits": (
            "wide",
            "expected (lower, upper), two lists with a number for each joint, found 'wide'",
        ),
        "q_home": ("home", "expected a list of numbers, found 'home'"),
        "joint_rotational_tolerance": NUMBER,
        "arm_collision_geoms": GEOMS,
        "seconds_between_callbacks": NUMBER,
    },
    SimGripperConfig: {
        "gripper_type": PATH,
        "joints": TEXTS,
        "actuator": (["a"], "expected a text, found ['a'] (list)"),
        "min_actuator_width": NUMBER,
        "max_actuator_width": NUMBER,
        "min_joint_width": NUMBER,
        "max_joint_width": NUMBER,
        "collision_geoms": GEOMS,
        "collision_geoms_fingers": GEOMS,
        "ignored_collision_geoms": TEXTS,
        "seconds_between_callbacks": NUMBER,
    },
    SimCameraConfig: {
        "identifier": TEXT,
        "frame_rate": NUMBER,
        "resolution_width": WHOLE,
        "resolution_height": WHOLE,
        "type": (3, "expected a CameraType (free, tracking, fixed, default_free), found 3 (int)"),
    },
    PickPlaceTaskConfig: {
        "task_id": TEXT,
        "robot_name": TEXT,
        "object_center_to_root_frame": ([0, 0, 0], "expected a Pose, found [0, 0, 0] (list)"),
        "object_xml": PATH,
        "object_joint": TEXT,
        "prefix": TEXT,
        "include_rotation": TRUTH,
        "goal": ("there", "expected a list of numbers, found 'there'"),
        "goal_tolerance": NUMBER,
    },
    SimEnvCreatorConfig: {
        "robot_cfgs": (
            None,
            "expected a dictionary from names to SimRobotConfig objects, found None",
        ),
        "sim_cfg": ({"frequency": 3}, "expected a SimConfig, found {'frequency': 3} (dict)"),
        "control_mode": (
            3,
            "expected a ControlMode (JOINTS, CARTESIAN_TRPY, CARTESIAN_TQUAT), found 3 (int)",
        ),
        "task_cfg": ("pick", "expected a BaseTaskConfig, found 'pick'"),
        "scene": PATH,
        "gripper_cfgs": mapping_to("SimGripperConfig objects"),
        "camera_cfgs": mapping_to("SimCameraConfig objects"),
        "max_relative_movement": ("a", "expected a number or two numbers, found 'a'"),
        "relative_to": (
            0,
            "expected a RelativeTo (LAST_STEP, CONFIGURED_ORIGIN, NONE), found 0 (int)",
        ),
        "robot_to_shared_base_frame": mapping_to("Poses"),
        "add_gravcomp": TRUTH,
        "wrapper_cfg": (None, "expected a WrapperConfig, found None"),
        "headless": (1, "expected True or False, found 1 (int)"),
        "shared_base_frame_to_root_frame": POSE,
        "root_frame_to_world": POSE,
        "alternative_combined_robot_mjcf": (
            3,
            "expected a path or a model's name, found 3 (int)",
        ),
        "world_frame_objects": mapping_to("(model, Pose)"),
        "root_frame_objects": mapping_to("(model, Pose)"),
        "robot_frame_objects": mapping_to("values"),
        "camera_adds": mapping_to("CameraAdderConfig objects"),
        "gripper_offsets": mapping_to("Poses"),
    },
}
# Class -> where a configuration of the whole cell has one, and what a place in it is called.
PLACES = {
    SimConfig: "sim_cfg.",
    SimRobotConfig: "robot_cfgs.left.",
    SimGripperConfig: "gripper_cfgs.left.",
    SimCameraConfig: "camera_cfgs.eye.",
    PickPlaceTaskConfig: "task_cfg.",
    SimEnvCreatorConfig: "",
}


def cell(**more) -> SimEnvCreatorConfig:
    """One arm with all that it may have; no file is read before it is built."""
    return SimEnvCreatorConfig(
        **{
            "robot_cfgs": {"left": SimRobotConfig()},
            "sim_cfg": SimConfig(),
            "control_mode": ControlMode.CARTESIAN_TQuat,
            "gripper_cfgs": {"left": SimGripperConfig()},
            "camera_cfgs": {"eye": SimCameraConfig("eye")},
            "task_cfg": PickPlaceTaskConfig(robot_name="left"),
            **more,
        }
    )


def with_field(kind: type, name: str, value: object) -> SimEnvCreatorConfig:
    """The cell in which one field of one configuration has this value."""
    cfg = cell()
    if kind is SimEnvCreatorConfig:
        return replace(cfg, **{name: value})
    config = {
        SimConfig: cfg.sim_cfg,
        SimRobotConfig: cfg.robot_cfgs["left"],
        SimGripperConfig: cfg.gripper_cfgs["left"],
        SimCameraConfig: cfg.camera_cfgs["eye"],
        PickPlaceTaskConfig: cfg.task_cfg,
    }[kind]
    setattr(config, name, value)
    return cfg


def message(cfg: SimEnvCreatorConfig, kind: type[Exception]) -> str:
    with pytest.raises(kind) as error:
        cfg.to_env_config()
    assert type(error.value) is kind
    return str(error.value)


def test_every_field_has_a_wrong_type_case():
    for kind, wrong in WRONG.items():
        assert list(wrong) == [each.name for each in fields(kind) if each.name != "_original_cfg"]


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind in WRONG for name in WRONG[kind]])
def test_wrong_type_errors_use_the_documented_field_name(kind: type, name: str):
    value, told = WRONG[kind][name]
    place = f"{PLACES[kind]}{name}"
    assert message(with_field(kind, name, value), TypeError).startswith(f"{place}: {told}")


@pytest.mark.parametrize(
    ("config", "call", "told"),
    [
        (SimRobotConfig(joints="yaw"), "to_robot", "SimRobotConfig.joints: expected a list"),
        (SimGripperConfig(actuator=1), "to_robot", "SimGripperConfig.actuator: expected a text"),
        (SimConfig(frequency="a"), "to_settings", "SimConfig.frequency: expected a number"),
        (BaseTaskConfig(task_id=None), "as_read", "BaseTaskConfig.task_id: expected a text"),
    ],
)
def test_errors_of_a_single_configuration_name_its_class(config, call: str, told: str):
    with pytest.raises(TypeError, match=re.escape(told)):
        getattr(config, call)()


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (
            {"robot_cfgs": {"left": "FR3"}},
            "robot_cfgs.left: expected a SimRobotConfig, found 'FR3'",
        ),
        (
            {"robot_cfgs": {"left": SimRobotConfig}},
            "robot_cfgs.left: expected a SimRobotConfig, found <class 'robocell.compat.rcs.sim."
            "SimRobotConfig'>; make one of the class: SimRobotConfig(...)",
        ),
        ({"robot_cfgs": {3: SimRobotConfig()}}, "robot_cfgs: expected texts as its keys, found 3"),
        (
            {"robot_cfgs": {"left": SimRobotConfig(joints=["a", 3])}},
            "robot_cfgs.left.joints[1]: expected a text, found 3 (int)",
        ),
        (
            {"robot_cfgs": {"left": SimRobotConfig(joints={"a", "b"})}},
            "robot_cfgs.left.joints: expected a list of texts, found {'a', 'b'} (set)",
        ),
        (
            {"robot_cfgs": {"left": SimRobotConfig(q_home=[0, True])}},
            "robot_cfgs.left.q_home[1]: expected a number, found True",
        ),
        (
            {"robot_cfgs": {"left": SimRobotConfig(arm_collision_geoms=[3])}},
            "robot_cfgs.left.arm_collision_geoms[0]: expected a geom's name, or {'body': name, ",
        ),
        (
            {"world_frame_objects": {"cube": "green_cube"}},
            "world_frame_objects.cube: expected (model, Pose), or an rc.envs.EnvObject, found 'gr",
        ),
        (
            {"root_frame_objects": {"cube": ("green_cube", [0, 0, 0])}},
            "root_frame_objects.cube[1]: expected a Pose, found [0, 0, 0] (list); write Pose(tran",
        ),
        (
            {"robot_frame_objects": {"left": {"mount": (None, rc.Pose())}}},
            "robot_frame_objects.left.mount[0]: expected a path or a model's name, found None",
        ),
        ({"gripper_offsets": {"left": 3}}, "gripper_offsets.left: expected a Pose, found 3 (int)"),
        (
            {"camera_adds": {"eye": {"fov": 60}}},
            "camera_adds.eye: a CameraAdderConfig: no field 'fov'.",
        ),
        (
            {"max_relative_movement": [0.1, "wide"]},
            "max_relative_movement[1]: expected a number, found 'wide'",
        ),
        (
            {"max_relative_movement": "0.05"},
            "max_relative_movement: expected a number or two numbers, found '0.05'",
        ),
        (
            {"max_relative_movement": b"0.05"},
            "max_relative_movement: expected a number or two numbers, found b'0.05' (bytes)",
        ),
    ],
)
def test_a_wrong_type_error_names_the_place_within_the_field(more: dict, told: str):
    if "set" in told:
        told = told.partition("{")[0]  # in any order
    assert message(cell(**more), TypeError).startswith(told)


@pytest.mark.parametrize(
    ("kind", "name", "value", "told"),
    [
        (SimConfig, "frequency", 0, "expected a number above 0, found 0"),
        (SimConfig, "frequency", float("nan"), "expected a finite number, found nan"),
        (SimConfig, "max_convergence_steps", 0, "expected a whole number from 1 to 1000000, or -1"),
        (SimRobotConfig, "joint_rotational_tolerance", -1, "expected a number above 0, found -1"),
        (SimRobotConfig, "kinematic_model_path", "", "expected a path or a model's name, found an"),
        (SimRobotConfig, "q_home", [0, 1], "expected a number for each of its 7 joints (fr3_joint"),
        (SimRobotConfig, "dof", 6, "expected None or the number of its 7 joints (fr3_joint1, fr3"),
        (SimGripperConfig, "max_joint_width", 0, "expected another width than min_joint_width's"),
        (SimGripperConfig, "max_actuator_width", 0, "expected another width than min_actuator_wi"),
        (SimCameraConfig, "resolution_width", -3, "expected a whole number above 0, found -3"),
        (SimCameraConfig, "frame_rate", -3, "expected a number of at least 0, found -3"),
        (SimCameraConfig, "type", "trackin", "expected a CameraType (free, tracking, fixed, defa"),
        (PickPlaceTaskConfig, "goal", [0.5, 0], "expected three numbers, metres, found 2 numbers"),
        (PickPlaceTaskConfig, "goal_tolerance", 0, "expected a number above 0, found 0"),
        (SimEnvCreatorConfig, "control_mode", "jonts", "expected a ControlMode (JOINTS, CARTESIA"),
    ],
)
def test_invalid_value_errors_use_the_documented_field_name(
    kind: type, name: str, value: object, told: str
):
    text = message(with_field(kind, name, value), rc.ArgumentError)
    assert text.startswith(f"{PLACES[kind]}{name}: {told}")


class TestJointLimits:
    """They are (lower, upper), each with a number for every joint."""

    PLACE = "robot_cfgs.left.joint_limits"
    WORDS = "expected (lower, upper), two lists with a number for each joint"

    def message(self, limits: object, joints: int = 7) -> str:
        robot = SimRobotConfig(joint_limits=limits)
        robot.joints, robot.actuators = robot.joints[:joints], robot.actuators[:joints]
        robot.q_home = None
        return message(cell(robot_cfgs={"left": robot}), rc.ArgumentError)

    def test_suggests_the_transpose_of_joint_limits(self):
        assert self.message(np.zeros((7, 2))) == (
            f"{self.PLACE}: {self.WORDS}, found numbers of shape (7, 2); its transpose has that"
        )
        assert self.message([[-2, 2], [-1, 1]], 2) == (
            f"{self.PLACE}: expected (lower, upper): no lower limit above the upper one of joint "
            "'fr3_joint2', found 2 and 1; the transpose of joint_limits has that"
        )

    def test_rejects_limits_for_another_number_of_joints(self):
        assert self.message(np.zeros((2, 4))) == (
            f"{self.PLACE}: expected (lower, upper) for each of its 7 joints (fr3_joint1, "
            "fr3_joint2, fr3_joint3, fr3_joint4, fr3_joint5, fr3_joint6, fr3_joint7), found "
            "numbers of shape (2, 4)"
        )
        assert self.message([1, 2]) == f"{self.PLACE}: {self.WORDS}, found numbers of shape (2,)"

    def test_rejects_limits_that_are_not_finite(self):
        assert self.message([[0] * 7, [1] * 6 + [np.inf]]) == (
            f"{self.PLACE}[1][6]: expected a finite number, found inf"
        )

    def test_rejects_a_lower_limit_above_the_upper_one(self):
        assert self.message([[1] * 7, [0] * 7]).endswith("of joint 'fr3_joint1', found 1 and 0")


def test_equivalent_values_are_read_alike():
    robot = SimRobotConfig(
        joints=tuple(f"fr3_joint{i}" for i in range(1, 8)),
        q_home=np.zeros(7, np.float32),
        joint_limits=np.array([[-1] * 7, [1] * 7]),
        dof=np.int64(7),
        arm_collision_geoms=[{"body": "fr3_link0", "index": 0}],
    )
    sim = SimConfig(
        async_control=np.bool_(True), frequency=np.float32(20), max_convergence_steps=1e3
    )
    eye = SimCameraConfig("eye", np.int64(30), 640.0, type="TRACKING")
    config = cell(
        robot_cfgs={"left": robot},
        sim_cfg=sim,
        camera_cfgs={"eye": eye},
        control_mode="joints",
        relative_to="LAST_STEP",
        max_relative_movement=0.05,
        wrapper_cfg={"binary_gripper": False},
        camera_adds={"eye": {"xml_path": "d405"}},
        world_frame_objects={"cube": ["green_cube", rc.Pose()], "lid": {"mjcf_path": "mug"}},
    ).to_env_config()
    assert list(config.robots["left"].home["arm"]) == [0] * 7
    assert config.robots["left"].edits[6].range == pytest.approx([-1, 1])
    assert (config.sim.async_control, config.sim.frequency) == (True, 20)
    stream = config.cameras.streams[0]
    assert (stream.follow, stream.width, stream.rate) == ("eye", 640, 30)
    assert config.control_mode == rc.envs.ControlMode.JOINTS
    assert config.max_relative_movement == pytest.approx((0.05,))
    assert not config.wrappers.binary_gripper
    assert list(config.world_frame_objects) == ["cube", "lid"]


def test_reading_changes_nothing():
    cfg = cell(robot_frame_objects=None)
    cfg.to_env_config()
    assert cfg == cell(robot_frame_objects=None)
    assert cfg.gripper_cfgs["left"].joints == SimGripperConfig().joints


def test_rejects_an_added_camera_named_like_a_free_camera():
    streams = {"b": SimCameraConfig("b", type=CameraType.free), "own": SimCameraConfig("b_free")}
    cfg = cell(camera_cfgs=streams, camera_adds={"b_free": CameraAdderConfig(fovy=60.0)})
    assert message(cfg, rc.ArgumentError) == (
        "camera_adds.b_free: camera_cfgs.b is a free camera, which gets this name; give the one of "
        "camera_adds another name, or camera_cfgs.b the type fixed and identifier='b_free' to show "
        "it"
    )


@pytest.mark.parametrize("kind", ["tracking", "free", "default_free"])
def test_rejects_an_added_camera_that_its_stream_cannot_show(kind: str):
    streams = {"eye": SimCameraConfig("eye", type=kind)}
    cfg = cell(camera_cfgs=streams, camera_adds={"eye": CameraAdderConfig(fovy=60.0)})
    assert message(cfg, rc.ArgumentError) == (
        f"camera_adds.eye: camera_cfgs.eye has the type {kind}, which shows no camera of the "
        "scene; give it the type fixed, or leave this camera out"
    )


def test_a_creator_accepts_a_configuration():
    with pytest.raises(TypeError, match="cfg: expected a SimEnvCreatorConfig, found 'fr3'"):
        SimEnvCreator()("fr3")


def test_fields_of_a_locally_defined_class_are_accepted():
    class Local:
        pass

    @dataclass(kw_only=True)
    class Own(PickTaskConfig):
        extra: Local | None = None

    own = Own(extra=Local(), robot_name="left")
    assert cell(task_cfg=own).to_env_config().task.object == "PickTask"
    own.include_rotation = "no"
    assert message(cell(task_cfg=own), TypeError).startswith("task_cfg.include_rotation: expected")


class TestErrorsOfScenes:
    """What only the models tell comes from robocell, with the page's names."""

    def message(
        self,
        rename: dict[str, object],
        gripper: dict[str, object] | None = None,
        eye: SimCameraConfig | None = None,
        name: str = "left",
    ) -> str:
        own = rc.RobotConfig.load(rc.models.robot_file("rc7")).move_groups["arm"]
        robot: dict[str, object] = {
            "robot_type": "rc7", "kinematic_model_path": "rc7", "base": "base_link",
            "joints": list(own.joints), "actuators": list(own.actuators), "q_home": None,
        }  # fmt: skip
        grippers = {"left": SimGripperConfig(**gripper)} if gripper else None
        cfg = SimEnvCreatorConfig(
            robot_cfgs={name: SimRobotConfig(**robot | rename)},
            gripper_cfgs=grippers,
            camera_cfgs={"eye": eye} if eye else None,
            headless=True,
            sim_cfg=SimConfig(),
            control_mode=ControlMode.JOINTS,
        )
        with pytest.raises(rc.Error) as error:
            SimEnvCreator()(cfg)
        return str(error.value)

    def test_about_arms(self):
        assert "robot_cfgs.left.actuators: an arm has one actuator per joint: 1 actu" in (
            self.message({"actuators": ["joint1"]})
        )
        assert "robot 'left': base: no body 'foot'" in self.message({"base": "foot"})
        assert "robot_cfgs.left.robot_type: 'a/b' cannot be a name" in (
            self.message({"robot_type": "a/b"})
        )
        text = self.message({"q_home": [99] + [0] * 6})
        assert "robot 'left': q_home: 99 is outside the limits" in text

        assert "robot_cfgs: 'a/b' cannot be a name here" in self.message({}, name="a/b")

    def test_about_cameras(self):
        eye = SimCameraConfig("nope")
        assert self.message({}, eye=eye).startswith("camera_cfgs.eye.identifier: no camera 'nope'")
        eye.type = CameraType.tracking
        assert self.message({}, eye=eye).startswith(
            "camera_cfgs.eye.identifier: no object or body 'nope'"
        )
        eye = SimCameraConfig("", type=CameraType.default_free, frame_rate=1000)
        assert "camera_cfgs.eye.frame_rate: its rate, 1000 Hz, is more often" in (
            self.message({}, eye=eye)
        )

    def test_about_grippers(self):
        hand = {"gripper_type": "ParallelHand", "collision_geoms_fingers": ["a"]}
        assert "gripper_cfgs.left.collision_geoms_fingers: a gripper has two fingers" in (
            self.message({}, hand)
        )
