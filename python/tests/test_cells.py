"""Cells put together from Python: tools, several robots, objects, cameras, actuators, reset."""

import mujoco
import numpy as np
import pytest

import robocell as rc

PROBE = """<mujoco model="probe"><worldbody><body name="needle" pos="0 0 0.01" quat="0 1 0 0">
<geom size="0.005" mass="0.01"/><site name="tip" pos="0 0 0.03"/></body></worldbody></mujoco>"""
TABLE = """<mujoco model="table"><worldbody><body name="frame" pos="0 0 0.35">
<geom type="box" size="0.4 0.3 0.35"/><site name="table_top" pos="0 0 0.35"/>
<frame name="corner" pos="0.3 0.2 0.35"/></body></worldbody></mujoco>"""


def cube(name: str = "cube", **fields: object) -> rc.SceneObject:
    numbers: dict[str, object] = {
        "shape": rc.Shape.BOX, "size": [0.03] * 3, "rgba": [1, 0, 0, 1], "mass": 0.1,
        "friction": [0.8, 0.02, 0.001],
    }  # fmt: skip
    return rc.SceneObject(name=name, **(numbers | fields))


def empty(**fields: object) -> rc.SceneSpec:
    return rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True, **fields)


def rc7(**fields: object) -> rc.RobotSpec:
    return rc.RobotSpec(config=rc.RobotConfig.load(rc.models.robot_file("rc7")), **fields)


def bare_rc7(**fields: object) -> rc.RobotSpec:
    """The model of the built-in robot without its configuration."""
    return rc.RobotSpec(path=rc.models.robot_file("rc7").replace(".yaml", ".xml"), **fields)


@pytest.fixture
def probe(tmp_path) -> str:
    (tmp_path / "probe.xml").write_text(PROBE)
    return str(tmp_path / "probe.xml")


@pytest.fixture
def table(tmp_path) -> rc.SceneObject:
    (tmp_path / "table.xml").write_text(TABLE)
    return rc.SceneObject(name="table", mjcf_path=tmp_path / "table.xml", fixed=True)


AUTHORED = rc.Pose(translation=[0, 0, 0.01], quaternion=[1, 0, 0, 0])  # of the needle in its file


class TestScenes:
    def test_a_spec_can_be_built_again_with_other_contents(self):
        spec = empty(robots=[bare_rc7()])
        assert len(rc.Scene.build(spec).body_names()) > 8
        spec.objects = [rc.SceneObject(name="mug", mjcf_path="mug", fixed=True)]
        scene = rc.Scene.build(spec)
        assert {"base_link", "mug_mug"} <= set(scene.body_names())
        spec.robots = []
        scene = rc.Scene.build(spec)
        assert "mug_mug" in scene.body_names()
        assert "base_link" not in scene.body_names()
        assert scene.model.nq == 0

    @pytest.mark.parametrize("field", ["timestep", "add_floor", "add_skybox"])
    def test_choices_must_be_made(self, field):
        spec = empty()
        setattr(spec, field, None)
        with pytest.raises(rc.SpecError, match=field):
            rc.Scene.build(spec)
        spec = empty()
        spec.timestep = 0
        with pytest.raises(rc.SpecError, match="timestep"):
            rc.Scene.build(spec)

    def test_saved_files_keep_parts_of_several_folders_after_other_builds(
        self, probe, tmp_path, menagerie
    ):
        arm = rc.RobotSpec(path=rc.menagerie.model_path("kinova_gen3"))
        arm.attachments.append(
            rc.robots.AttachmentSpec(mjcf_path=probe, attach_to={"site": "pinch_site"}, prefix="p_")
        )
        scene = rc.Scene.build(empty(robots=[arm]))
        rc.Scene.build(empty(objects=[cube()]))
        scene.save_xml(tmp_path / "saved.xml")
        scene.save_binary(tmp_path / "saved.mjb")
        for model in (
            mujoco.MjModel.from_xml_path(str(tmp_path / "saved.xml")),
            mujoco.MjModel.from_binary_path(str(tmp_path / "saved.mjb")),
        ):
            for size in ("nq", "nv", "nu", "nbody", "nmesh"):
                assert getattr(model, size) == getattr(scene.model, size)


class TestAttachments:
    @pytest.mark.parametrize("kind", ["body", "site"])
    def test_tools_hang_on_bodies_and_sites_with_their_authored_pose(self, probe, kind):
        target = rc.robots.AttachTarget(
            rc.robots.AttachKind.Site if kind == "site" else rc.robots.AttachKind.Body,
            "attachment_site" if kind == "site" else "link7",
        )
        tool = rc.robots.AttachmentSpec(mjcf_path=probe, attach_to=target, prefix="p_")
        scene = rc.Scene.build(empty(robots=[bare_rc7(attachments=[tool])]))
        of = scene.site_pose if kind == "site" else scene.body_pose
        expected = of(target.name) * AUTHORED
        assert scene.body_pose("p_needle").is_close(expected, 1e-9, 1e-9)

    def test_tools_hang_on_frames(self, probe, tmp_path):
        (tmp_path / "hand.xml").write_text(
            '<mujoco><worldbody><body name="hand"><geom size="0.1"/>'
            '<frame name="mount" pos="0.1 0.2 0.3" euler="0 0 90"/></body></worldbody></mujoco>'
        )
        on_frame = rc.robots.AttachmentSpec(
            mjcf_path=probe,
            attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Frame, "mount"),
            prefix="p_",
        )
        arm = rc.RobotSpec(path=tmp_path / "hand.xml", attachments=[on_frame], pos=[0, 0, 1])
        scene = rc.Scene.build(empty(robots=[arm]))
        mount = rc.Pose(translation=[0.1, 0.2, 0.3], rpy=[0, 0, np.pi / 2])
        expected = scene.body_pose("hand") * mount * AUTHORED
        assert scene.body_pose("p_needle").is_close(expected, 1e-9, 1e-9)

    def test_edits_in_place_move_the_tool(self, probe):
        spec = empty(robots=[bare_rc7()])
        tool = rc.robots.AttachmentSpec(
            mjcf_path=probe, attach_to={"site": "attachment_site"}, prefix="p_"
        )
        spec.robots[0].attachments.append(tool)
        before = rc.Scene.build(spec).body_pose("p_needle")
        tool.pos[2] = 0.005
        tool.euler[2] = 15.0
        scene = rc.Scene.build(spec)
        offset = rc.Pose(translation=[0, 0, 0.005], rpy=[0, 0, np.deg2rad(15)])
        expected = scene.site_pose("attachment_site") * offset * AUTHORED
        assert scene.body_pose("p_needle").is_close(expected, 1e-9, 1e-9)
        moved = before.inverse() * scene.body_pose("p_needle")
        assert np.linalg.norm(moved.translation) == pytest.approx(0.005, abs=1e-9)
        assert moved.angle == pytest.approx(np.deg2rad(15), abs=1e-9)

    def test_euler_angles_are_degrees_about_fixed_axes(self, probe):
        tool = rc.robots.AttachmentSpec(mjcf_path=probe, attach_to={"body": "link7"}, prefix="p_")
        tool.euler = [10, 20, 30]
        scene = rc.Scene.build(empty(robots=[bare_rc7(attachments=[tool])]))
        turn = rc.Pose(rpy=np.deg2rad([10, 20, 30]))
        expected = scene.body_pose("link7") * turn * AUTHORED
        assert scene.body_pose("p_needle").is_close(expected, 1e-9, 1e-9)

    def test_a_chain_of_four_tools(self, probe):
        robot = bare_rc7()
        site = "attachment_site"
        for i in range(4):
            prefix = f"t{i}_"
            robot.attachments.append(
                rc.robots.AttachmentSpec(mjcf_path=probe, attach_to={"site": site}, prefix=prefix)
            )
            site = f"{prefix}tip"
        scene = rc.Scene.build(empty(robots=[robot]))
        step = AUTHORED * rc.Pose(translation=[0, 0, 0.03])
        expected = scene.site_pose("attachment_site") * step * step * step * step
        assert scene.site_pose("t3_tip").is_close(expected, 1e-9, 1e-9)

    def test_relative_paths_start_in_the_working_folder(self, probe, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        tool = rc.robots.AttachmentSpec(
            mjcf_path="probe.xml", attach_to={"body": "link7"}, prefix="p_"
        )
        scene = rc.Scene.build(empty(robots=[bare_rc7(attachments=[tool])]))
        assert "p_needle" in scene.body_names()


class TestRobots:
    def test_the_same_robot_twice_is_independent(self):
        left, right = bare_rc7(pos=[-0.5, 0, 0]), bare_rc7(prefix="r2_", pos=[0.5, 0, 0])
        scene = rc.Scene.build(empty(robots=[left, right]))
        robots = [rc.Robot.from_scene(scene, "base_link", "link7", prefix=p) for p in ("", "r2_")]
        assert robots[1].joint_names == [f"r2_{name}" for name in robots[0].joint_names]
        assert robots[0].base_in_world.translation.tolist() == [-0.5, 0, 0]
        assert robots[1].base_in_world.translation.tolist() == [0.5, 0, 0]
        start = scene.state()
        ends = []
        for command in (0.0, 0.3):
            scene.set_state(start)
            robots[0].jnt_pos_cmd[0] = command
            for _ in range(500):
                for robot in robots:
                    robot.update()
                scene.step()
            assert robots[0].arm.joint_pos[0] == pytest.approx(command, abs=5e-3)
            ends.append(robots[1].arm.joint_pos)
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


class TestObjects:
    def test_a_robot_can_be_mounted_on_a_table(self, table):
        mount = rc.scene.scene_object_element_name("table", "table_top")
        assert mount == "table_table_top"
        robot = bare_rc7(
            attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Site, mount), pos=[0, 0.1, 0]
        )
        on_top = cube("can", attach_to={"site": mount}, fixed=True, pos=[0.1, 0, 0.03])
        scene = rc.Scene.build(empty(robots=[robot], objects=[table, on_top]))
        np.testing.assert_allclose(scene.body_pose("base_link").translation, [0, 0.1, 0.7])
        np.testing.assert_allclose(scene.body_pose("can").translation, [0.1, 0, 0.73])

    def test_objects_can_be_attached_to_frames(self, table):
        on_frame = cube("can", attach_to={"frame": "table_corner"}, fixed=True)
        scene = rc.Scene.build(empty(objects=[table, on_frame]))
        np.testing.assert_allclose(scene.body_pose("can").translation, [0.3, 0.2, 0.7])

    def test_rejects_attaching_to_a_later_object(self, table):
        mount = rc.scene.scene_object_element_name("table", "table_top")
        can = cube("can", attach_to={"site": mount}, fixed=True)
        with pytest.raises(rc.SpecError, match=r"object 'can'.*object 'table'"):
            rc.Scene.build(empty(objects=[can, table]))

    def test_a_box_falls_and_rests(self):
        box = cube("red_cube", pos=[0.35, 0.1, 0.3], condim=rc.scene.Condim.TORSIONAL)
        scene = rc.Scene.build(empty(objects=[box]))
        geom = scene.model.geom("red_cube_geom")
        assert geom.condim[0] == 4
        assert geom.friction.tolist() == [0.8, 0.02, 0.001]
        assert scene.step_n(500)
        np.testing.assert_allclose(
            scene.body_pose("red_cube").translation, [0.35, 0.1, 0.03], atol=1e-3
        )

    @pytest.mark.parametrize("field", ["shape", "size", "rgba", "mass", "friction"])
    def test_a_primitive_needs_all_its_numbers(self, field):
        with pytest.raises(rc.SpecError, match=field):
            rc.Scene.build(empty(objects=[cube(**{field: None})]))

    def test_a_free_object_must_be_attached_to_the_world(self, table):
        mount = rc.scene.scene_object_element_name("table", "table_top")
        loose = cube("can", attach_to={"site": mount})
        with pytest.raises(rc.SpecError, match=r"'can': can move freely.*or set fixed: true"):
            rc.Scene.build(empty(objects=[table, loose]))


class TestCamerasActuatorsPoses:
    def test_cameras_need_a_place_and_a_lens(self):
        camera = rc.render.CameraSpec(name="overview")
        with pytest.raises(rc.SpecError) as error:
            rc.Scene.build(empty(cameras=[camera]))
        assert "pos" in str(error.value)
        assert "fovy" in str(error.value)
        camera.pos, camera.fovy = [1.8, -2.0, 1.4], 45.0
        scene = rc.Scene.build(empty(cameras=[camera], robots=[rc7(prefix="r_")]))
        assert {"overview", "r_wrist_camera"} <= set(scene.camera_names())
        assert scene.model.camera("overview").fovy[0] == 45
        np.testing.assert_allclose(scene.camera_pose("overview").translation, [1.8, -2.0, 1.4])

    def test_a_teleported_body_has_zero_velocity(self):
        scene = rc.Scene.build(empty(objects=[cube("red_cube", pos=[0, 0, 1])]))
        scene.step_n(50)
        assert np.abs(scene.data.qvel).max() > 0.5
        scene.set_body_pose("red_cube", [0.45, 0.0, 0.75], [0.0, 0.0, 0.0, 1.0])
        assert scene.body_pose("red_cube") == rc.Pose(translation=[0.45, 0, 0.75])
        assert not scene.data.qvel.any()
        with pytest.raises(rc.ArgumentError, match="body 'world' cannot be moved by its pose"):
            scene.set_body_pose("world", [0, 0, 0])

    def test_actuators_by_name(self):
        scene = rc.Scene.build(empty(robots=[rc7()]))
        assert scene.has_actuator("gripper")
        assert not scene.has_actuator("finger")
        scene.set_actuator_ctrl("gripper", 25.0)
        assert scene.actuator_ctrl("gripper") == 25.0
        with pytest.raises(rc.NotFoundError, match=r"no actuator 'griper'.*mean 'gripper'"):
            scene.actuator_ctrl("griper")

    def test_joints_by_name(self):
        scene = rc.Scene.build(empty(robots=[rc7()], objects=[cube()]))
        scene.data.joint("joint2").qpos[0] = 0.375
        assert scene.joint_pos("joint2") == 0.375
        with pytest.raises(rc.ArgumentError, match=r"is free.*body_pose\("):
            scene.joint_pos("cube_joint")


class TestReset:
    def test_options_and_info_have_readable_text(self):
        scene = rc.Scene.build(empty(robots=[rc7()]))
        told = []
        scene.on_reset(lambda context: told.append(f"{context.options} {context.info}"))
        scene.reset(rc.scene.ResetOptions(seed=3))
        assert told == [
            "ResetOptions(keyframe=None, use_keyframe=True, seed=3) "
            "ResetInfo(used_keyframe=True, keyframe=0)"
        ]

    def test_a_robot_holds_the_pose_that_the_hook_leaves(self):
        scene = rc.Scene.build(empty(robots=[rc7(name="a")]))
        robot = scene.robot("a")
        q = [0.3, 0.2, -0.1, 1.2, 0.4, 0.5, -1.0]
        order = []

        def on_reset(reset: rc.scene.ResetContext) -> None:
            order.append((reset.info.used_keyframe, reset.options.keyframe))
            robot.set_joint_pos(q, call_forward=False)

        scene.on_reset(on_reset)
        robot.jnt_pos_cmd = np.zeros(7)
        scene.set_body_wrench("link7", [100, 0, 0], [0, 0, 0])
        info = scene.reset(rc.scene.ResetOptions(keyframe=0))
        assert (info.used_keyframe, info.keyframe) == (True, 0)
        assert order == [(True, 0)]
        assert robot.jnt_pos_cmd.tolist() == q
        assert not scene.data.xfrc_applied.any()
        for _ in range(200):
            robot.update()
            robot.step()
        np.testing.assert_allclose(robot.arm.joint_pos, q, atol=1e-4)

    def test_a_hook_that_raises_leaves_a_reset_without_hooks(self):
        scene = rc.Scene.build(empty(robots=[rc7(name="a")], objects=[cube(pos=[0.5, 0, 0.03])]))
        robot = scene.robot("a")
        scene.reset(seed=4)
        home, state = robot.jnt_pos_cmd, scene.state()

        def on_reset(reset: rc.scene.ResetContext) -> None:
            robot.set_joint_pos(np.full(7, 0.5), call_forward=False)
            scene.set_body_wrench("cube", [0, 0, 100])
            raise ValueError("no grasp")

        hook = scene.on_reset(on_reset)
        robot.jnt_pos_cmd = np.full(7, -0.5)
        scene.step_n(20)
        with pytest.raises(ValueError, match="no grasp"):
            scene.reset(seed=4)
        np.testing.assert_array_equal(robot.jnt_pos_cmd, home)
        np.testing.assert_array_equal(robot.jnt_pos_msr, home)
        np.testing.assert_array_equal(scene.state(), state)
        robot.update()  # to where it is: nothing jumps, nothing pushes
        scene.step_n(20)
        np.testing.assert_allclose(robot.arm.joint_pos, home, atol=1e-3)
        assert scene.body_pose("cube").translation[2] < 0.031
        scene.remove_reset_hook(hook)
        scene.on_reset(lambda reset: reset.scene.reset())
        with pytest.raises(rc.Error, match=r"'cell': reset\(\) in a reset hook, which would call"):
            scene.reset()
        assert scene.time() == 0

    def test_an_exception_in_a_group_stops_no_other_robot(self):
        class Sulky(rc.robots.MoveGroup):
            sulks = False
            get_name = lambda self: "sulky"  # noqa: E731
            get_joint_names = get_actuator_names = lambda self: ["dimmer"]
            get_joint_vel = get_joint_torque = get_ctrl = lambda self: [0.0]
            get_joint_pos_limits = lambda self: [(0.0, 1.0)]  # noqa: E731
            set_ctrl = ctrl_for_joint_pos = lambda self, values: values

            def get_joint_pos(self) -> list[float]:
                if self.sulks:
                    raise ValueError("I would rather not")
                return [0.0]

        spec = empty(robots=[rc7(name="a", prefix="a_"), rc7(name="b", prefix="b_", pos=[0, 2, 0])])
        scene = rc.Scene.build(spec)
        sulky = Sulky()
        scene.robot("a").set_group(sulky)
        robot, home = scene.robot("b"), scene.robot("b").jnt_pos_cmd.copy()
        robot.jnt_pos_cmd = np.full(7, 0.3)
        scene.set_body_wrench("b_link7", [0, 0, 100])
        sulky.sulks = True
        with pytest.raises(ValueError, match="I would rather not"):
            scene.reset()
        np.testing.assert_array_equal(robot.jnt_pos_cmd, home)
        np.testing.assert_array_equal(robot.jnt_pos_msr, home)
        assert not scene.data.xfrc_applied.any()
        sulky.sulks = False
        scene.reset()

    def test_a_part_without_keyframes_starts_where_its_model_does(self, table):
        lamp = str(table.mjcf_path).replace("table.xml", "lamp.xml")
        hinge = '<body name="lamp"><joint name="hinge" ref="30"/><geom size="0.1"/></body>'
        with open(lamp, "w") as file:
            file.write(f"<mujoco><worldbody>{hinge}</worldbody></mujoco>")
        spec = empty(robots=[rc.RobotSpec(path=lamp)])
        scene = rc.Scene.build(spec)
        assert scene.reset(keyframe=0).used_keyframe
        assert scene.joint_pos("hinge") == pytest.approx(np.pi / 6)
        spec.robots.append(rc7(name="a", prefix="a_", pos=[0, 2, 0]))
        both = rc.Scene.build(spec)
        info = both.reset(rc.scene.ResetOptions(keyframe=0))
        assert (info.used_keyframe, info.keyframe) == (True, 0)
        assert both.joint_pos("hinge") == pytest.approx(np.pi / 6)
        assert both.joint_pos("a_joint4") == pytest.approx(1.9), "the part that has a home is there"
        assert not both.reset(use_keyframe=False).used_keyframe
        assert both.joint_pos("a_joint4") == 0

    def test_resets_to_the_default_configuration_and_rejects_missing_keyframes(self):
        scene = rc.Scene.build(empty(robots=[rc7()]))
        info = scene.reset(rc.scene.ResetOptions(use_keyframe=False))
        assert (info.used_keyframe, info.keyframe) == (False, -1)
        np.testing.assert_array_equal(scene.data.qpos, scene.model.qpos0)
        with pytest.raises(rc.ArgumentError, match="there is no keyframe 3; the scene has 1"):
            scene.reset(keyframe=3)

    def test_keyframes_are_chosen_by_number_by_name_and_by_robot(self, tmp_path):
        path = tmp_path / "arm.xml"
        path.write_text(
            """<mujoco><compiler angle="radian"/><worldbody><body name="base"><geom size="0.05"/>
            <body name="a" pos="0 0 0.2"><joint name="j" axis="0 1 0"/><geom size="0.02"/></body>
            </body></worldbody><actuator><position name="m" joint="j" kp="10" kv="1"/></actuator>
            <keyframe><key name="home" qpos="0.1" ctrl="0.1"/><key name="up" qpos="1" ctrl="1"/>
            </keyframe></mujoco>"""
        )
        spec = empty()
        for name, y in (("left", 0), ("right", 1)):
            spec.robots.append(rc.RobotSpec(path=str(path), prefix=f"{name}_", pos=[0, y, 0]))
        scene = rc.Scene.build(spec)
        assert scene.keyframes() == ["home", "left_up", "right_up"]

        def joints(keyframe: object) -> list[float]:
            scene.reset(keyframe=keyframe)
            return [scene.joint_pos("left_j"), scene.joint_pos("right_j")]

        assert joints(None) == [0.1, 0.1]
        assert joints(1) == [1, 0.1]
        assert joints("right_up") == [0.1, 1]
        assert joints({"left": "up", "right": "up"}) == [1, 1]
        assert scene.model.key("left_up").qpos.tolist() == [1, 0.1]
        options = rc.scene.ResetOptions(keyframe={"right": "up"})
        assert options.keyframe == {"right": "up"}
        scene.reset(options)
        assert scene.joint_pos("right_j") == 1
        with pytest.raises(rc.NotFoundError, match="no keyframe 'u'"):
            scene.reset(keyframe={"left": "u"})
        with pytest.raises(rc.NotFoundError, match="no keyframe 'up'"):
            scene.reset(keyframe="up")

    def test_two_scenes_are_independent(self, tmp_path):
        spec = empty(robots=[rc7(name="a")])
        first, second = rc.Scene.build(spec), rc.Scene.build(spec)
        first.robot("a").ctrl_mode = "torque"
        first.set_actuator_ctrl("gripper", 10)
        first.step_n(50)
        assert second.time() == 0
        assert second.robot("a").ctrl_mode == rc.control.CtrlMode.POSITION
        assert second.actuator_ctrl("gripper") != 10
        first.save_xml(tmp_path / "episode_start.xml")
        assert (
            mujoco.MjModel.from_xml_path(str(tmp_path / "episode_start.xml")).nq == first.model.nq
        )
