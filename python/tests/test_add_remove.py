"""Objects that come and go while a scene runs: handles, state, lifetimes, threads."""

import gc
import threading
import weakref
from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell as rc


def cube(name: str = "cube", **fields: object) -> rc.SceneObject:
    numbers: dict[str, object] = {
        "shape": "box", "size": [0.02] * 3, "rgba": [1, 0, 0, 1], "mass": 0.1,
        "friction": [0.8, 0.02, 0.001], "pos": [0.9, 0.9, 0.02],
    }  # fmt: skip
    return rc.SceneObject(name=name, **(numbers | fields))


@pytest.fixture
def scene() -> rc.Scene:
    robot = rc.RobotSpec(name="a", config=rc.RobotConfig.load(rc.models.robot_file("rc7")))
    spec = rc.SceneSpec(
        name="cell", timestep=0.002, add_floor=True, add_skybox=True, robots=[robot],
        cameras=[rc.render.CameraSpec(name="front", pos=[2, 0, 0.5], fovy=45, look_at=[0, 0, 0.3])],
    )  # fmt: skip
    return rc.Scene.build(spec)


def joint_numbers(scene: rc.Scene) -> dict[str, list[float]]:
    """Position, velocity, control and warm start of everything that has a name."""
    model, data = scene.model, scene.data
    numbers = {"time": [data.time]}
    for i in range(model.njnt):
        joint = data.joint(i)
        numbers[joint.name] = [*joint.qpos, *joint.qvel, *joint.qacc_warmstart]
    for i in range(model.nactuator):
        numbers[data.actuator(i).name] = list(data.actuator(i).ctrl)
    return numbers


class TestState:
    def test_survivors_are_unchanged(self, scene):
        robot = scene.robot("a")
        scene.data.ctrl[:] += 0.1
        scene.step_n(50)
        before, state = joint_numbers(scene), scene.state()
        generation = scene.generation
        scene.add_object(cube())
        after = joint_numbers(scene)
        assert {name: after[name] for name in before} == before
        assert scene.object_names == ["cube"]
        assert scene.generation > generation
        robot.update()
        scene.step_n(100)
        assert scene.body_pose("cube").translation[2] == pytest.approx(0.02, abs=1e-3)
        scene.remove_object("cube")
        assert scene.state().shape == state.shape
        assert scene.object_names == []

    def test_add_then_remove_restores_the_state(self, scene):
        scene.step_n(20)
        state, model = scene.state(), scene.to_xml()
        scene.add_object(cube())
        scene.remove_object("cube")
        np.testing.assert_array_equal(scene.state(), state)
        assert scene.to_xml() == model

    def test_a_failure_changes_nothing(self, scene):
        scene.add_object(cube())
        state, model, data = scene.state(), scene.model, scene.data
        with pytest.raises(rc.ArgumentError, match="there is an object 'cube' already"):
            scene.add_object(cube())
        with pytest.raises(rc.SpecError, match="a primitive needs its mass"):
            scene.add_object(cube("half", mass=None))
        with pytest.raises(rc.NotFoundError, match=r"no object 'cub'.*Did you mean 'cube'"):
            scene.remove_object("cub")
        with pytest.raises(TypeError, match="`object` must be a SceneObject"):
            scene.add_object(3)
        with pytest.raises(TypeError, match="`object` must be a SceneObject"):
            scene.add_object(None)
        np.testing.assert_array_equal(scene.state(), state)
        assert scene.model is model
        assert scene.data is data

    def test_a_frozen_model_keeps_its_objects(self):
        spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False, objects=[cube()])
        compiled = rc.scene.compile_scene(spec)
        compiled.freeze()
        scene = rc.Scene.from_compiled(compiled)
        with pytest.raises(rc.Error, match=r"'other' cannot be added.* frozen .*Scene::Build"):
            scene.add_object(cube("other"))


class TestHandles:
    def test_robots_groups_and_ports_follow(self, scene):
        robot = scene.robot("a")
        arm, port, pose = robot.arm, robot.jnt_pos_cmd, robot.tcp_in_world
        robot.ctrl_mode = "torque"
        robot.jnt_trq_cmd = robot.gravity_torques()
        scene.add_object(cube())
        assert robot.ctrl_mode == rc.control.CtrlMode.TORQUE
        assert robot.tcp_in_world.is_close(pose)
        assert list(robot.jnt_trq_cmd) == list(robot.gravity_torques())
        assert len(arm.joint_pos) == 7
        robot.ctrl_mode = "position"
        start = arm.joint_pos[0]
        robot.jnt_pos_cmd[0] += 0.2
        for _ in range(500):
            robot.update()
            robot.step()
        assert arm.joint_pos[0] == pytest.approx(start + 0.2, abs=0.02)
        scene.remove_object("cube")
        robot.update()
        assert len(port) == 7
        assert scene.robot("a").jnt_pos_cmd[0] == robot.jnt_pos_cmd[0]

    def test_kdl_chains_of_a_robot_stay_right(self, scene):
        robot = scene.robot("a")
        before = robot.kdl_chain().getNrOfJoints()
        scene.add_object(cube())
        assert robot.kdl_chain().getNrOfJoints() == before
        np.testing.assert_array_equal(robot.jnt_pos_msr, robot.arm.joint_pos)

    def test_a_group_written_in_python_follows(self, scene):
        class Watch(rc.robots.MoveGroup):
            get_name = lambda self: "watch"  # noqa: E731
            get_joint_names = get_actuator_names = lambda self: []
            get_joint_pos = get_joint_vel = get_joint_torque = get_ctrl = lambda self: []

        watch = Watch()
        scene.robot("a").set_group(watch)
        scene.add_object(cube())
        scene.robot("a").update()
        assert scene.robot("a").group("watch") is watch

    def test_hooks_and_later_resets(self, scene):
        poses = []
        scene.on_reset(lambda reset: poses.append(reset.scene.body_pose("cube").translation[0]))
        scene.add_object(cube(pos=[0.7, 0, 0.5]))
        scene.step_n(50)
        scene.reset()
        assert poses == [0.7]
        assert scene.body_pose("cube").translation[2] == 0.5
        scene.on_reset(lambda reset: reset.scene.remove_object("cube"))
        scene.reset()
        assert scene.object_names == []

    @pytest.mark.parametrize("configured", [True, False])
    def test_robots_hold_the_pose_of_the_hook_after_later_resets(self, scene, configured: bool):
        robot = scene.robot("a") if configured else rc.Robot.from_scene(scene, "base_link", "link7")
        pose = [0.4, 0.3, -0.2, 1.1, 0.5, -0.6, 0.7]
        scene.on_reset(lambda reset: setattr(robot.arm, "joint_pos", pose))  # commands nothing
        for change in (lambda: scene.add_object(cube()), lambda: scene.remove_object("cube")):
            change()
            robot.jnt_pos_cmd = [0.1] * 7
            for _ in range(20):
                robot.update()
                robot.step()
            scene.reset()
            assert list(robot.jnt_pos_cmd) == pose
            for _ in range(200):
                robot.update()
                np.testing.assert_allclose(robot.jnt_pos_msr, pose, atol=2e-3)
                robot.step()

    def test_pictures_and_videos_follow(self, scene, tmp_path: Path):
        renderer = rc.render.Renderer(scene)
        bare = renderer.render("front", 64, 48, segmentation=True)["segmentation"]
        with rc.render.VideoRecorder(scene, tmp_path / "cell.mp4", 64, 48, 30) as video:
            video.use_camera("front")
            video.record_frame()
            scene.add_object(cube("big", size=[0.3] * 3, pos=[1, 0, 0.3]))
            video.record_frame()
            scene.remove_object("big")
            scene.add_object(cube("big", size=[0.3] * 3, pos=[1, 0, 0.3]))
            seen = renderer.render("front", 64, 48, segmentation=True)["segmentation"]
            assert (seen == scene.model.body("big").id).sum() > 500
            scene.remove_object("big")
            video.record_frame()
        np.testing.assert_array_equal(
            renderer.render("front", 64, 48, segmentation=True)["segmentation"], bare
        )
        assert video.frames == 3
        assert (tmp_path / "cell.mp4").stat().st_size > 0


class TestLifetimes:
    def test_kept_model_and_data_are_the_old_ones(self, scene):
        scene.step_n(5)
        model, data = scene.model, scene.data
        scene.add_object(cube())
        gc.collect()
        assert scene.data is not data
        assert scene.data.model is scene.model is not model
        assert data.time == pytest.approx(0.01)
        mujoco.mj_step(model, data)
        assert data.time == pytest.approx(0.012)
        assert scene.time() == pytest.approx(0.01)
        scene.data.qpos[:] = scene.data.qpos
        mujoco.mj_step(scene.model, scene.data)
        assert scene.time() == pytest.approx(0.012)

    def test_the_old_model_and_data_are_freed_unless_kept(self, scene):
        data, model = weakref.ref(scene.data), weakref.ref(scene.model)
        scene.add_object(cube())
        scene.time()
        gc.collect()
        assert data() is None
        assert model() is None

    def test_views_of_the_old_data_stay_readable(self, scene):
        qpos = scene.data.qpos
        before = qpos.copy()
        scene.add_object(cube())
        scene.step_n(10)
        gc.collect()
        np.testing.assert_array_equal(qpos, before)

    def test_another_thread_can_add_during_a_wait(self, scene):
        data = weakref.ref(scene.data)
        failed: list[BaseException] = []

        def work() -> None:
            try:
                for _ in range(3):
                    scene.add_object(cube())
                    scene.step_n(5)
                    scene.remove_object("cube")
            except BaseException as error:
                failed.append(error)

        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
        assert failed == []
        gc.collect()
        assert data() is None
        assert scene.robot("a").n_joints == 7

    def test_an_error_in_a_group_undoes_the_change(self, scene):
        class Sulky(rc.robots.MoveGroup):
            sulks = False
            get_name = lambda self: "arm"  # noqa: E731
            get_joint_names = lambda self: [f"joint{i}" for i in range(1, 8)]  # noqa: E731
            get_actuator_names = lambda self: []  # noqa: E731
            get_kind = lambda self: "arm"  # noqa: E731
            get_joint_vel = get_joint_torque = lambda self: [0] * 7
            get_ctrl = lambda self: []  # noqa: E731

            def get_joint_pos(self) -> list[float]:
                if self.sulks:
                    raise RuntimeError("I would rather not")
                return [0.0] * 7

        arm = Sulky()
        scene.robot("a").set_group(arm)
        data = scene.data
        arm.sulks = True
        with pytest.raises(RuntimeError, match="I would rather not"):
            scene.add_object(cube())
        arm.sulks = False
        assert scene.data is data
        assert scene.object_names == []
        scene.add_object(cube())


class TestPool:
    @pytest.fixture
    def pool(self) -> rc.Scene:
        spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
        spec.objects = [cube("there"), *(cube(f"pool{i}", parked=True) for i in range(3))]
        return rc.Scene.build(spec)

    def test_pooled_objects_are_added_and_removed_by_name(self, pool):
        model, data, generation = pool.model, pool.data, pool.generation
        assert pool.object_names == ["there"]
        assert pool.parked_objects == ["pool0", "pool1", "pool2"]
        pool.add_object("pool1", [0.3, 0.2, 0.02], [0, 0, 0, 1])
        pool.add_object("pool2", rc.Pose(translation=[0.3, -0.2, 0.02]))
        pool.add_object(cube("pool0", pos=[0.3, 0, 0.02]))
        pool.step_n(100)
        for i, y in enumerate([0, 0.2, -0.2]):
            np.testing.assert_allclose(
                pool.body_pose(f"pool{i}").translation, [0.3, y, 0.02], atol=1e-3
            )
        pool.remove_object("pool1")
        assert pool.object_names == ["there", "pool0", "pool2"]
        assert pool.contacts("pool1") == []
        assert (pool.model, pool.data, pool.generation) == (model, data, generation)

    def test_a_reset_restores_the_pool_and_hooks_choose_objects(self, pool):
        pool.add_object("pool0")
        pool.reset()
        assert pool.parked_objects == ["pool0", "pool1", "pool2"]
        pool.on_reset(lambda reset: reset.scene.add_object("pool2", [0.5, 0, 0.02]))
        pool.reset()
        assert pool.object_names == ["there", "pool2"]

    def test_a_state_restores_the_objects_in_the_scene(self, pool):
        before = pool.state()
        pool.add_object("pool0")
        there = pool.state()
        pool.set_state(before)
        assert pool.object_names == ["there"]
        pool.set_state(there)
        assert pool.object_names == ["there", "pool0"]

    def test_errors_explain_rejected_pool_changes(self, pool):
        with pytest.raises(rc.NotFoundError, match=r"pool: no object 'pol1'.*mean 'pool1'"):
            pool.add_object("pol1")
        with pytest.raises(rc.ArgumentError, match="only its pose may differ from the spec's"):
            pool.add_object(cube("pool0", mass=3))
        with pytest.raises(rc.ArgumentError, match="a SceneObject has its own pose"):
            pool.add_object(cube("new"), [0, 0, 1])
        with pytest.raises(rc.NotFoundError, match="'pool0' is parked, not in the scene"):
            pool.remove_object("pool0")
        with pytest.raises(rc.SpecError, match="only what can move freely comes and goes"):
            pool.add_object(cube("new", parked=True, fixed=True))
        assert pool.object_names == ["there"]
