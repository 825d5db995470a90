"""RCS's page on scene configuration, snippet by snippet.

The code between the lines is the page's; what is asserted is what it says. The arms are the
Menagerie's FR3 with the hand of the Panda; mounts, cube and housing are robocell's own.
"""

from __future__ import annotations

import numpy as np
import pytest

import robocell as rc
import robocell.compat.rcs as rcs
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
from robocell.compat.rcs.envs.tasks import PickTaskConfig
from robocell.compat.rcs.sim import (
    CameraType,
    SimCameraConfig,
    SimConfig,
    SimGripperConfig,
    SimRobotConfig,
)

EXACT = (1e-9, 1e-9)
SMALL = {"resolution_width": 32, "resolution_height": 24}


@pytest.fixture(scope="module")
def fr3() -> SimRobotConfig:
    """An arm whose files are there."""
    from menagerie import require_menagerie

    require_menagerie("franka_fr3", "franka_emika_panda")
    return SimRobotConfig()


def camera(name: str) -> SimCameraConfig:
    return SimCameraConfig(identifier=name, frame_rate=30, **SMALL)


def minimal(robot_cfg: SimRobotConfig, **more) -> SimEnvCreatorConfig:
    """One arm, nothing else."""
    return SimEnvCreatorConfig(
        robot_cfgs={"robot": robot_cfg},
        sim_cfg=SimConfig(async_control=True),
        control_mode=ControlMode.CARTESIAN_TQuat,
        **more,
    )


def duo(robot_cfg: SimRobotConfig, **more) -> SimEnvCreatorConfig:
    robot_cfg_left = robot_cfg_right = robot_cfg
    # --- Dual-arm scene
    robot_cfgs = {"left": robot_cfg_left, "right": robot_cfg_right}
    robot_to_shared_base_frame = {
        "left": DEFAULT_TRANSFORMS["FR3_DUOMOUNT_LEFT_ROBOT"],
        "right": DEFAULT_TRANSFORMS["FR3_DUOMOUNT_RIGHT_ROBOT"],
    }
    shared_base_frame_to_root_frame = DEFAULT_TRANSFORMS["FR3_DUOMOUNT_HEIGHT_OFFSET"]
    root_frame_to_world = rcs.common.Pose()
    # ---
    frames = {
        "robot_to_shared_base_frame": robot_to_shared_base_frame,
        "shared_base_frame_to_root_frame": shared_base_frame_to_root_frame,
        "root_frame_to_world": root_frame_to_world,
    }
    return SimEnvCreatorConfig(
        robot_cfgs=robot_cfgs,
        sim_cfg=SimConfig(async_control=True),
        control_mode=ControlMode.CARTESIAN_TQuat,
        **(frames | more),
    )


def built(cfg: SimEnvCreatorConfig) -> rc.Scene:
    return rc.Scene.build(SimEnvCreator().create_model(cfg))


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
    with pytest.raises(rc.NotFoundError, match=r"stream 'bird_eye': no camera 'bird_eye'"):
        rc.Env(cfg.to_env_config())
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
    for side in ("left", "right"):  # the arms stand on the mount's plates
        plate = scene.site_pose(f"duo_mount_{side}_base")
        assert scene.body_pose(f"robot{side}_base").is_close(plate, 1e-5, 1e-5)
    moved = rcs.common.Pose(translation=[1, 2, 0.5], rpy=[0.2, 0, 1])
    cfg.root_frame_to_world = moved
    after = built(cfg)
    for body in scene.body_names():
        expected = scene.body_pose(body)
        if body not in ("world", "cube_green_cube"):
            expected = moved * expected
        assert after.body_pose(body).is_close(expected, *EXACT), body


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
    assert np.allclose((root.inverse() * body).translation, [0.5, 0, 0.05], atol=1e-9)
    assert info["instruction"] == "pick up the PickTask"
    env.close()
    for wrong, text in (
        (
            PickTaskConfig(robot_name="rbot"),
            r"task_cfg.robot_name: no robot 'rbot'. Known robots: robot",
        ),
        (PickTaskConfig(task_id="pour"), r"task_cfg: no task 'pour'. Known tasks: pick"),
    ):
        with pytest.raises(rc.NotFoundError, match=text):
            minimal(fr3, task_cfg=wrong).to_env_config()


def test_every_field_becomes_one_of_robocells():
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
    with pytest.raises(rc.ArgumentError, match="robot FR3: dof is 6, but joints has 7 names"):
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
    with pytest.raises(
        rc.ArgumentError, match=r"camera_cfgs.eye: its type is free; images are taken"
    ):
        SimCameraConfig(identifier="eye", type=CameraType.free).to_stream("eye")

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
    assert (config.max_relative_movement, config.relative_to) == ((0.1, 0.2), rc.RelativeTo.NONE)
    assert config.add_gravcomp
    assert config.control_mode == rc.ControlMode.CARTESIAN_TQUAT
    assert BaseCameraSet.DEPTH_SCALE == 1000


def test_defaults_are_the_pages():
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
