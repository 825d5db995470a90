"""Inverse kinematics of more and less than a pose, from Python; judged by forward kinematics."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import robocell as rc
from robocell.models import robot_file

NEAR = 1.0001e-5


@pytest.fixture(scope="module")
def robot() -> rc.Robot:
    """The built-in robot before a wall."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="a", config=rc.RobotConfig.load(robot_file("rc7"))))
    wall = rc.SceneObject(
        name="wall",
        shape=rc.Shape.BOX,
        size=[0.02, 0.5, 0.3],
        rgba=[1, 1, 1, 1],
        mass=1,
        friction=[1, 0.005, 0.0001],
        pos=[0.45, 0, 0.3],
        fixed=True,
    )
    spec.objects.append(wall)
    return rc.Scene.build(spec).robot("a")


def reachable(robot: rc.Robot, count: int, seed: int = 0) -> np.ndarray:
    """(count, n) joint values in the limits."""
    low, high = np.array(robot.joint_limits).T
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def seen_from(robot: rc.Robot, target: rc.Pose, q) -> rc.Pose:
    """The TCP in the axes of the target."""
    return target.inverse() * robot.kinematics.fk(q)


class TestTasks:
    def test_an_axis_points_like_that_of_the_target(self, robot):
        spin = rc.Pose(rpy=[0, 0, 2.5])
        targets = [robot.kinematics.fk(q) * spin for q in reachable(robot, 50)]
        found = robot.kinematics.ik_batch(targets, axis=[0, 0, 1])
        assert found.success.mean() > 0.97
        one = robot.kinematics.ik(targets[0], axis=[0, 0, 1])
        assert one.success
        for target, q in [*zip(targets, found.q, strict=True), (targets[0], one.q)]:
            tip = seen_from(robot, target, q)
            assert np.linalg.norm(tip.translation) < NEAR
            assert np.linalg.norm(tip.rotation[:2, 2]) < NEAR

    def test_an_axis_has_a_name_or_three_numbers(self, robot):
        target = robot.kinematics.fk(reachable(robot, 1)[0]) * rc.Pose(rpy=[0, 0, 2.5])
        for name, numbers in [("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])]:
            named, plain = (robot.kinematics.ik(target, axis=axis) for axis in (name, numbers))
            np.testing.assert_array_equal(named.q, plain.q)
        for wrong in ("w", "xy", ""):
            with pytest.raises(rc.ArgumentError, match=f'axis must be "x".* got "{wrong}"'):
                robot.kinematics.ik(target, axis=wrong)

    def test_a_cone_and_weights(self, robot):
        target = robot.kinematics.fk(reachable(robot, 1)[0])
        tilted = target * rc.Pose(rpy=[0.2, 0, 1])
        cone = robot.kinematics.ik(tilted, axis=[0, 0, 1], cone=0.2)
        assert cone.success
        tip = seen_from(robot, tilted, cone.q)
        assert np.arccos(tip.rotation[2, 2]) <= 0.2 + NEAR
        free = target * rc.Pose(translation=[0, 9, 0])
        along = robot.kinematics.ik(free, position_weights=[1, 0, 1])
        assert along.success
        assert np.linalg.norm(seen_from(robot, free, along.q).translation[[0, 2]]) < NEAR

    def test_rejects_contradictory_ik_options(self, robot):
        solve, target = robot.kinematics.ik, robot.fk_frame()
        with pytest.raises(rc.ArgumentError, match=r"cone is 0\.1 rad, but no axis is given"):
            solve(target, cone=0.1)
        with pytest.raises(rc.ArgumentError, match="position_weights must be 3 numbers, got 2"):
            solve(target, position_weights=[1, 2])
        with pytest.raises(rc.ArgumentError, match=r"prefer must be one of .*Did you mean 'seed'"):
            solve(target, prefer="sed")
        with pytest.raises(rc.ArgumentError, match="posture: expected 7 joint values, got 2"):
            solve(target, prefer=[0, 1])
        with pytest.raises(TypeError, match="filter must be a CollisionFilter or a function"):
            solve(target, filter=3)
        with pytest.raises(rc.ArgumentError, match=r"filter must return \(1,\) booleans"):
            solve(target, filter=lambda q: [True, False])
        for answer, got in [
            (lambda q: ["no"], "dtype <U2"),
            (lambda q: [0.3], r"numbers \(dtype float64\) that are not all 0 or 1"),
            (lambda q: [np.nan], ".* that are not all 0 or 1"),
            (lambda q: [2], r"numbers \(dtype int64\)"),
            (lambda q: [None], "dtype object"),
            (lambda q: [[1], [1, 2]], "list"),
            (lambda q: None, r"shape \(\)"),
        ]:
            with pytest.raises(rc.ArgumentError, match=r"filter must return \(1,\) .*got " + got):
                solve(target, filter=answer)
        assert solve(target, filter=lambda q: np.ones(len(q)))
        with pytest.raises(ZeroDivisionError):
            robot.kinematics.ik_batch([target] * 3, filter=lambda q: 1 / 0)
        with pytest.raises(rc.ArgumentError, match="starts is 0; it must be 1 or more"):
            robot.kinematics.ik_solutions(target, starts=0)


class TestPreferences:
    @pytest.mark.parametrize("prefer", ["seed", "limits", "manipulability", "posture"])
    def test_preferred_solutions_improve_on_the_first(self, robot, prefer):
        low, high = np.array(robot.joint_limits).T
        posture = 0.5 * (low + high) + 0.1
        seed = robot.arm.joint_pos

        def badness(q):
            if prefer == "manipulability":
                return -robot.kinematics.manipulability(q)
            if prefer == "limits":
                return np.sum(((2 * q - low - high) / (high - low)) ** 2)
            return np.sum((q - (seed if prefer == "seed" else posture)) ** 2)

        targets = [robot.kinematics.fk(q) for q in reachable(robot, 20, 3)]
        wanted = posture if prefer == "posture" else prefer
        first = robot.kinematics.ik_batch(targets, seeds=seed)
        best = robot.kinematics.ik_batch(targets, seeds=seed, prefer=wanted)
        again = robot.kinematics.ik_batch(targets, seeds=seed, prefer=wanted, threads=2)
        np.testing.assert_array_equal(best.q, again.q)
        both = first.success & best.success
        assert both.sum() >= 19
        before = sum(badness(q) for q in first.q[both])
        assert sum(badness(q) for q in best.q[both]) < before

    def test_without_a_seed_solutions_are_near_the_arm(self, robot):
        targets = [robot.kinematics.fk(q) for q in reachable(robot, 5, 4)]
        near = robot.kinematics.ik_batch(targets, prefer="seed")
        same = robot.kinematics.ik_batch(targets, seeds=robot.arm.joint_pos, prefer="seed")
        np.testing.assert_array_equal(near.q, same.q)

    def test_manipulability_is_yoshikawas(self, robot):
        q = reachable(robot, 1)[0]
        j = robot.kinematics.jacobian(q)
        expected = np.sqrt(np.linalg.det(j @ j.T))
        assert robot.kinematics.manipulability(q) == pytest.approx(expected, rel=1e-9)


class TestFilters:
    def test_the_collision_filter_keeps_arms_out_of_a_wall(self, robot):
        free = rc.kinematics.CollisionFilter(robot)
        q = reachable(robot, 300, 1)
        mask = free(q)
        assert 20 < mask.sum() < 280
        everywhere = np.array([robot.kinematics.fk(x).matrix for x in reachable(robot, 2000, 2)])
        # Those whose first solution touches something.
        targets = everywhere[~free(robot.kinematics.ik_batch(everywhere).q)][:100]
        found = robot.kinematics.ik_batch(targets, filter=free)
        assert len(targets) == 100
        assert found.success.sum() > 10
        assert free(found.q[found.success]).all()
        assert rc.kinematics.CollisionFilter(robot, ignored=["wall"])(q).sum() > mask.sum()
        with pytest.raises(rc.NotFoundError, match="Did you mean 'wall'"):
            rc.kinematics.CollisionFilter(robot, ignored=["wal"])
        with pytest.raises(rc.ArgumentError, match=r"q must be \(k, 7\), got \(7,\)"):
            free(q[0])

    def test_threads_take_turns_with_one_filter(self, robot):
        free = rc.kinematics.CollisionFilter(robot)
        q = reachable(robot, 1000, 6)
        alone = free(q)
        with ThreadPoolExecutor(4) as pool:
            for mask in pool.map(free, [q] * 12):
                np.testing.assert_array_equal(mask, alone)

    def test_a_filter_function_receives_rows(self, robot):
        shapes = []

        def positive(q):
            shapes.append(q.shape)
            return q[:, 0] > 0

        q = reachable(robot, 30, 2)
        q[:, 0] = np.abs(q[:, 0]) + 0.1
        found = robot.kinematics.ik_batch(
            [robot.kinematics.fk(x) for x in q], filter=positive, threads=2
        )
        assert found.success.mean() > 0.9
        assert (found.q[found.success, 0] > 0).all()
        assert shapes[0] == (30, 7)
        none = robot.kinematics.ik(robot.kinematics.fk(q[0]), filter=lambda q: np.zeros(len(q)))
        assert not none.success
        assert none.position_error < NEAR


def test_solutions_are_distinct_and_correct(robot):
    seed = robot.arm.joint_pos
    target = robot.kinematics.fk(reachable(robot, 1, 5)[0])
    q = robot.kinematics.ik_solutions(target, prefer="limits", separation=0.3)
    assert q.shape[1:] == (7,)
    assert len(q) >= 1
    for x in q:
        assert robot.kinematics.fk(x).is_close(target, 1e-4, 1e-4)
    apart = np.abs(q[:, None] - q[None]).max(axis=2) + np.eye(len(q))
    assert apart.min() > 0.3
    near = robot.kinematics.ik_solutions(target, seed=seed)
    distance = np.sum((near - seed) ** 2, axis=1)
    assert (np.diff(distance) >= -1e-12).all()


class TestReach:
    def test_the_reach_map_agrees_with_single_queries(self, robot):
        found = robot.kinematics.reach_map([0.3, -0.1, 0.3], [0.5, 0.1, 0.3], cell=0.1, threads=2)
        assert found.fraction.shape == found.manipulability.shape == (2, 2, 1)
        np.testing.assert_allclose(found.x, [0.35, 0.45])
        assert found.fraction.min() > 0.2
        one = robot.kinematics.ik(
            rc.Pose(translation=[0.35, -0.05, 0.3]), position_only=True, seed=np.zeros(7)
        )
        assert one.success
        far = robot.kinematics.reach_map([5, 5, 5], [5, 5, 5])
        assert far.fraction.tolist() == [[[0]]]
        with pytest.raises(rc.ArgumentError, match="reach map: the corners are"):
            robot.kinematics.reach_map([1, 0, 0], [0, 0, 0])


class TestDifferentialIk:
    def test_joint_velocities_produce_the_requested_twist(self, robot):
        q = robot.arm.joint_pos
        asked = np.array([0.05, -0.1, 0.02, 0.1, 0.2, -0.1])
        found = robot.kinematics.differential_ik(q, asked)
        np.testing.assert_allclose(robot.kinematics.jacobian(q) @ found.velocity, asked, atol=1e-3)
        step = 1e-5
        moved = robot.kinematics.fk(q + step * found.velocity)
        way = (moved.translation - robot.kinematics.fk(q).translation) / step
        np.testing.assert_allclose(way, asked[:3], atol=1e-3)
        tip = robot.kinematics.differential_ik(q, [0, 0, 0.1, 0, 0, 0], frame="tip")
        axis = robot.kinematics.fk(q).rotation[:, 2]
        linear = (robot.kinematics.jacobian(q) @ tip.velocity)[:3]
        np.testing.assert_allclose(linear, 0.1 * axis, atol=1e-3)

    def test_accepts_twists_in_world_axes(self):
        spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=False, add_skybox=False)
        config = rc.RobotConfig.load(robot_file("rc7"))
        spec.robots.append(rc.RobotSpec(name="a", config=config, euler=[30, -50, 80]))
        robot = rc.Scene.build(spec).robot("a")
        q, asked = robot.arm.joint_pos, np.array([0.02, -0.03, 0.05, 0.1, 0.2, -0.1])
        found = robot.kinematics.differential_ik(q, asked, frame="world")
        np.testing.assert_allclose(found.twist, asked, atol=1e-3)
        moved = (robot.kinematics.jacobian(q) @ found.velocity).reshape(2, 3)
        in_world = moved @ robot.base_in_world.rotation.T
        np.testing.assert_allclose(in_world.ravel(), asked, atol=1e-3)
        jog = robot.set_controller("arm", "differential_ik")
        jog.frame = "world"
        assert jog.frame == "world"

    def test_joint_velocities_respect_their_bounds(self, robot):
        found = robot.kinematics.differential_ik(
            robot.arm.joint_pos, [5, 0, 0, 0, 0, 0], max_speed=[0.2] * 7, locked_groups=["gripper"]
        )
        assert found.slower
        assert np.abs(found.velocity).max() <= 0.2
        message = r"frame must be one of .*got 'wold'.*mean 'world'"
        with pytest.raises(rc.ArgumentError, match=message):
            robot.kinematics.differential_ik(np.zeros(7), np.zeros(6), frame="wold")
        with pytest.raises(rc.ArgumentError, match="max_speed of joint 'joint1' is 0"):
            robot.kinematics.differential_ik(np.zeros(7), np.zeros(6), max_speed=np.zeros(7))

    def test_the_controller_follows_a_commanded_twist(self, robot):
        jog = robot.set_controller("arm", "differential_ik")
        assert isinstance(jog, rc.control.DifferentialIkController)
        start = robot.fk_frame()
        jog.twist = [0, 0, 0.05, 0, 0, 0]
        jog.max_speed = [1] * 7
        assert (jog.frame, jog.slower, jog.posture_rate) == ("base", False, 1)
        for _ in range(250):
            robot.update()
            robot.step()
        risen = robot.fk_frame().translation - start.translation
        np.testing.assert_allclose(risen, [0, 0, 0.025], atol=6e-3)
        jog.frame = "tip"
        jog.reset()
        assert jog.twist.tolist() == [0] * 6
        with pytest.raises(rc.ArgumentError, match="twist must be 6 numbers, got 3"):
            jog.twist = [1, 2, 3]


class TestChains:
    """A chain on its own answers as the robot's kinematics."""

    def test_accepts_the_options_of_the_robot_kinematics(self, robot):
        chain, kinematics = robot.chain, robot.kinematics
        seed = robot.arm.joint_pos
        target = kinematics.fk(seed + 0.1)
        for options in (
            {"axis": [0, 0, 1], "cone": 0.1},
            {"prefer": "limits"},
            {"prefer": seed + 0.05},
            {"position_weights": [1, 0, 1], "max_restarts": 5, "max_iterations": 20},
            {"filter": lambda q: q[:, 0] > -1},
        ):
            ours = chain.ik(target, seed=seed, **options)
            np.testing.assert_array_equal(ours.q, kinematics.ik(target, seed=seed, **options).q)
            many = chain.ik_batch([target] * 3, seeds=seed, threads=2, **options)
            theirs = kinematics.ik_batch([target] * 3, seeds=seed, **options)
            np.testing.assert_array_equal(many.q, theirs.q)
            assert many.success.all()
        every = chain.ik_solutions(target, seed=seed, prefer="limits", starts=50)
        expected = kinematics.ik_solutions(target, seed=seed, prefer="limits", starts=50)
        np.testing.assert_array_equal(every, expected)
        assert chain.manipulability(seed) == kinematics.manipulability(seed)

    def test_matches_the_robot_kinematics(self, robot):
        chain, kinematics = robot.chain, robot.kinematics
        corners, options = ([0.2, -0.1, 0.3], [0.6, 0.1, 0.3]), {"cell": 0.1, "rotations": 8}
        ours, theirs = (k.reach_map(*corners, **options) for k in (chain, kinematics))
        assert ours.fraction.max() > 0
        for name in ("fraction", "manipulability", "x", "y", "z"):
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
        np.testing.assert_array_equal(chain.reach_box(), kinematics.reach_box())
        lower, upper = chain.reach_box()
        far = np.linalg.norm(kinematics.fk(reachable(robot, 500))[:, :3, 3], axis=1).max()
        assert 0.97 * far <= chain.reach <= np.linalg.norm(upper - lower)

        q, twist = robot.arm.joint_pos, [0.02, -0.03, 0.05, 0.1, 0.2, -0.1]
        bounds = {"seconds": 0.01, "max_speed": [0.1] * 7, "posture": q + 0.1, "posture_rate": 2}
        for frame in ("base", "tip"):
            ours, theirs = (
                k.differential_ik(q, twist, frame, **bounds) for k in (chain, kinematics)
            )
            np.testing.assert_array_equal(ours.velocity, theirs.velocity)
            np.testing.assert_array_equal(ours.twist, theirs.twist)
            assert ours.slower == theirs.slower
        base = rc.Pose(rpy=[0.4, -1.1, 2])
        ours = chain.differential_ik(q, twist, "world", base_in_world=base)
        turned = (base.rotation.T @ np.reshape(twist, (2, 3)).T).T.ravel()
        theirs = chain.differential_ik(q, turned)
        np.testing.assert_allclose(ours.velocity, theirs.velocity, atol=1e-12)
        still = chain.differential_ik(q, twist, locked_joints=[chain.joint_names[2]])
        assert still.velocity[2] == 0
        with pytest.raises(rc.ArgumentError, match="a chain does not know how its base stands"):
            chain.differential_ik(q, twist, "world")
        with pytest.raises(rc.NotFoundError, match="Did you mean 'joint1'"):
            chain.differential_ik(q, twist, locked_joints=["join1"])
        with pytest.raises(rc.ArgumentError, match="reach map: the corners are"):
            chain.reach_map([1, 0, 0], [0, 0, 0])

    def test_locks_joints_by_name(self, robot):
        chain, seed = robot.chain, robot.arm.joint_pos
        truth = seed + np.array([0.1, 0, 0.1, 0.1, 0.1, 0, 0.1])
        locked = [chain.joint_names[1], chain.joint_names[5]]
        target = chain.fk(truth)
        alone = chain.ik(target, seed=seed, locked_joints=locked)
        many = chain.ik_batch(target.matrix[None], seeds=seed, locked_joints=locked)
        for q in (alone.q, many.q[0]):
            np.testing.assert_array_equal(q[[1, 5]], seed[[1, 5]])
        assert alone.success == many.success[0]
        with pytest.raises(rc.NotFoundError, match="Did you mean 'joint1'"):
            chain.ik(target, seed=seed, locked_joints=["join1"])
        with pytest.raises(rc.ArgumentError, match="locked, but there is no seed"):
            chain.ik_batch([target], locked_joints=locked)


class TestRobots:
    """`robot.ik` is the one of its kinematics."""

    def test_accepts_all_options(self, robot):
        seed = robot.arm.joint_pos
        target = robot.kinematics.fk(seed + 0.1)
        for options in (
            {},
            {"seed": seed + 0.05, "tolerance": 1e-8},
            {"position_only": True},
            {"axis": [0, 0, 1], "cone": 0.1, "prefer": "limits"},
            {"prefer": seed + 0.05, "filter": lambda q: q[:, 0] > -1},
            {"position_weights": [1, 0, 1], "max_restarts": 5, "max_iterations": 20},
            {"rotation_weights": [1, 1, 0], "prefer": "manipulability"},
        ):
            ours, theirs = (ik(target, **options) for ik in (robot.ik, robot.kinematics.ik))
            assert ours.success
            np.testing.assert_array_equal(ours.q, theirs.q)
        free = rc.kinematics.CollisionFilter(robot)
        assert free(robot.ik(pose=target, filter=free).q[None]).all()
        assert not robot.ik(target, locked_groups=["arm"])
        with pytest.raises(rc.ArgumentError, match=r"prefer must be one of .*Did you mean 'seed'"):
            robot.ik(target, prefer="sed")


class TestForms:
    """`ik` gives the same answer to all forms of a query."""

    def test_of_poses_and_seeds(self, robot):
        low, high = np.array(robot.joint_limits).T
        for k, q in enumerate(reachable(robot, 30, seed=5)):
            pose = robot.kinematics.fk(q)
            seed = (low + high) / 2 if k % 2 else np.clip(q + 0.1, low, high)
            apart, swapped = np.repeat(seed, 2)[::2], seed.astype(">f8")
            sealed = seed.copy()
            sealed.flags.writeable = False
            for name, ik in (
                ("pose", robot.ik),
                ("target", robot.kinematics.ik),
                ("target", robot.chain.ik),
            ):
                plain = ik(pose, seed=seed, tolerance=1e-5)
                assert plain.success
                assert plain.q.flags.writeable
                assert plain.q is not plain.q
                for same in (
                    ik(pose, seed),
                    ik(pose, seed=sealed),
                    ik(pose, tolerance=1e-5, seed=seed),
                    ik(**{name: pose}, seed=seed),
                    ik(pose, list(seed), tolerance=1e-5),
                    ik(pose, apart),
                    ik(pose, swapped),
                    ik(pose, memoryview(seed)),
                    ik(pose, seed, max_restarts=100, max_iterations=40),
                    ik(**{name: pose, "".join(["se", "ed"]): seed}),
                ):
                    np.testing.assert_array_equal(same.q, plain.q)
                    assert same.restarts == plain.restarts
                    assert same.iterations == plain.iterations
                assert ik(pose, seed, tolerance=1e-9).position_error < 1e-9

    def test_become_invalid_with_the_scene_except_for_chains(self):
        spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
        spec.robots.append(rc.RobotSpec(name="a", config=rc.RobotConfig.load(robot_file("rc7"))))
        scene = rc.Scene.build(spec)
        robot = scene.robot("a")
        kinematics, chain = robot.kinematics, robot.chain
        seed = robot.arm.joint_pos
        pose = chain.fk(seed + 0.1)
        assert kinematics.ik(pose, seed)
        assert robot.ik(pose, seed)
        scene.close()
        for ik in (robot.ik, kinematics.ik):
            with pytest.raises(rc.ClosedError, match="robot 'a' is closed: its scene was closed"):
                ik(pose, seed)
        assert chain.ik(pose, seed)


class TestBatches:
    """Any batch, and what is no batch of poses."""

    def test_solutions_depend_only_on_their_queries(self, robot):
        rng = np.random.default_rng(4)
        low, high = np.array(robot.joint_limits).T
        corners = np.where(rng.random((20, 7)) < 0.5, low, high)
        targets = robot.kinematics.fk(np.vstack([reachable(robot, 60), corners]))
        targets[::9, :3, 3] += [30, 0, 0]
        seeds = rng.uniform(-20, 20, (80, 7))  # most of them outside the limits
        all_of_them = robot.kinematics.ik_batch(targets, seeds=seeds)
        order = rng.permutation(80)
        for threads in (1, 3):
            mixed = robot.kinematics.ik_batch(targets[order], seeds=seeds[order], threads=threads)
            for name in ("q", "success", "position_error", "rotation_error", "iterations"):
                np.testing.assert_array_equal(
                    getattr(mixed, name), getattr(all_of_them, name)[order]
                )
        alone = robot.kinematics.ik_batch(targets[7:8], seeds=seeds[7])
        np.testing.assert_array_equal(alone.q[0], all_of_them.q[7])
        assert all_of_them.success.dtype == bool
        assert all_of_them.q.flags.writeable
        assert not all_of_them.success[::9].any()
        reached = np.delete(np.arange(80), np.s_[::9])
        assert all_of_them.success[reached].sum() >= len(reached) - 1
        assert np.all((all_of_them.q >= low) & (all_of_them.q <= high))
        tips = robot.kinematics.fk(all_of_them.q)
        off = np.linalg.norm(tips[:, :3, 3] - targets[:, :3, 3], axis=1)
        np.testing.assert_allclose(off, all_of_them.position_error, atol=1e-9)

    @pytest.mark.parametrize("empty", [np.zeros((0, 4, 4)), []])
    def test_an_empty_batch_has_an_empty_result(self, robot, empty):
        found = robot.kinematics.ik_batch(empty)
        assert (found.q.shape, found.success.shape) == ((0, 7), (0,))

    @pytest.mark.parametrize(
        ("spoil", "message"),
        [
            (lambda t: t[:, :3], r"targets must be 4x4 matrices .*, has shape \(3, 3, 4\)"),
            (lambda t: t.reshape(-1), r"targets must be 4x4 matrices .*, has shape \(48,\)"),
            (lambda t: t.reshape(3, 16), r"targets must be .* list of poses, has shape \(3, 16\)"),
            (lambda t: t[0, :3], r"targets must be 4x4 matrices .*, has shape \(3, 4\)"),
            (lambda t: np.where(np.arange(3)[:, None, None] == 1, np.nan, t), r"targets\[1\]"),
            (lambda t: t * [[[2, 1, 1, 1]] * 3 + [[1] * 4]], r"targets\[0\]: "),
            (lambda t: t * [[[1, 1, -1, 1]] * 3 + [[1] * 4]], r"targets\[0\]: "),
            (lambda t: np.vstack([t[:2], t[2:] + np.inf]), r"targets\[2\]"),
        ],
    )
    def test_errors_name_the_invalid_pose_of_a_batch(self, robot, spoil, message):
        targets = robot.kinematics.fk(reachable(robot, 3))
        with pytest.raises(rc.ArgumentError, match=message):
            robot.kinematics.ik_batch(spoil(targets))

    @pytest.mark.parametrize("spoiled", [np.nan, np.inf])
    def test_rejects_values_that_are_not_finite_in_single_queries(self, robot, spoiled):
        target = robot.kinematics.fk(reachable(robot, 1))[0]
        for row, column in ((0, 3), (1, 1)):
            wrong = target.copy()
            wrong[row, column] = spoiled
            for ik in (robot.ik, robot.kinematics.ik, robot.chain.ik, robot.chain.ik_solutions):
                with pytest.raises(rc.ArgumentError, match="not finite"):
                    ik(wrong)
        for wrong in (target * [2, 1, 1, 1], target * [1, 1, -1, 1], target[:3], target.ravel()):
            for ik in (robot.ik, robot.chain.ik):
                with pytest.raises(rc.ArgumentError, match=r"matrix (must be|is not|has det)"):
                    ik(wrong)
        seed = robot.arm.joint_pos
        seed[2] = spoiled
        for ik in (robot.ik, robot.chain.ik, robot.chain.ik_solutions):
            with pytest.raises(rc.ArgumentError, match=f"seed of joint 'joint3' is {spoiled}"):
                ik(target, seed=seed)
            with pytest.raises(rc.ArgumentError, match="seed: expected 7 joint values, got 6"):
                ik(target, seed=seed[:6])
            for none in ([], np.empty(0)):
                with pytest.raises(rc.ArgumentError, match="got 0; without one the seed is None"):
                    ik(target, none)
        for call in (robot.kinematics.manipulability, robot.chain.fk, robot.chain.jacobian):
            with pytest.raises(rc.ArgumentError, match=f"joint 'joint3' is {spoiled}"):
                call(seed)
        with pytest.raises(rc.ArgumentError, match=f"joint 'joint3' is {spoiled}"):
            robot.chain.differential_ik(seed, np.zeros(6))
        with pytest.raises(rc.ArgumentError, match="twist has a number that is not finite"):
            robot.kinematics.differential_ik(np.zeros(7), [0, 0, 0, 0, 0, spoiled])

    def test_seeds_that_do_not_fit_are_named(self, robot):
        targets = robot.kinematics.fk(reachable(robot, 3))
        with pytest.raises(rc.ArgumentError, match=r"expected 7 seed values .* or 21"):
            robot.kinematics.ik_batch(targets, seeds=np.zeros((2, 7)))
        for seeds, shape in [
            (np.zeros((7, 3)), r"\(7, 3\)"),  # the right number of values
            (np.zeros(21), r"\(21,\)"),
            (np.zeros((3, 7, 1)), r"\(3, 7, 1\)"),
            (np.zeros(6), r"\(6,\)"),
        ]:
            for ik_batch in (robot.kinematics.ik_batch, robot.chain.ik_batch):
                with pytest.raises(
                    rc.ArgumentError, match=r"seeds must be \(7,\), or .*, has shape " + shape
                ):
                    ik_batch(targets, seeds=seeds)
        for seed in (np.zeros(17), [0.0] * 17):
            with pytest.raises(
                rc.ArgumentError, match=r"seed: expected one value for each joint, .* got 17"
            ):
                robot.kinematics.ik(targets[0], seed)
        for odd in (["0"] * 7, [0j] * 7, [True] * 7, [None] * 7, np.zeros(7, complex)):
            with pytest.raises(rc.ArgumentError, match="seeds must be a list of numbers, got "):
                robot.kinematics.ik_batch(targets, seeds=odd)
            with pytest.raises(rc.ArgumentError, match="jnt_pos_cmd must be a list of numbers"):
                robot.jnt_pos_cmd = odd
        seeds = np.zeros((3, 7))
        seeds[2, 4] = np.nan
        with pytest.raises(rc.ArgumentError, match=r"seeds\[2\]\[4\] is nan"):
            robot.kinematics.ik_batch(targets, seeds=seeds)
