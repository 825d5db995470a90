"""The user's guide of mj_kdl_wrapper 0.2.2, section by section, on the Gen3 with the 2F-85.

The code is the guide's; what is asserted is what it says.
"""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell.compat.mj_kdl_wrapper as mjk
import test_video as recording
from test_kdl_chain import PyKDL, needs_pykdl

pytestmark = needs_pykdl


@pytest.fixture(scope="module", autouse=True)
def in_a_fetched_folder(tmp_path_factory: pytest.TempPathFactory):
    """Started in a folder that `mj-kdl-fetch-menagerie --dest` filled: `assets/...` is there."""
    from menagerie import require_menagerie

    require_menagerie("kinova_gen3", "robotiq_2f85")
    folder = tmp_path_factory.mktemp("guide")
    mjk.menagerie.fetch(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


def base_spec() -> mjk.SceneSpec:
    spec = mjk.SceneSpec()
    spec.timestep = 0.002
    spec.add_floor = True
    spec.add_skybox = True
    return spec


def with_gripper() -> mjk.RobotSpec:
    gripper = mjk.AttachmentSpec()
    gripper.mjcf_path = "assets/robotiq_2f85/2f85.xml"
    gripper.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "pinch_site")
    gripper.prefix = "g_"
    robot_spec = mjk.RobotSpec()
    robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
    robot_spec.attachments = [gripper]
    return robot_spec


@pytest.fixture
def scene() -> mjk.Scene:
    spec = base_spec()
    spec.robots = [with_gripper()]
    return mjk.Scene.build(spec)


@pytest.fixture
def robot(scene: mjk.Scene) -> mjk.Robot:
    tool = mjk.ToolFrameSpec()
    tool.tool_body = "g_base"
    tool.tcp_site = "g_pinch"
    return mjk.Robot.from_scene(scene, "base_link", "bracelet_link", tool=tool)


def test_load_from_mjcf(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    spec = base_spec()
    robot_spec = mjk.RobotSpec()
    robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
    spec.robots = [robot_spec]
    scene = mjk.Scene.build(spec)
    with_robot = scene.model.nq

    cabinet = mjk.SceneObject()
    cabinet.name = "cabinet"
    cabinet.mjcf_path = mjk.menagerie.asset_path("cabinet/cabinet.xml")
    cabinet.fixed = True
    spec.objects = [cabinet]
    scene = mjk.Scene.build(spec)
    assert scene.model.nq == with_robot + 2
    spec.robots = []
    scene = mjk.Scene.build(spec)

    scene.step_n(10)
    assert (scene.time(), scene.timestep()) == (pytest.approx(0.02), 0.002)
    scene.save_xml("combined_scene.xml")
    scene.save_binary("combined_scene.mjb")
    for stock in (
        mujoco.MjModel.from_xml_path("combined_scene.xml"),
        mujoco.MjModel.from_binary_path("combined_scene.mjb"),
    ):
        assert (stock.nq, stock.nv, stock.nbody) == (2, 2, scene.model.nbody)
    scene.close()
    scene.close()
    with pytest.raises(RuntimeError, match="closed"):
        scene.step()


def test_choices_are_required():
    for missing in ("timestep", "add_floor", "add_skybox"):
        spec = base_spec()
        setattr(spec, missing, None)
        with pytest.raises(RuntimeError, match=missing):
            mjk.Scene.build(spec)
    spec = base_spec()
    spec.timestep = 0
    with pytest.raises(RuntimeError, match="timestep"):
        mjk.Scene.build(spec)


def test_log_levels_and_versions():
    before = mjk.get_log_level()
    mjk.set_log_level(mjk.LogLevel.ERROR)
    assert mjk.get_log_level() == mjk.LogLevel.ERROR
    mjk.set_log_level(mjk.LogLevel.INFO)
    assert mjk.get_log_level() == mjk.LogLevel.INFO
    mjk.set_log_level(mjk.LogLevel.NONE)
    assert mjk.get_log_level() == mjk.LogLevel.NONE
    mjk.set_log_level(before)
    assert mjk.mujoco_version() == mjk.__mujoco_version__ == mujoco.mj_versionString()
    assert isinstance(mjk.__version__, str)


def test_init_a_kdl_chain(scene: mjk.Scene):
    robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link")
    robot.ctrl_mode = mjk.CtrlMode.POSITION
    robot.jnt_pos_cmd = [0.0] * robot.n_joints
    robot.update()
    robot.step()
    assert robot.n_joints == len(robot.joint_names) == len(robot.joint_limits) == 7
    tool = mjk.ToolFrameSpec()
    tool.tool_body = "g_base"
    tool.tcp_site = "g_pinch"
    robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link", tool=tool)
    assert robot.has_tcp_frame


def test_frames_of_robots_are_those_of_kdl(scene: mjk.Scene, robot: mjk.Robot):
    robot.set_joint_pos([0.3, -0.4, 0.5, 0.6, -0.7, 0.8, -0.9])
    in_world = scene.body_frame("base_link") * robot.fk_frame()
    assert isinstance(in_world, PyKDL.Frame)
    assert PyKDL.Equal(in_world, scene.site_frame("g_pinch"), 1e-9)
    assert PyKDL.Equal(
        scene.body_frame("bracelet_link") * robot.tip_to_tcp, scene.site_frame("g_pinch"), 1e-9
    )
    q = PyKDL.JntArray(7)
    assert PyKDL.Equal(robot.fk_frame(q), robot.fk_frame([0.0] * 7), 1e-15)
    assert not PyKDL.Equal(robot.fk_frame(q), robot.fk_frame(), 1e-3)


def test_rejects_misspelt_names_and_wrong_values(scene: mjk.Scene, robot: mjk.Robot):
    env = mjk.Env(scene)
    with pytest.raises(
        AttributeError, match=r"an Env has no 'on_rest'\. Did you mean 'on_reset'\?"
    ):
        env.on_rest = print
    with pytest.raises(AttributeError, match=r"an Env has no 'stepp'\. Did you mean 'step'\?"):
        env.stepp()
    with pytest.raises(AttributeError, match="on_rest"):
        robot.on_rest = print
    calls = []
    env.on_reset = calls.append
    with pytest.raises(TypeError, match=r"on_reset: expected a function .*, or None; got 5"):
        env.on_reset = 5
    assert env.on_reset == calls.append
    env.reset()
    assert len(calls) == 1, "the hook from before is still there"
    with pytest.raises(TypeError, match=r"expected one of LogLevel\.INFO, .*; got 'info'"):
        mjk.set_log_level("info")
    with pytest.raises(TypeError, match="expected a SceneObject, got 'table'"):
        mjk.scene_object_site_name("table", "table_top")


def test_errors_name_the_argument_of_a_wrong_type(scene: mjk.Scene, robot: mjk.Robot):
    with pytest.raises(TypeError, match=r"model_path: expected a robot's name, .*; got 3"):
        mjk.menagerie.model_path(3)
    with pytest.raises(TypeError, match=r"VideoRecorder\.open\(\): width: expected .*, got 'a'"):
        mjk.VideoRecorder.open(scene, "a.mp4", width="a")
    with pytest.raises(RuntimeError, match="1x1"):
        mjk.VideoRecorder.open(scene, "a.mp4", 1, 1)
    with pytest.raises(TypeError, match=r"a Scene that is built, got SceneSpec\. .*Env\.build\("):
        mjk.Env(mjk.SceneSpec())
    with pytest.raises(
        AttributeError, match=r"a Robot has no 'jnt_pos_cdm'\. Did you mean 'jnt_pos_cmd'\?"
    ):
        robot.jnt_pos_cdm = [0.0] * 7
    with pytest.raises(RuntimeError, match="the object has no name"):
        mjk.scene_object_site_name(mjk.SceneObject(), "top")
    with pytest.raises(RuntimeError, match="site is empty"):
        mjk.scene_object_site_name(mjk.SceneObject(name="table"), "")


def test_an_env_is_closed_at_the_end_of_its_block():
    with mjk.Env.build(base_spec()) as env:
        env.step()
    with pytest.raises(RuntimeError, match="is closed"):
        env.step()


def test_misspelt_argument_errors_suggest_the_nearest_name(scene: mjk.Scene):
    for call, message in (
        (
            lambda: mjk.Robot.from_scene(scene, "base_link", "bracelet_link", prefx="r2_"),
            r"^Robot\.from_scene\(\): no argument 'prefx'\. Its arguments: scene, base_body, "
            r"tip_body, prefix, tool\. Did you mean 'prefix'\?$",
        ),
        (lambda: mjk.Robot.of(scene, nmae="a"), r"Robot\.of\(\): .*mean 'name'\?"),
        (lambda: mjk.SceneObject(nmae="cube"), r"SceneObject.*'nmae'.*mean 'name'\?"),
        (lambda: mjk.RobotSpec(prefx="r2_"), r"RobotSpec.*'prefx'.*mean 'prefix'\?"),
        (
            lambda: mjk.Env(scene).create_robot("base_link", "bracelet_link", tol=None),
            r"Env\.create_robot\(\): no argument 'tol'.*mean 'tool'\?",
        ),
        (lambda: mjk.Env.build(spce=None), r"Env\.build\(\): .*mean 'spec'\?"),
        (
            lambda: mjk.VideoRecorder.open_preset(scene, "a.mp4", resolutoin=None),
            r"VideoRecorder\.open_preset\(\): .*mean 'resolution'\?",
        ),
        (
            lambda: mjk.VideoRecorder(),
            r"To begin a video: VideoRecorder\.open\(env, 'video\.mp4'\)",
        ),
        (
            lambda: mjk.VideoRecorder(3),
            r"takes a robocell\.render\.VideoRecorder, got int\. To begin",
        ),
        (lambda: mjk.menagerie.model_path(nam="a"), r"model_path\(\): .*mean 'name'\?"),
    ):
        with pytest.raises(TypeError, match=message):
            call()
    with pytest.raises(AttributeError, match=r"has no 'Scnee'\. Did you mean 'Scene'\?"):
        mjk.Scnee  # noqa: B018


def test_a_wrist_force_torque_sensor():
    ft_sensor = mjk.AttachmentSpec()
    ft_sensor.mjcf_path = mjk.menagerie.asset_path("ft_sensor.xml")
    ft_sensor.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "pinch_site")
    gripper = mjk.AttachmentSpec()
    gripper.mjcf_path = mjk.menagerie.asset_path("robotiq_2f85/2f85.xml")
    gripper.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "wrist_ft_site")
    gripper.prefix = "g_"
    robot_spec = mjk.RobotSpec()
    robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
    robot_spec.attachments = [ft_sensor, gripper]
    spec = base_spec()
    spec.robots = [robot_spec]
    scene = mjk.Scene.build(spec)

    tool = mjk.ToolFrameSpec()
    tool.tool_body = "g_base"
    tool.tcp_site = "g_pinch"
    ft = mjk.ForceTorqueSensorSpec()
    ft.name = "wrist_ft"  # resolves wrist_ft_force + wrist_ft_torque
    ft.frame_site = "wrist_ft_site"
    tool.ft_sensors = [ft]
    robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link", tool=tool)
    for _ in range(1000):  # until it hangs still
        robot.update()
        robot.step()
    robot.update()
    wrench = robot.ft_sensor("wrist_ft")
    assert PyKDL.Equal(robot.ft_sensor_frame("wrist_ft"), scene.site_frame("wrist_ft_site"), 1e-9)
    assert isinstance(wrench, PyKDL.Wrench)
    weight = 9.81 * scene.model.body_subtreemass[scene.model.body("g_base_mount").id]
    assert wrench.force.Norm() == pytest.approx(weight, rel=0.01)


def test_attach_mjcf_bodies(scene: mjk.Scene):
    robot_spec = with_gripper()
    gripper = robot_spec.attachments[0]
    gripper.pos[2] = 0.005
    gripper.euler[2] = 15.0
    spec = base_spec()
    spec.robots = [robot_spec]
    moved = mjk.Scene.build(spec)
    before, after = scene.site_frame("g_pinch"), moved.site_frame("g_pinch")
    difference = before.Inverse() * after
    assert list(difference.p) == pytest.approx([0, 0, 0.005], abs=1e-9)
    assert difference.M.GetRPY() == pytest.approx((0, 0, np.radians(15)), abs=1e-9)


def test_multi_robot_scene():
    left = mjk.RobotSpec()
    left.path = mjk.menagerie.model_path("kinova_gen3")
    left.pos = [-0.5, 0.0, 0.0]
    right = mjk.RobotSpec()
    right.path = mjk.menagerie.model_path("kinova_gen3")
    right.prefix = "r2_"
    right.pos = [0.5, 0.0, 0.0]
    spec = base_spec()
    spec.robots = [left, right]
    scene = mjk.Scene.build(spec)
    robot1 = mjk.Robot.from_scene(scene, "base_link", "bracelet_link")
    robot2 = mjk.Robot.from_scene(scene, "base_link", "bracelet_link", prefix="r2_")
    assert not set(robot1.joint_names) & set(robot2.joint_names)
    assert scene.body_frame("r2_base_link").p.x() == pytest.approx(0.5)


def red_cube() -> mjk.SceneObject:
    cube = mjk.SceneObject()
    cube.name = "red_cube"
    cube.shape = mjk.Shape.BOX
    cube.size = [0.03, 0.03, 0.03]
    cube.pos = [0.35, 0.10, 0.73]
    cube.rgba = [1.0, 0.0, 0.0, 1.0]
    cube.mass = 0.1
    cube.condim = mjk.Condim.Torsional
    cube.friction = [0.8, 0.02, 0.001]
    return cube


def table_scene() -> mjk.Scene:
    spec = base_spec()
    table = mjk.SceneObject()
    table.name = "table"
    table.mjcf_path = "assets/table.xml"
    table.pos = [0.0, 0.0, 0.7]
    table.fixed = True
    mount = mjk.scene_object_site_name(table, "table_top")
    robot_spec = mjk.RobotSpec()
    robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
    robot_spec.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, mount)
    spec.objects = [table, red_cube()]
    spec.robots = [robot_spec]
    return mjk.Scene.build(spec)


def test_table_and_scene_objects():
    scene = table_scene()
    assert scene.body_frame("base_link").p.z() == pytest.approx(0.7)
    assert scene.model.geom("red_cube_geom").condim[0] == 4
    scene.step_n(200)
    assert scene.body_frame("red_cube").p.z() == pytest.approx(0.73, abs=2e-3)


@pytest.mark.parametrize("model_first", [True, False])
def test_a_model_file_takes_precedence_over_a_primitive(model_first: bool):
    mug = mjk.SceneObject()
    mug.name = "mug"
    model = mjk.menagerie.asset_path("mug.xml")
    if model_first:
        mug.mjcf_path = model
        with pytest.warns(
            UserWarning, match=f"object 'mug': shape ignored, for its model '{model}'"
        ):
            mug.shape = mjk.Shape.BOX
        mug.size, mug.mass = [1, 1, 1], 50  # told once
    else:
        mug.shape, mug.size, mug.mass = mjk.Shape.BOX, [1, 1, 1], 50
        with pytest.warns(UserWarning, match="object 'mug': shape, size, mass ignored"):
            mug.mjcf_path = model
    alone = mjk.SceneObject(name="alone", mjcf_path=model, pos=[1, 0, 0])
    with pytest.warns(UserWarning, match="object 'named': mass ignored"):
        named = mjk.SceneObject(name="named", mjcf_path=model, pos=[2, 0, 0], mass=50)
    spec = base_spec()
    spec.objects = [mug, alone, named]
    assert spec.objects[0] is mug
    scene = mjk.Scene.build(spec)
    masses = [scene.model.body(f"{name}_mug").mass[0] for name in ("mug", "alone", "named")]
    assert masses[0] == masses[1] == masses[2] < 50
    mug.mjcf_path = ""
    mug.shape, mug.size = mjk.Shape.BOX, [0.01, 0.01, 0.01]
    assert list(mug.size) == [0.01] * 3, "a primitive again"


def test_cameras_actuators_and_poses():
    spec = base_spec()
    spec.robots = [with_gripper()]
    cam = mjk.CameraSpec()
    cam.name = "overview"
    cam.pos = [1.8, -2.0, 1.4]
    cam.fovy = 45.0
    spec.cameras = [cam]
    scene = mjk.Scene.build(spec)
    assert "overview" in scene.camera_names()
    tcp = scene.site_frame("g_pinch")
    assert isinstance(tcp, PyKDL.Frame)
    assert not scene.has_actuator("finger")
    if scene.has_actuator("g_fingers_actuator"):
        scene.set_actuator_ctrl("g_fingers_actuator", 0.25)
        assert scene.actuator_ctrl("g_fingers_actuator") == 0.25
    scene = table_scene()
    scene.set_body_pose("red_cube", [0.45, 0.0, 0.75], [0.0, 0.0, 0.0, 1.0])
    assert list(scene.body_frame("red_cube").p) == pytest.approx([0.45, 0, 0.75])
    there = PyKDL.Frame(PyKDL.Rotation.RPY(0.1, 0.2, 0.3), PyKDL.Vector(0.4, 0.1, 0.8))
    scene.set_body_pose("red_cube", there)
    assert PyKDL.Equal(scene.body_frame("red_cube"), there, 1e-9)
    with pytest.raises(ValueError, match="quat: the pose has its rotation; leave quat out"):
        scene.set_body_pose("red_cube", there, [0, 0, 0, 1])


def test_pykdl_interop(robot: mjk.Robot):
    chain = robot.kdl_chain()
    fk = PyKDL.ChainFkSolverPos_recursive(chain)
    q = PyKDL.JntArray(robot.n_joints)
    for i, value in enumerate(robot.jnt_pos_msr):
        q[i] = value
    tcp = PyKDL.Frame()
    fk.JntToCart(q, tcp)
    frame = robot.fk_frame(q)
    assert PyKDL.Equal(tcp, frame, 1e-9)
    robot.set_joint_pos(q)


def test_control_loop(robot: mjk.Robot):
    robot.ctrl_mode = mjk.CtrlMode.TORQUE
    robot.set_joint_pos([0.0, 0.26, 3.14, -2.27, 0.0, 0.96, 1.57])
    start = np.array(robot.tcp_in_world.translation)
    farthest = []
    while robot.step() and len(farthest) < 500:
        robot.update()
        robot.jnt_trq_cmd = robot.gravity_torques()
        farthest.append(np.linalg.norm(robot.tcp_in_world.translation - start))
    assert len(farthest) == 500
    assert max(farthest) < 1e-3
    robot.set_joint_pos([0.0] * robot.n_joints)
    assert robot.fk_frame() is not None


def test_reset():
    spec = base_spec()
    spec.robots = [with_gripper()]
    spec.objects = [red_cube()]
    env = mjk.Env.build(spec)
    robot = env.create_robot("base_link", "bracelet_link")
    seen = []

    def on_reset(ctx: mjk.ResetContext) -> None:
        seen.append((ctx.options.keyframe, ctx.info.used_keyframe))
        robot.set_joint_pos([0.0] * robot.n_joints, call_forward=False)

    env.on_reset = on_reset
    opts = mjk.ResetOptions()
    opts.keyframe = 0
    info = env.reset(opts)
    assert (info.used_keyframe, info.keyframe, seen) == (True, 0, [(0, True)])
    assert list(robot.jnt_pos_cmd) == [0.0] * 7
    opts.use_keyframe = False
    assert not env.reset(opts).used_keyframe
    env.on_reset = None
    env.reset()
    assert len(seen) == 2
    assert any(robot.jnt_pos_cmd), "the keyframe's pose"
    env.set_actuator_ctrl("g_fingers_actuator", 0.25)
    frame = env.body_frame("red_cube")
    assert isinstance(frame, PyKDL.Frame)
    assert list(frame.p) == pytest.approx([0.35, 0.10, 0.73])
    env.save_xml("episode_start.xml")
    assert mujoco.MjModel.from_xml_path("episode_start.xml").nq == env.model.nq
    env.close()
    with pytest.raises(RuntimeError, match="is closed"):
        robot.update()


def test_runtime_add_and_remove_objects(scene: mjk.Scene, robot: mjk.Robot):
    cube = mjk.SceneObject()
    cube.name = "cube"
    cube.shape = mjk.Shape.BOX
    cube.size = [0.02, 0.02, 0.02]
    cube.pos = [0.4, 0.0, 0.02]
    cube.rgba = [1.0, 0.5, 0.0, 1.0]
    cube.mass = 0.1
    cube.friction = [0.8, 0.02, 0.001]
    q = list(robot.jnt_pos_msr)
    scene.add_object(cube)
    robot.update()
    assert list(robot.jnt_pos_msr) == q
    assert "cube" in scene.body_names()
    scene.remove_object("cube")
    assert "cube" not in scene.body_names()
    robot.update()
    env = mjk.Env(scene)
    env.add_object(cube)
    env.remove_object("cube")
    env.close()
    with pytest.raises(RuntimeError, match="is closed"):
        robot.update()


def test_robots_follow_resets_after_objects_came_and_went():
    spec = base_spec()
    spec.robots = [with_gripper()]
    env = mjk.Env.build(spec)
    robot = env.create_robot("base_link", "bracelet_link")
    pose = [0.0, 0.26, 3.14, -2.27, 0.0, 0.96, 1.57]
    env.on_reset = lambda ctx: robot.set_joint_pos(pose, call_forward=False)
    cube = red_cube()
    cube.pos = [0.4, 0.2, 0.5]
    for change in (lambda: env.add_object(cube), lambda: env.remove_object("red_cube")):
        change()
        robot.jnt_pos_cmd = [0.0] * 7
        for _ in range(20):
            robot.update()
            robot.step()
        env.reset()
        if "red_cube" in env.body_names():
            assert list(env.body_frame("red_cube").p) == pytest.approx([0.4, 0.2, 0.5])
        assert list(robot.jnt_pos_cmd) == pose
        for _ in range(200):
            robot.update()
            np.testing.assert_allclose(robot.jnt_pos_msr, pose, atol=0.02)
            robot.step()


def test_headless_video_recording(robot: mjk.Robot):
    recorder = mjk.VideoRecorder.open_preset(
        robot.scene,
        "sim.mp4",
        mjk.VideoResolution.R720p,
        fps=60,
    )
    recorder.set_free_camera(2.5, 135.0, -20.0, (0.0, 0.0, 0.7))
    for _ in range(5):
        robot.update()
        robot.step()
        assert recorder.record_frame()
    assert not recorder.use_camera("no such camera")
    assert recorder.use_camera("")
    assert recorder.record_frame()
    with pytest.raises(AttributeError, match="a VideoRecorder has no 'frame_rate'"):
        recorder.frame_rate = 3
    recorder.close()
    recorder.close()
    assert recorder.frames == 6
    video = recording.probe(Path("sim.mp4"))
    assert (video["width"], video["height"], video["nb_read_frames"]) == ("1280", "720", "6")
    assert video["avg_frame_rate"] == "60/1"


def test_the_cameras_of_a_recorder():
    spec = base_spec()
    spec.robots = [with_gripper()]
    spec.cameras = [mjk.CameraSpec(name="overview", pos=[1.8, -2.0, 1.4], fovy=45.0)]
    recorder = mjk.VideoRecorder.open(mjk.Scene.build(spec), "cameras.mp4", 64, 48, 30)
    names = recorder.camera_names()
    assert names == ["Current", "Free", "Tracking", "wrist", "overview"]
    assert recorder.use_camera("overview") is True
    assert recorder.use_camera("overwiev") is False
    with pytest.raises(RuntimeError, match=r"nothing to follow yet; .*set_tracking_camera"):
        recorder.use_camera("Tracking")
    recorder.set_tracking_camera("bracelet_link")
    for name in names:
        assert recorder.use_camera(name) is True
        assert recorder.record_frame()
    recorder.close()
    assert recording.probe(Path("cameras.mp4"))["nb_read_frames"] == "5"


def test_a_recorder_accepts_an_env_and_rounds_odd_sizes_down(scene: mjk.Scene):
    recorder = mjk.VideoRecorder.open(mjk.Env(scene), "odd.mp4", 65, 49, 30)
    recorder.record_frame()
    recorder.close()
    assert [recording.probe(Path("odd.mp4"))[side] for side in ("width", "height")] == ["64", "48"]
