"""Robots from Python: one state per robot, lifetimes, groups of one's own, grippers."""

import gc
import re
import weakref

import numpy as np
import pytest

import robocell as rc
from robocell.models import robot_file


def cell() -> rc.Scene:
    """The built-in robot on a floor."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    return rc.Scene.build(spec)


@pytest.fixture
def scene() -> rc.Scene:
    return cell()


class TestState:
    def test_a_target_outlives_its_handle(self, scene):
        target = scene.robot("a").jnt_pos_msr + 0.2
        scene.robot("a").jnt_pos_cmd = target
        gc.collect()
        scene.robot("a").update()
        np.testing.assert_array_equal(scene.robot("a").jnt_pos_cmd, target)
        scene.step_n(1500)
        np.testing.assert_allclose(scene.robot("a").arm.joint_pos, target, atol=0.02)

    def test_a_view_of_the_port_outlives_robot_and_scene(self):
        port = cell().robot("a").jnt_pos_cmd
        gc.collect()
        port[:] = 0.25
        assert port.tolist() == [0.25] * 7

    def test_a_robot_keeps_its_scene(self):
        robot = cell().robot("a")
        gc.collect()
        assert robot.step()
        assert robot.scene.robot("a").joint_names == robot.joint_names

    def test_the_last_handle_frees_the_scene(self):
        scene = cell()
        data = weakref.ref(scene.data)
        robot = scene.robot("a")
        robot.update()
        del scene
        gc.collect()
        assert data() is not None
        del robot
        gc.collect()
        assert data() is None

    def test_close_ends_robots(self, scene):
        robot = scene.robot("a")
        scene.close()
        with pytest.raises(rc.ClosedError, match="robot 'a' is closed: its scene was closed"):
            robot.update()


class Lamp(rc.robots.MoveGroup):
    """A group with one number of its own."""

    def __init__(self, kind: object = None) -> None:
        super().__init__()
        self.said = kind
        self.light = np.zeros(1)
        self.commands: list[float] = []

    def get_name(self) -> str:
        return "lamp"

    def get_joint_names(self) -> list[str]:
        return ["dimmer"]

    def get_actuator_names(self) -> list[str]:
        return ["dimmer"]

    def get_joint_pos(self) -> np.ndarray:
        return self.light

    def get_joint_vel(self) -> np.ndarray:
        return np.zeros(1)

    def get_joint_torque(self) -> np.ndarray:
        return np.zeros(1)

    def get_ctrl(self) -> np.ndarray:
        return self.light

    def set_ctrl(self, ctrl: np.ndarray) -> None:
        self.light = ctrl
        self.commands.append(float(ctrl[0]))

    def ctrl_for_joint_pos(self, q: np.ndarray) -> np.ndarray:
        return q

    def get_joint_pos_limits(self) -> list[tuple[float, float]]:
        return [(0.0, 1.0)]


class KindLamp(Lamp):
    """One that says its kind."""

    def get_kind(self) -> object:
        return self.said


class TestOwnGroups:
    def test_the_object_itself_is_the_group(self, scene):
        lamp = Lamp()
        scene.robot("a").set_group(lamp)
        assert scene.robot("a").group("lamp") is lamp
        assert lamp.kind == "generic"
        scene.robot("a").apply({"lamp": rc.control.GroupCommand.joints([0.5])})
        scene.robot("a").update()
        assert lamp.commands == [0.5]

    def test_changed_limits_apply_from_the_next_update(self, scene):
        lamp = Lamp()
        robot = scene.robot("a")
        robot.set_group(lamp)
        for brightest in (1.0, 0.25, 0.5):
            lamp.get_joint_pos_limits = lambda most=brightest: [(0.0, most)]
            robot.apply({"lamp": rc.control.GroupCommand.joints([2.0])})
            robot.update()
            assert lamp.commands[-1] == brightest

    def test_the_robot_keeps_it_alive_with_its_state(self, scene):
        scene.robot("a").set_group(Lamp())
        scene.robot("a").group("lamp").note = "mine"
        gc.collect()
        group = scene.robot("a").group("lamp")
        assert group.note == "mine"
        scene.robot("a").update()
        assert group.commands == [0.0]

    def test_a_group_can_outlive_scene_and_robot(self):
        scene, lamp = cell(), Lamp()
        scene.robot("a").set_group(lamp)
        del scene
        gc.collect()
        assert lamp.nq == 1
        assert lamp.name == "lamp"

    @pytest.mark.parametrize("holds", ["scene", "robot"])
    def test_a_cycle_through_it_is_collected(self, holds):
        scene = cell()
        robot = scene.robot("a")
        lamp = Lamp()
        lamp.held = scene if holds == "scene" else robot
        robot.set_group(lamp)
        ref, data = weakref.ref(lamp), weakref.ref(scene.data)
        del scene, robot, lamp
        gc.collect()
        gc.collect()
        assert ref() is None
        assert data() is None

    def test_reports_its_kind(self, scene):
        assert KindLamp("arm").kind == "arm"
        assert KindLamp(rc.robots.MoveGroupKind.ARM).kind == "arm"
        robot = scene.robot("a")
        robot.set_group(KindLamp("generic"))
        assert robot.group("lamp").kind == "generic"

    def test_an_unknown_kind_error_lists_the_kinds(self):
        message = r"KindLamp.get_kind: no kind 'amr'.*arm, gripper, base, generic.*mean 'arm'"
        with pytest.raises(rc.NotFoundError, match=message):
            KindLamp("amr").kind  # noqa: B018
        with pytest.raises(TypeError, match=r"get_kind\(\) must return a MoveGroupKind or its"):
            KindLamp(7).kind  # noqa: B018

    def test_rejects_a_gripper_group_that_is_not_a_gripper(self, scene):
        with pytest.raises(rc.ArgumentError, match="kind gripper derives from GripperGroup"):
            scene.robot("a").set_group(KindLamp("gripper"))

    def test_a_wrong_number_of_values_names_the_method(self, scene):
        class Short(Lamp):
            def ctrl_for_joint_pos(self, q: np.ndarray) -> np.ndarray:
                return np.zeros(3)

        robot = scene.robot("a")
        robot.set_group(Short())
        message = (
            "group 'lamp' has no controller: Short.ctrl_for_joint_pos: expected 1 value, got 3"
        )
        with pytest.raises(rc.NotFoundError, match=message):
            robot.apply({"lamp": rc.control.GroupCommand.joints([0.5])})

    @pytest.mark.parametrize(
        ("limits", "shape"),
        [
            ([-1.0, 1.0, -1.0], r"\(3,\)"),
            ([-1.0, 1.0, -1.0, 1.0], r"\(4,\)"),
            ([(-1.0, 1.0)], r"\(1, 2\)"),
            (np.zeros((2, 2, 1)), r"\(2, 2, 1\)"),
        ],
    )
    def test_limits_are_a_row_of_two_for_each_joint(self, scene, limits, shape):
        class Two(Lamp):
            get_joint_names = lambda self: ["a", "b"]  # noqa: E731
            get_joint_pos = get_joint_vel = lambda self: np.zeros(2)
            get_joint_pos_limits = get_ctrl_limits = lambda self: limits
            get_ctrl = lambda self: np.zeros(2)  # noqa: E731

        robot = scene.robot("a")
        robot.set_group(Two())
        message = rf"Two.get_joint_pos_limits: expected an array of shape \(2, 2\), got {shape}"
        with pytest.raises(rc.NotFoundError, match=f"'lamp' has no controller: {message}"):
            robot.apply({"lamp": rc.control.GroupCommand.joints([0.5, 0.5])})
        with pytest.raises(rc.ArgumentError, match=message):
            _ = robot.group("lamp").joint_pos_limits
        with pytest.raises(rc.ArgumentError, match=message.replace("joint_pos", "ctrl")):
            _ = robot.group("lamp").ctrl_limits

    def test_values_and_jacobians_of_another_shape_are_not_reordered(self):
        class Turned(Lamp):
            get_joint_pos = get_joint_vel = lambda self: np.zeros(2)
            get_joint_torque = lambda self: np.zeros((2, 1))  # noqa: E731
            get_jacobian = lambda self: self.given  # noqa: E731

        group = Turned()
        group.given = np.arange(12.0).reshape(6, 2)
        assert np.array_equal(group.jacobian(), group.given)
        group.given = group.given.T
        message = r"Turned.get_jacobian: expected an array of shape \(6, 2\), got \(2, 6\)"
        with pytest.raises(rc.ArgumentError, match=message):
            group.jacobian()
        message = r"Turned.get_joint_torque: expected an array of shape \(2,\), got \(2, 1\)"
        with pytest.raises(rc.ArgumentError, match=message):
            _ = group.joint_torque

    def test_integrates_a_velocity(self, scene):
        arm = scene.robot("a").arm
        q, v = arm.joint_pos, np.linspace(-1, 1, arm.nv)
        assert np.allclose(arm.integrate(q, v), q + v)
        with pytest.raises(ValueError, match="expected"):
            arm.integrate(q[1:], v)
        with pytest.raises(ValueError, match="expected"):
            arm.integrate(q, v[1:])

        class Doubling(Lamp):
            def integrate(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
                return q + 2 * v

        robot = scene.robot("a")
        robot.set_group(Doubling())
        assert robot.group("lamp").integrate(np.ones(1), np.full(1, 0.25)) == [1.5]
        assert rc.robots.MoveGroup.integrate(Doubling(), [1.0], [0.25]) == [1.5]
        message = r"must define integrate\(\); Lamp does not"
        with pytest.raises(rc.Error, match=message):
            Lamp().integrate([1.0], [0.25])

    def test_rejects_a_gripper_that_measures_nan(self, scene):
        class Vague(rc.robots.GripperGroup):
            get_name = lambda self: "vague"  # noqa: E731
            get_joint_names = get_actuator_names = get_joint_pos = lambda self: []
            get_joint_vel = get_joint_torque = get_ctrl = lambda self: []
            get_opening = get_inter_finger_dist = lambda self: float("nan")

        scene.robot("a").set_group(Vague())
        gripper = scene.robot("a").group("vague")
        with pytest.raises(
            rc.ArgumentError, match=r"Vague.get_opening\(\) must return a finite number, got nan"
        ):
            _ = gripper.opening
        with pytest.raises(rc.ArgumentError, match=r"Vague.get_inter_finger_dist\(\) must return"):
            _ = gripper.inter_finger_dist

    def test_rejects_values_that_are_not_groups(self, scene):
        with pytest.raises(TypeError):
            scene.robot("a").set_group(object())


class OwnGripper(rc.robots.GripperGroup):
    """Opens and closes in no time."""

    def __init__(self) -> None:
        super().__init__()
        self.ctrl_value = 1.0

    def get_name(self) -> str:
        return "gripper"

    def get_joint_names(self) -> list[str]:
        return []

    def get_actuator_names(self) -> list[str]:
        return ["magnet"]

    def get_joint_pos(self) -> list[float]:
        return []

    def get_joint_vel(self) -> list[float]:
        return []

    def get_joint_torque(self) -> list[float]:
        return []

    def get_ctrl(self) -> list[float]:
        return [self.ctrl_value]

    def set_ctrl(self, ctrl: np.ndarray) -> None:
        self.ctrl_value = float(ctrl[0])

    def get_opening(self) -> float:
        return self.ctrl_value

    def set_opening(self, opening: float) -> None:
        self.ctrl_value = opening

    def ctrl_for_opening(self, opening: float) -> float:
        return opening

    def get_is_grasping(self, body: str) -> bool:
        return body == "cube"


def test_a_custom_gripper_replaces_the_robots_gripper(scene):
    mine = OwnGripper()
    robot = scene.robot("a")
    robot.set_group(mine)
    assert robot.gripper is mine
    assert mine.kind == "gripper"
    assert mine.is_grasping("cube")
    robot.apply({"gripper": rc.control.GroupCommand.opening(0.25)})
    robot.update()
    assert mine.opening == 0.25
    robot.gripper.open()
    robot.update()
    assert mine.opening == 1.0
    with pytest.raises(rc.Error, match="must define get_is_open\\(\\); OwnGripper does not"):
        mine.is_open  # noqa: B018


def settle(robot: rc.Robot, seconds: float = 1.0) -> float:
    """Steps with the controllers running; the opening at the end."""
    for _ in range(int(seconds / robot.scene.timestep())):
        robot.update()
        robot.step()
    return robot.gripper.opening


class TestGripper:
    @pytest.mark.parametrize("controlled", [True, False], ids=["update", "steps alone"])
    def test_the_gripper_opens_and_closes_on_command(self, scene, controlled):
        robot = scene.robot("a")

        def after() -> float:
            if not controlled:
                scene.step_n(500)
            return settle(robot) if controlled else robot.gripper.opening

        robot.gripper.opening = 0
        assert after() < 0.05
        robot.gripper.opening = 1
        assert after() > 0.95
        robot.gripper.close()
        assert after() < 0.05
        robot.gripper.open()
        assert after() > 0.95

    def test_the_gripper_follows_raw_controls(self, scene):
        robot = scene.robot("a")
        robot.gripper.close()
        closed = robot.gripper.ctrl
        robot.gripper.open()
        settle(robot)
        robot.gripper.ctrl = closed
        assert settle(robot) < 0.05

    def test_the_last_command_wins(self, scene):
        robot = scene.robot("a")
        robot.gripper.opening = 1
        assert settle(robot) > 0.95
        robot.apply({"gripper": rc.control.GroupCommand.opening(0)})
        robot.gripper.opening = 1
        assert settle(robot) > 0.95
        robot.gripper.opening = 0
        robot.apply({"gripper": rc.control.GroupCommand.opening(1)})
        assert settle(robot) > 0.95


class TestLockedGroups:
    """Inverse kinematics with groups that stay put."""

    @pytest.fixture
    def robot(self) -> rc.Robot:
        config = rc.RobotConfig.load(robot_file("rc7"))
        config.move_groups["wrist"] = rc.robots.MoveGroupConfig(
            kind="generic", joints=["joint6", "joint7"]
        )
        spec = rc.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=False)
        spec.robots.append(rc.RobotSpec(name="a", config=config))
        scene = rc.Scene.build(spec)
        scene.reset()
        return scene.robot("a")

    def test_a_locked_group_within_the_arm_keeps_the_seed(self, robot):
        seed = robot.arm.joint_pos
        moved = seed + np.array([0.2, 0.1, -0.2, 0.1, 0.3, 0, 0])
        target = robot.kinematics.fk(moved)
        one = robot.kinematics.ik(target, seed=seed, locked_groups=["wrist"])
        assert one.success
        np.testing.assert_array_equal(one.q[5:], seed[5:])
        batch = robot.kinematics.ik_batch(
            np.array([target.matrix] * 2), seeds=seed, locked_groups=["wrist"]
        )
        assert batch.success.all()
        np.testing.assert_array_equal(batch.q[:, 5:], [seed[5:]] * 2)

    def test_rejects_an_actuator_commanded_by_two_groups(self):
        config = rc.RobotConfig.load(robot_file("rc7"))
        config.move_groups["wrist"] = rc.robots.MoveGroupConfig(
            joints=["joint7"], actuators=["servo7"]
        )
        spec = rc.SceneSpec(name="s", timestep=0.002)
        spec.robots.append(rc.RobotSpec(name="a", config=config))
        said = (
            "move_groups.wrist.actuators[0]: actuator 'servo7' is commanded by move_groups.arm "
            "and move_groups.wrist; leave it out of one"
        )
        with pytest.raises(rc.SpecError, match=re.escape(said)):
            rc.Scene.build(spec)

    def test_batches_take_the_options_of_single_poses(self, robot):
        target = robot.kinematics.fk(robot.arm.joint_pos + 0.1)
        turned = (target * rc.Pose(rpy=[1, 1, 1])).matrix[None]
        found = robot.kinematics.ik_batch(turned, position_only=True)
        assert found.success.all()
        reached = robot.kinematics.fk(found.q[0]).translation
        np.testing.assert_allclose(reached, target.translation, atol=1e-5)
        seed = robot.arm.joint_pos
        options = {"seeds": seed, "max_restarts": 0, "max_iterations": 0}
        assert not robot.kinematics.ik_batch(target.matrix[None], **options).success.any()
        alone = robot.kinematics.ik(target, seed=seed, max_restarts=0, max_iterations=0)
        assert (alone.success, alone.iterations, alone.restarts) == (False, 0, 0)
        near = robot.kinematics.ik_batch(target.matrix[None], seeds=seed, prefer="seed")
        one = robot.kinematics.ik(target, seed=seed, prefer="seed")
        np.testing.assert_allclose(near.q[0], one.q, atol=1e-12)

    def test_accepts_strided_input_and_returns_new_arrays(self, robot):
        seed = robot.arm.joint_pos.round(3)
        target = robot.kinematics.fk(seed + 0.1)
        found = robot.kinematics.ik(target, seed=seed)
        assert found.success
        read_only = seed.copy()
        read_only.setflags(write=False)
        wide = np.repeat(seed, 2)[::2]
        for same in (seed.tolist(), tuple(seed), read_only, wide, seed.astype(object)):
            np.testing.assert_array_equal(robot.kinematics.ik(target, seed=same).q, found.q)
        for wrong in (seed[None], seed[0], np.zeros((7, 1))):
            with pytest.raises(rc.ArgumentError, match="seed must be a"):
                robot.kinematics.ik(target, seed=wrong)
        q = found.q
        assert (q.shape, q.dtype, q.flags.owndata) == ((7,), np.float64, True)
        q[:] = 0
        assert not np.array_equal(found.q, q)

        targets = np.repeat(target.matrix[None], 5, axis=0)
        batch = robot.kinematics.ik_batch(targets, seeds=seed)
        spaced = np.repeat(targets, 2, axis=0)[::2]
        for same in (targets.tolist(), spaced, np.asfortranarray(targets)):
            np.testing.assert_array_equal(robot.kinematics.ik_batch(same, seeds=seed).q, batch.q)
        assert (batch.success.dtype, batch.iterations.dtype) == (np.bool_, np.int32)
        del targets
        batch.q += 1
        batch.success[0] = False
        assert batch.success.tolist() == [False, True, True, True, True]

    def test_a_target_is_a_pose_or_a_matrix_and_a_batch_a_list_of_either(self, robot):
        target = robot.kinematics.fk(robot.arm.joint_pos + 0.1)
        solve, batch = robot.kinematics.ik, robot.kinematics.ik_batch
        for ik in (solve, robot.ik):
            for matrix in (target.matrix, target.matrix.tolist()):
                np.testing.assert_array_equal(ik(matrix).q, ik(rc.Pose(matrix)).q)
        expected = batch(target.matrix[None]).q
        for one in (target, [target], (target,), [target.matrix], [target.matrix.tolist()]):
            np.testing.assert_allclose(batch(one).q, expected, atol=1e-12)
        for many in ([target] * 4, [target.matrix] * 4, [target.matrix, target, target, target]):
            np.testing.assert_allclose(batch(many).q, np.repeat(expected, 4, 0), atol=1e-12)
        with pytest.raises(rc.ArgumentError, match=r"targets\[1\]: matrix must be"):
            batch([target, 3])
        with pytest.raises(rc.ArgumentError, match=r"targets\[1\] must be a pose, got None"):
            batch([target, None])
        with pytest.raises(rc.ArgumentError, match=r"targets\[1\]: .*4"):
            batch([target, np.zeros((4, 4))])
        with pytest.raises(TypeError, match=r"matrix\[0\]\[0\] must be a number"):
            solve(np.zeros((4, 4, 4)))
        with pytest.raises(rc.ArgumentError, match=r"given as Pose\(translation=\[1, 2, 3\]\)"):
            solve([1, 2, 3])
        with pytest.raises(rc.ArgumentError, match="matrix must be"):
            solve([0, 0, 1, 0, 0, 0, 1])
        with pytest.raises(TypeError, match="`target` must be a Pose or numbers, got 'up'"):
            solve("up")

    def test_locking_groups_outside_the_chain_has_no_effect(self, robot):
        target = robot.kinematics.fk(robot.arm.joint_pos + 0.1)
        free = robot.kinematics.ik(target)
        locked = robot.kinematics.ik(target, locked_groups=["gripper", "base"])
        np.testing.assert_array_equal(free.q, locked.q)
        with pytest.raises(rc.NotFoundError, match=r"no group 'wirst'.*Did you mean 'wrist'"):
            robot.kinematics.ik(target, locked_groups=["wirst"])


def test_groups_and_controllers_that_were_replaced_are_released():
    scene = cell()
    robot = scene.robot("a")
    alive = []
    for _ in range(20):
        lamp = Lamp()
        alive.append(weakref.ref(lamp))
        robot.set_group(lamp)
    del lamp
    gc.collect()
    assert [ref() is not None for ref in alive] == [False] * 19 + [True]


class TestWrittenModel:
    def test_the_chain_follows_model_edits_after_forward_or_reset(self, scene):
        robot = scene.robot("a")
        dofs = [scene.model.joint(name).dofadr[0] for name in robot.joint_names]
        last = scene.model.jnt_bodyid[scene.model.joint(robot.joint_names[-1]).id]
        scene.model.body_gravcomp[:] = 0
        for announce in (scene.forward, scene.reset):
            before = robot.gravity_torques()
            scene.model.body_mass[last] += 2
            announce()
            needed = (scene.data.qfrc_bias - scene.data.qfrc_gravcomp)[dofs]
            np.testing.assert_allclose(robot.gravity_torques(), needed, atol=1e-9)
            assert not np.allclose(before, needed)

    def test_limits_edited_in_the_model_apply_to_commands_and_kinematics(self, scene):
        robot = scene.robot("a")
        joint = scene.model.joint(robot.joint_names[1])
        lower, upper = joint.range
        joint.range[1] = upper - 0.5
        scene.forward()
        assert list(robot.chain.joint_limits[1]) == [lower, upper - 0.5]
        target = robot.jnt_pos_msr.copy()
        target[1] = upper
        robot.jnt_pos_cmd = target
        robot.update()
        assert robot.arm.ctrl[1] == upper - 0.5
