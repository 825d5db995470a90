"""Collision-free motions from Python: goals of every form, results, failures, timing."""

from __future__ import annotations

import gc
import math
import weakref

import numpy as np
import pytest

import robocell as rc


def wall_scene() -> rc.Scene:
    spec = rc.SceneSpec(name="plan", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    wall = rc.SceneObject(name="wall", shape=rc.Shape.BOX, size=[0.2, 0.02, 0.35])
    wall.pos, wall.fixed, wall.mass = [0.4, 0, 0.35], True, 1
    wall.rgba, wall.friction = [0.5, 0.5, 0.5, 1], [1, 0.01, 0.001]
    spec.objects.append(wall)
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


@pytest.fixture
def robot() -> rc.Robot:
    """Beside a wall that separates its left from its right."""
    robot = wall_scene().robot("rc7")
    q = np.array(robot.arm.joint_pos)
    q[0] = 0.7
    robot.set_joint_pos(q)
    return robot


def beyond_the_wall(robot: rc.Robot) -> np.ndarray:
    q = np.array(robot.arm.joint_pos)
    q[0] = -0.7
    return q


def test_a_path_avoids_the_wall_and_is_a_pure_function_of_its_seed(robot: rc.Robot) -> None:
    goal = beyond_the_wall(robot)
    result = robot.plan(goal, clearance=0.005, seed=3)
    assert result, result.message
    assert (result.failure, result.message, result.goal) == ("none", "", 0)
    np.testing.assert_array_equal(result.path[0], robot.arm.joint_pos)
    np.testing.assert_array_equal(result.path[-1], goal)
    again = robot.plan(goal, clearance=0.005, seed=3)
    np.testing.assert_array_equal(again.path, result.path)
    free = rc.kinematics.CollisionFilter(robot, clearance=0.0045)
    for a, b in zip(result.path, result.path[1:], strict=False):
        assert free(np.linspace(a, b, 200)).all()


def test_goals_come_in_every_form(robot: rc.Robot) -> None:
    here = np.array(robot.arm.joint_pos)
    goal = beyond_the_wall(robot)
    near = here + np.array([0.2, 0, 0, 0, 0, 0, 0])
    tcp = robot.tcp_in_world
    region = rc.motion.MotionGoal(tcp, position_box=(0.02, 0, 0), free_rotation=(0, 0, math.pi))
    planner = rc.motion.MotionPlanner(robot)
    assert planner.plan(goal).success
    assert planner.plan(list(goal)).success
    assert planner.plan(tcp).success
    assert planner.plan(region).success
    assert planner.plan(np.stack([goal, near])).goal == 1
    mixed: list[rc.Pose | np.ndarray] = [tcp, goal]
    assert planner.plan(mixed).success
    assert planner.plan((region,)).success
    assert planner.plan([goal, rc.Pose(translation=[9, 0, 0]), near]).goal == 2
    assert planner.plan(rc.motion.MotionGoal.at_joints(goal), start=near).path[0][0] == near[0]


def test_failures_are_results_that_say_what_is_wrong(robot: rc.Robot) -> None:
    away = robot.plan(rc.Pose(translation=[9, 0, 0]))
    assert not away
    assert (away.failure, away.goal, away.path.size) == ("goal_unreachable", -1, 0)
    assert "cannot reach its pose" in away.message
    blocked = robot.plan(beyond_the_wall(robot), iterations=0)
    assert blocked.failure == "no_path"
    assert "0 iterations" in blocked.message
    into_the_wall = np.array(robot.arm.joint_pos)
    into_the_wall[0] = 0
    result = robot.plan(into_the_wall)
    assert result.failure == "goal_in_collision"
    assert "'wall'" in result.message
    assert robot.plan(into_the_wall, allowed_contacts=[("wall", "")]).success


def test_arguments_that_do_not_fit_are_errors(robot: rc.Robot) -> None:
    with pytest.raises(rc.ArgumentError, match="goal 0 has 2 joint values, expected 7"):
        robot.plan([0.1, 0.2])
    with pytest.raises(rc.ArgumentError, match="there is no goal"):
        robot.plan([])
    with pytest.raises(rc.NotFoundError, match="Did you mean 'wall'"):
        robot.plan(robot.tcp_in_world, allowed_contacts=[("wal", "")])
    with pytest.raises(rc.ArgumentError, match="clearance"):
        rc.motion.MotionPlanner(robot, clearance=-1)


def test_a_planner_looks_at_the_scene_when_it_plans(robot: rc.Robot) -> None:
    planner = rc.motion.MotionPlanner(robot)
    q = np.array(robot.arm.joint_pos)
    assert planner.joint_names == list(robot.joint_names)
    np.testing.assert_allclose(planner.joint_limits, robot.arm.joint_pos_limits)
    assert planner.is_free(q)
    assert 0 < planner.clearance(q, 0.5) < 0.5
    line = planner.plan_line(rc.Pose(translation=[0, 0, 0.05]) * robot.tcp_in_world)
    assert line.success
    robot.set_joint_pos(line.path[-1])
    np.testing.assert_array_equal(planner.plan(q).path[0], line.path[-1])
    robot.scene.close()
    with pytest.raises(rc.ClosedError):
        planner.plan(q)


def test_paths_are_timed_within_limits() -> None:
    path = np.array([[0.0, 0], [1, 0.5], [0.5, 0.5]])
    motion = rc.motion.time_path(path, velocity=[1, 0.4], acceleration=2, jerk=10)
    assert motion.n_joints == 2
    rows = motion.sample(0.01)
    np.testing.assert_array_equal(rows[[0, -1]], path[[0, -1]])
    assert len(rows) == math.ceil(motion.duration / 0.01) + 1
    states = [motion.at(t) for t in np.linspace(0, motion.duration, 300)]
    assert np.max(np.abs([v for _, v, _ in states]), axis=0)[1] <= 0.4 + 1e-9
    assert np.max(np.abs([a for _, _, a in states])) <= 2 + 1e-9
    assert rc.motion.why_too_slow(path, 60) == ""
    why = rc.motion.why_too_slow(path, 1, ["a", "b"], velocity=[1, 0.1])
    assert why.startswith("limits too tight: the path takes")
    assert "joint 'b' alone" in why
    with pytest.raises(rc.ArgumentError, match="above 0"):
        rc.motion.time_path(path, velocity=0)
    with pytest.raises(rc.ArgumentError, match=r"\(k, n\)"):
        rc.motion.time_path([0.0, 1.0])


def test_an_axis_stays_where_it_is_kept(robot: rc.Robot) -> None:
    up = robot.tcp_in_world.rotation.T @ [0, 0, 1]
    keep = rc.motion.AxisConstraint(up, tolerance=0.2)
    result = robot.plan(beyond_the_wall(robot), keep_axis=keep)
    assert result.success, result.message
    for a, b in zip(result.path, result.path[1:], strict=False):
        for q in np.linspace(a, b, 30):
            turned = (robot.base_in_world * robot.fk_frame(q)).rotation @ up
            assert math.acos(min(1, turned[2])) < 0.201


def test_a_planner_that_its_scene_refers_to_is_collected() -> None:
    class Mark:
        pass

    def cycle() -> weakref.ref[Mark]:
        scene = wall_scene()
        planner, mark = rc.motion.MotionPlanner(scene.robot("rc7")), Mark()
        kept = [planner, mark]
        scene.on_reset(lambda _: kept.reverse())
        return weakref.ref(mark)

    mark = cycle()
    gc.collect()
    assert mark() is None
