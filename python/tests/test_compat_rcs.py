"""RCS's page on scene configuration, snippet by snippet.

The code between the lines is the page's; what is asserted is what it says. The arms are the
Menagerie's FR3 with the hand of the Panda; mounts, cube and housing are robocell's own.
"""

from __future__ import annotations

import copy
import pickle
import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest

import robocell as rc
import robocell.compat.rcs as rcs
from rcs_cells import EXACT, SMALL, built, camera, duo, fr3, minimal
from robocell.compat.rcs import DEFAULT_TRANSFORMS, OBJECT_PATHS, SCENE_PATHS
from robocell.compat.rcs.camera import BaseCameraSet
from robocell.compat.rcs.envs.base import ControlMode, RelativeTo
from robocell.compat.rcs.envs.configs import EmptyWorldFR3, EmptyWorldFR3Duo
from robocell.compat.rcs.envs.scenes import (
    CameraAdderConfig,
    SimEnvCreator,
    SimEnvCreatorConfig,
    WrapperConfig,
)
from robocell.compat.rcs.envs.tasks import BaseTaskConfig, PickPlaceTaskConfig, PickTaskConfig
from robocell.compat.rcs.sim import (
    SimCameraConfig,
    SimConfig,
    SimGripperConfig,
    SimRobotConfig,
)

__all__ = ["fr3"]  # a fixture


def test_poses():
    identity = rcs.common.Pose()
    a = rcs.common.Pose(translation=np.array([0.5, 0.0, 0.2]))
    b = rcs.common.Pose(translation=np.array([0, 1, 0]), quaternion=np.array([0, 0, 1, 0]))
    assert identity == rc.Pose()
    assert np.array_equal(a.translation, [0.5, 0, 0.2])
    assert np.allclose((a * b).translation, [0.5, 1, 0.2])
    assert np.allclose((b * a).translation, [-0.5, 1, 0.2]), "from left to right"
    written = rcs.common.Pose(quaternion=[0.0060, -0.0060, -0.7067, 0.7074])
    assert np.linalg.norm(written.quaternion) == pytest.approx(1, abs=1e-15)
    for wrong in ([0, 0, 0, 0], [0, 0, 0, 2]):
        with pytest.raises(rc.ArgumentError, match="has length"):
            rcs.common.Pose(quaternion=wrong)
    for wrong in ("abc", {}, [0, "x", 0, 1]):
        with pytest.raises(TypeError, match=r"quaternion.* must be a "):
            rcs.common.Pose(quaternion=wrong)


def test_the_three_transforms(fr3):
    rng = np.random.default_rng(0)
    names = ("root_frame_to_world", "shared_base_frame_to_root_frame")
    frames = {
        n: rcs.common.Pose(translation=rng.normal(size=3), rpy=rng.normal(size=3)) for n in names
    }
    robot_to_shared_base_frame = {
        "robot": rcs.common.Pose(translation=rng.normal(size=3), rpy=rng.normal(size=3))
    }
    scene = built(minimal(fr3, **frames, robot_to_shared_base_frame=robot_to_shared_base_frame))
    root_frame_to_world, shared_base_frame_to_root_frame = (frames[n] for n in names)
    robot_name = "robot"
    # --- How the main placement frames work
    robot2world = (
        root_frame_to_world
        * shared_base_frame_to_root_frame
        * robot_to_shared_base_frame[robot_name]
    )
    # ---
    assert scene.body_pose("robotrobot_base").is_close(robot2world, *EXACT)


def test_one_arm_without_offsets(fr3):
    # --- Single-robot intuition
    root_frame_to_world = rcs.common.Pose()
    shared_base_frame_to_root_frame = rcs.common.Pose()
    robot_to_shared_base_frame = {"robot": rcs.common.Pose()}
    # ---
    scene = built(
        minimal(
            fr3,
            root_frame_to_world=root_frame_to_world,
            shared_base_frame_to_root_frame=shared_base_frame_to_root_frame,
            robot_to_shared_base_frame=robot_to_shared_base_frame,
        )
    )
    assert scene.body_pose("robotrobot_base").is_close(rc.Pose(), *EXACT)
    assert scene.shared_base_frame_to_world == scene.root_frame_to_world == rc.Pose()


def test_the_minimal_scene_and_its_cameras(fr3):
    robot_cfg, gripper_cfg = fr3, SimGripperConfig()
    bird_eye_cfg, wrist_cfg = camera("bird_eye"), camera("wrist")
    # --- Minimal single-robot scene
    cfg = SimEnvCreatorConfig(
        robot_cfgs={"robot": robot_cfg},
        sim_cfg=SimConfig(async_control=False, realtime=True, frequency=1),
        control_mode=ControlMode.CARTESIAN_TQuat,
        scene=SCENE_PATHS["empty_world"],
        gripper_cfgs={"robot": gripper_cfg},
        camera_cfgs={"bird_eye": bird_eye_cfg, "wrist": wrist_cfg},
        robot_to_shared_base_frame={"robot": rcs.common.Pose()},
        shared_base_frame_to_root_frame=rcs.common.Pose(),
        root_frame_to_world=rcs.common.Pose(),
    )
    # ---
    with pytest.warns(UserWarning, match="camera_adds has no camera") as told:
        as_printed = SimEnvCreator()(cfg)
    assert [str(each.message) for each in told if "camera_cfgs" in str(each.message)] == [
        "camera_cfgs.bird_eye: camera_adds has no camera 'bird_eye'; it is placed relative to the "
        "root frame as EmptyWorldFR3 has it. To place it elsewhere, add 'bird_eye' to camera_adds",
        "camera_cfgs.wrist: camera_adds has no camera 'wrist'; it is placed relative to the wrist "
        "of robot 'robot' as EmptyWorldFR3 has it. To place it elsewhere, add 'wrist' to "
        "camera_adds",
    ]
    observation, _ = as_printed.reset(seed=0)
    assert set(observation["frames"]) == {"bird_eye", "wrist"}
    as_printed.close()
    some_pose = rcs.common.Pose(translation=[0.06, 0, 0.05], rpy=[np.pi, -0.35, np.pi / 2])
    # --- Fixed scene camera, wrist camera
    camera_adds = {
        "bird_eye": CameraAdderConfig(
            fovy=60.0,
            offset=rcs.common.Pose(
                translation=np.array([0.271, 0.0, 2.080]),
                quaternion=np.array([0.0060, -0.0060, -0.7067, 0.7074]),
            ),
        )
    }
    camera_adds |= {
        "wrist": CameraAdderConfig(
            fovy=60.0,
            offset=some_pose,
            robot_name="robot",
        )
    }
    # ---
    cfg.camera_adds = camera_adds
    cfg.sim_cfg.realtime = False  # it is kept: src/robocell/env/env_test.cc
    cfg.add_gravcomp = True
    env = SimEnvCreator()(cfg)
    scene = env.core.scene
    assert scene.camera_pose("bird_eye").is_close(camera_adds["bird_eye"].offset, *EXACT)
    wrist = scene.site_pose("robotrobot_attachment_site")
    assert scene.camera_pose("wrist").is_close(wrist * some_pose, *EXACT)
    observation, _ = env.reset(seed=0)
    assert set(observation) == {"robot", "frames"}
    assert observation["frames"]["wrist"]["rgb"]["data"].shape == (24, 32, 3)
    assert "depth" not in observation["frames"]["wrist"]
    still = {"robot": {"tquat": [0, 0, -0.02, 0, 0, 0, 1], "gripper": [0.5]}}
    after, *_, info = env.step(still)
    assert info["reason"] == "arrived"
    moved = after["robot"]["tquat"][:3] - observation["robot"]["tquat"][:3]
    assert np.allclose(moved, [0, 0, -0.02], atol=5e-3)
    assert after["robot"]["gripper"] == [1], "a half opens"
    env.close()


def test_two_arms_in_one_frame(fr3):
    cfg = duo(
        fr3,
        # --- root_frame_objects
        root_frame_objects={
            "duo_mount": (OBJECT_PATHS["fr3_duo_mount"], DEFAULT_TRANSFORMS["FR3_DUOMOUNT_BASE"]),
        },
        # --- world_frame_objects
        world_frame_objects={
            "cube": (
                OBJECT_PATHS["green_cube"],
                rcs.common.Pose(translation=np.array([0.5, 0.0, 0.2])),
            ),
        },
        # --- robot_frame_objects
        robot_frame_objects={
            "left": {
                "left_d405_mount": (
                    OBJECT_PATHS["robotiq_d405_mount"],
                    DEFAULT_TRANSFORMS["FR3_ROBOTIQ_WRIST_D405_MOUNT"],
                )
            }
        },
        # ---
    )
    scene = built(cfg)
    left = scene.site_pose("robotleft_attachment_site")
    mount = left * DEFAULT_TRANSFORMS["FR3_ROBOTIQ_WRIST_D405_MOUNT"]
    assert scene.body_pose("left_d405_mount_robotiq_d405_mount").is_close(mount, *EXACT)
    assert scene.body_pose("cube_green_cube").is_close(rc.Pose(translation=[0.5, 0, 0.2]), *EXACT)
    plates = {side: scene.site_pose(f"duo_mount_{side}_base") for side in ("left", "right")}
    for side, plate in plates.items():  # the arms stand on them
        assert scene.body_pose(f"robot{side}_base").is_close(plate, 1e-5, 1e-5)
    scene.reset()
    scene.step_n(1000)
    assert scene.body_pose("cube_green_cube").translation[2] == pytest.approx(0.02, abs=1e-3)
    assert scene.site_pose("duo_mount_left_base").is_close(plates["left"], *EXACT)
    scene.reset()
    moved = rcs.common.Pose(translation=[1, 2, 0.5], rpy=[0.2, 0, 1])
    cfg.root_frame_to_world = moved
    after = built(cfg)
    for body in scene.body_names():
        expected = scene.body_pose(body)
        if body not in ("world", "cube_green_cube"):
            expected = moved * expected
        assert after.body_pose(body).is_close(expected, *EXACT), body


@pytest.mark.proof
def test_ready_made_configurations(fr3):
    for creator, robots in ((EmptyWorldFR3(), ["robot"]), (EmptyWorldFR3Duo(), ["left", "right"])):
        cfg = creator.config()
        cfg.camera_cfgs = {name: camera(name) for name in cfg.camera_cfgs or ()}
        env = creator(cfg)
        observation, _ = env.reset(seed=0)
        assert sorted(set(observation) - {"frames"}) == robots
        action = {r: {"tquat": [0, 0, 0.01, 0, 0, 0, 1], "gripper": [1]} for r in robots}
        observation, *_, info = env.step(action)
        assert env.observation_space.contains(observation)
        assert all(info["robots"][robot]["ik_success"] for robot in robots)
        env.close()


def test_a_housing_holds_the_camera(fr3):
    place = rcs.common.Pose(translation=[0.1, 0, 0.03])
    adds = {
        "d405": CameraAdderConfig(
            xml_path=rcs.CAMERA_PATHS["d405"], robot_name="robot", offset=place
        )
    }
    scene = built(minimal(fr3, camera_adds=adds))  # no stream is asked for
    assert list(scene.camera_names()) == ["d405"]
    shell = scene.site_pose("robotrobot_attachment_site") * place
    assert scene.body_pose("d405_d405").is_close(shell, *EXACT)
    lens = shell * rc.Pose(translation=[0, 0, 0.0235], rpy=[0, np.pi, 0])
    assert scene.camera_pose("d405").is_close(lens, *EXACT)
    assert scene.model.camera("d405").fovy == 58


@pytest.mark.parametrize("add_gravcomp", [False, True])
def test_grippers_and_gravity(fr3, add_gravcomp):
    offset = rcs.common.Pose(translation=[0, 0.01, 0.02], rpy=[0, 0, -np.pi / 4])
    scene = built(
        minimal(
            fr3,
            gripper_cfgs={"robot": SimGripperConfig()},
            gripper_offsets={"robot": offset},
            world_frame_objects={"cube": (OBJECT_PATHS["green_cube"], rcs.common.Pose())},
            add_gravcomp=add_gravcomp,
        )
    )
    flange = scene.site_pose("robotrobot_attachment_site")
    assert scene.body_pose("gripperrobot_hand").is_close(flange * offset, *EXACT)
    for body in scene.body_names():
        of_robot = body.startswith(("robotrobot_", "gripperrobot_"))
        gravcomp = scene.model.body_gravcomp[scene.model.body(body).id]
        assert gravcomp == (add_gravcomp and of_robot), body


def test_the_pick_task(fr3):
    root = rcs.common.Pose(translation=[1, 0, 0], rpy=[0, 0, 1.5])
    env = SimEnvCreator()(minimal(fr3, task_cfg=PickTaskConfig(), root_frame_to_world=root))
    _, info = env.reset(seed=0)
    body = env.core.scene.body_pose("PickTask_green_cube")
    assert np.allclose((root.inverse() * body).translation, [0.5, 0, 0.02], atol=1e-6)
    assert info["instruction"] == "pick up the PickTask"
    still = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1]}}
    heights = [env.step(still)[0]["objects"]["PickTask"]["tquat"][2] for _ in range(20)]
    assert heights[-1] == pytest.approx(0.02, abs=1e-3), "it lies on the ground of the empty world"
    env.close()
    for wrong, text in (
        (
            PickTaskConfig(robot_name="rbot"),
            r"task_cfg.robot_name: no robot 'rbot'. Known robots: robot",
        ),
        (
            PickTaskConfig(task_id="dance"),
            r"task_cfg: no task 'dance'. Known tasks: .*pick, pick_and_place",
        ),
    ):
        with pytest.raises(rc.NotFoundError, match=text):
            minimal(fr3, task_cfg=wrong).to_env_config()


def carried(env, observation, stops) -> list[dict]:
    """What each step told on the way through these places, with the gripper so far open."""
    at, told = observation["robot"]["tquat"][:3], []
    for place, gripper in stops:
        steps = int(np.ceil(max(1, np.linalg.norm(place - at) / 0.03)))  # too gentle to lose it
        for way in np.linspace(0, 1, steps + 1)[1:]:
            tquat = [*(at + way * (place - at)), 1, 0, 0, 0]
            *_, info = env.step({"robot": {"tquat": tquat, "gripper": [gripper]}})
            told.append(info)
        at = place
    return told


def test_the_pick_and_place_task(fr3):
    fr3 = SimRobotConfig(tcp_offset=rcs.GRIPPER_TCP_OFFSETS["FrankaHand"])
    env = SimEnvCreator()(
        SimEnvCreatorConfig(
            robot_cfgs={"robot": fr3},
            gripper_cfgs={"robot": SimGripperConfig()},
            gripper_offsets={"robot": rcs.GRIPPER_MOUNT_OFFSETS["FrankaHand"]},
            sim_cfg=SimConfig(max_convergence_steps=1000),
            control_mode=ControlMode.CARTESIAN_TQuat,
            relative_to=RelativeTo.NONE,
            task_cfg=PickPlaceTaskConfig(
                object_center_to_root_frame=rcs.common.Pose(translation=[0.5, 0, 0.02]),
                include_rotation=False,
            ),
            add_gravcomp=True,
            headless=True,
        )
    )
    observation, info = env.reset(seed=0)
    assert info["instruction"] == "pick up the PickPlaceTask and put it down at the goal"
    cube = observation["objects"]["PickPlaceTask"]["tquat"][:3]
    goal = observation["task"]["goal"]
    assert np.allclose(goal, [0.5, 0.25, 0.02])
    up, low = np.array([0, 0, 0.08]), goal + np.array([0, 0, 0.004])
    there = [(cube + up, 1), (cube, 1), (cube, 0), (cube + up, 0), (goal + up, 0), (low, 0)]
    told = carried(env, observation, [*there, (low, 1)])
    assert [info["is_success"] for info in told] == [False] * (len(told) - 1) + [True]
    lying = env.core.scene.body_pose("PickPlaceTask_green_cube").translation
    assert np.linalg.norm(lying - goal) < 0.03
    env.close()
    with pytest.raises(
        rc.ArgumentError, match="needs the place of the object; PickPlaceTaskConfig has goal"
    ):
        minimal(fr3, task_cfg=PickTaskConfig(task_id="pick_place")).to_env_config()
    config = minimal(
        fr3, task_cfg=PickPlaceTaskConfig(goal=np.array([0.4, 0, 0]), goal_tolerance=0.01)
    ).to_env_config()
    assert list(config.task.goal) == [0.4, 0, 0]
    assert config.task.goal_tolerance == 0.01


class Wait(rc.tasks.Task):
    """Nothing is to be done, beside an object where there is one."""

    @dataclass
    class Fields:
        object: str = ""

    def __init__(self, fields):
        super().__init__()
        self.object = fields.object

    def reward(self, scene):
        return 0.5

    def success(self, scene):
        return False

    def instruction(self):
        return f"wait beside the {self.object}"

    def objects(self):
        return [self.object] if self.object else []


class BesideALamp(BaseTaskConfig):
    def add_to(self, config: rc.EnvConfig) -> None:
        super().add_to(config)
        config.world_frame_objects["lamp"] = (OBJECT_PATHS["green_cube"], rc.Pose())


def test_custom_tasks_run_in_an_environment(fr3):
    rc.register_task("wait")(Wait)
    env = SimEnvCreator()(minimal(fr3, task_cfg=BaseTaskConfig(task_id="wait"), headless=True))
    assert env.reset(seed=0)[1]["instruction"] == "wait beside the "
    still = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1]}}
    assert env.step(still)[1] == 0.5
    env.close()
    about = PickTaskConfig(task_id="wait", prefix="Cube_")
    env = SimEnvCreator()(minimal(fr3, task_cfg=about, headless=True))
    observation, info = env.reset(seed=0)
    assert info["instruction"] == "wait beside the Cube"
    assert np.allclose(observation["objects"]["Cube"]["tquat"][:3], [0.5, 0, 0.05])
    env.close()
    config = minimal(fr3, task_cfg=BesideALamp(task_id="wait")).to_env_config()
    assert (list(config.world_frame_objects), config.task.kind) == (["lamp"], "wait")
    with pytest.raises(
        rc.NotFoundError,
        match=r"no task 'dance'. Known tasks: .*pick, pick_and_place, .*wait.*; "
        r"your own are add",
    ):
        minimal(fr3, task_cfg=BaseTaskConfig(task_id="dance")).to_env_config()


def told_by(make) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        make()
        make()
    return [str(each.message) for each in caught]


def test_ineffective_fields_warn_once_when_set():
    assert told_by(lambda: SimRobotConfig(seconds_between_callbacks=0.2).to_robot()) == [
        "SimRobotConfig.seconds_between_callbacks does nothing: whether the arm has arrived is "
        "looked at with every step of the engine; joint_rotational_tolerance says how near that is"
    ]
    gripper = SimGripperConfig(
        min_joint_width=0.005, max_joint_width=1.0, collision_geoms=["hand_c"],
        ignored_collision_geoms=["finger"], seconds_between_callbacks=0.1,
    )  # fmt: skip
    told = told_by(gripper.to_robot)
    assert [text.split(" does nothing: ")[0] for text in told] == [
        "SimGripperConfig.seconds_between_callbacks"
    ]
    env = minimal(SimRobotConfig(), task_cfg=PickTaskConfig(object_joint="x"))
    assert told_by(env.to_env_config) == [
        "PickTaskConfig.object_joint does nothing: robocell finds the free joint of the object, "
        "and adds one to a model that has none"
    ]
    env.task_cfg = PickTaskConfig()
    assert told_by(env.to_env_config) == []
    assert told_by(lambda: SimRobotConfig().to_robot()) == []
    assert told_by(lambda: SimGripperConfig(collision_geoms=[]).to_robot()) == []


@dataclass(kw_only=True)
class Stacking(BaseTaskConfig):
    task_id: str = "pick"
    height: float = 0.1


def test_unknown_fields_suggest_the_nearest(fr3):
    for config, name, meant in [
        (SimConfig(), "frequncy", "frequency"),
        (SimRobotConfig(), "atachment_site", "attachment_site"),
        (SimGripperConfig(), "actuators", "actuator"),
        (camera("wrist"), "framerate", "frame_rate"),
        (minimal(fr3), "robot_cfg", "robot_cfgs"),
        (PickTaskConfig(), "object_xm", "object_xml"),
        (Stacking(), "heigth", "height"),
    ]:
        told = rf"a {type(config).__name__}: no field '{name}'\. Its fields: .*'{meant}'\?$"
        with pytest.raises(AttributeError, match=told):
            setattr(config, name, 1)
        assert not hasattr(config, name)
        with pytest.raises(TypeError, match=told):
            type(config)(**{name: 1})
        setattr(config, meant, getattr(config, meant))
        for same in (copy.deepcopy(config), pickle.loads(pickle.dumps(config)), replace(config)):
            assert same == config
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'identifier'"):
        SimCameraConfig()


def test_rejects_an_original_configuration(fr3):
    assert minimal(fr3, _original_cfg=None).to_env_config() == minimal(fr3).to_env_config()
    with pytest.raises(rc.ArgumentError, match="_original_cfg: robocell prefixes nothing in place"):
        minimal(fr3, _original_cfg=minimal(fr3)).to_env_config()


def test_every_field_maps_to_a_robocell_field():
    own = rc.models.robot_file("rc7")
    limits = [[-1] * 2, [1] * 2]
    robot = SimRobotConfig(
        robot_type="Own", kinematic_model_path="own.xml", attachment_site="flange", base="foot",
        tcp_offset=rc.Pose(translation=[0, 0, 0.1]), joints=["a", "b"], actuators=["c", "d"], dof=2,
        joint_limits=limits, q_home=[0.1, 0.2], joint_rotational_tolerance=0.02,
        arm_collision_geoms=["g"],
    ).to_robot()  # fmt: skip
    assert (robot.name, robot.model, robot.root_body, robot.attachment_site) == (
        "Own", "own.xml", "foot", "flange",
    )  # fmt: skip
    assert robot.tcp_offset == rc.Pose(translation=[0, 0, 0.1])
    assert list(robot.move_groups["arm"].joints) == ["a", "b"]
    assert list(robot.move_groups["arm"].actuators) == ["c", "d"]
    assert [list(edit.range) for edit in robot.edits] == [[-1, 1], [-1, 1]]
    assert (list(robot.home["arm"]), robot.arrival_tolerance) == ([0.1, 0.2], 0.02)
    assert len(robot.collision_geoms) == 1
    with pytest.raises(rc.ArgumentError, match=r"dof: expected None or .* 7 joints .*, found 6"):
        SimRobotConfig(dof=6).to_robot()

    gripper = SimGripperConfig(
        gripper_type="Robotiq2F85", joints=["r", "l"], actuator="pull", min_actuator_width=255,
        max_actuator_width=0, collision_geoms_fingers=["x", "y"],
    ).to_robot()  # fmt: skip
    group = gripper.move_groups["gripper"]
    assert gripper.model == "menagerie:robotiq_2f85/2f85.xml"
    assert (list(group.joints), list(group.actuators)) == (["r", "l"], ["pull"])
    assert (group.ctrl.open, group.ctrl.closed, len(group.fingers)) == (0, 255, 2)
    with pytest.raises(
        rc.NotFoundError, match=r"no gripper 'Hand'. Known grippers: FrankaHand, Rob"
    ):
        SimGripperConfig(gripper_type="Hand").to_robot()

    sim = SimConfig(async_control=False, realtime=True, frequency=20, max_convergence_steps=100)
    settings = sim.to_settings()
    assert (settings.realtime, settings.frequency, settings.async_control) == (True, 20, False)
    assert settings.max_convergence_time == pytest.approx(100 * settings.timestep)
    unlimited = SimConfig(max_convergence_steps=-1).to_settings()
    assert unlimited.max_convergence_time == pytest.approx(1e6 * settings.timestep)
    cell = rc.EnvConfig(robots={"rc7": rc.models.robot_file("rc7")}, sim=unlimited)
    rc.Env(cell).close()

    stream = SimCameraConfig(identifier="eye", frame_rate=15, **SMALL).to_stream("left eye")
    assert (stream.name, stream.camera, stream.rate) == ("left eye", "eye", 15)
    assert (stream.width, stream.height) == (32, 24)

    wrappers = WrapperConfig(binary_gripper=False, home_on_reset=False, include_depth=True)
    cfg = minimal(
        SimRobotConfig(),
        scene=own,
        gripper_cfgs={"robot": SimGripperConfig()},
        gripper_offsets={"robot": rc.Pose(rpy=[0, 0, 1])},
        max_relative_movement=(0.1, 0.2),
        relative_to=RelativeTo.NONE,
        add_gravcomp=True,
        headless=True,
        alternative_combined_robot_mjcf="arms.xml",
        wrapper_cfg=wrappers,
    )
    config = cfg.to_env_config("own")
    assert (config.headless, config.alternative_combined_robot_mjcf) == (True, "arms.xml")
    assert (config.name, config.scene, config.wrappers) == ("own", own, wrappers)
    assert config.gripper_offsets["robot"] == rc.Pose(rpy=[0, 0, 1])
    assert (config.max_relative_movement, config.relative_to) == (
        (0.1, 0.2),
        rc.envs.RelativeTo.NONE,
    )
    assert config.add_gravcomp
    assert config.control_mode == rc.envs.ControlMode.CARTESIAN_TQUAT
    assert BaseCameraSet.DEPTH_SCALE == 1000


def test_defaults_match_the_page():
    cfg = SimEnvCreatorConfig(robot_cfgs={}, sim_cfg=SimConfig(), control_mode=ControlMode.JOINTS)
    assert cfg.relative_to == RelativeTo.LAST_STEP
    assert (cfg.scene, cfg.add_gravcomp, cfg.headless) == ("empty_world", False, False)
    assert not cfg.to_env_config().headless
    assert (cfg.wrapper_cfg.binary_gripper, cfg.wrapper_cfg.home_on_reset) == (True, True)
    assert not cfg.wrapper_cfg.include_depth
    with pytest.raises(
        NotImplementedError, match="SimEnvCreator has no config of its own; pass cfg="
    ):
        SimEnvCreator()()
    with pytest.raises(TypeError, match="robot_cfg"):
        SimEnvCreatorConfig(robot_cfg={})
