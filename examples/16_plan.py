"""Example 16: plans motions around obstacles, to any of a set of grasps, with a cube in the hand.

The goal of the first motion is a region: above the cube, the fingers turned as they like. The
second motion carries the cube around a wall, upright. Both are timed within limits of velocity,
acceleration and jerk, and driven.
The same in C++: 16_plan.cc. Run: python examples/16_plan.py [folder for picture]
"""

from __future__ import annotations

import math
import sys
import tempfile
from pathlib import Path

import robocell as rc

DOWN = rc.Pose(rpy=[math.pi, 0, 0])  # the approach axis points down
RAISED = rc.Pose(translation=[0, 0, 0.12])
LIMITS = {"velocity": 1.5, "acceleration": 5.0, "jerk": 60.0}
CUBE, PLACE = [0.42, 0.25, 0.22], [0.42, -0.25, 0.22]  # m


def block(name: str, size: list[float], pos: list[float]) -> rc.SceneObject:
    """A box; half its lengths, and its centre."""
    made = rc.SceneObject(name=name, shape=rc.Shape.BOX, size=size, pos=pos)
    made.rgba, made.mass, made.friction = [0.9, 0.5, 0.2, 1], 0.1, [1, 0.02, 0.001]
    return made


def build() -> rc.Scene:
    """The built-in robot, a cube on a table, and a wall between the cube and its place."""
    spec = rc.SceneSpec(name="plan", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    for fixed in (
        block("table", [0.2, 0.4, 0.1], [0.5, 0, 0.1]),
        block("wall", [0.2, 0.02, 0.15], [0.5, 0, 0.35]),
    ):
        fixed.fixed, fixed.rgba = True, [0.5, 0.6, 0.7, 1]
        spec.objects.append(fixed)
    spec.objects.append(block("cube", [0.02, 0.02, 0.02], CUBE))
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


def require(result: rc.motion.MotionResult) -> rc.motion.MotionResult:
    """A motion that was found."""
    if not result.success:
        raise rc.Error(result.message)
    return result


def drive(robot: rc.Robot, result: rc.motion.MotionResult) -> rc.motion.Trajectory:
    """Moves the arm along a path and comes to rest."""
    motion = rc.motion.time_path(require(result).path, **LIMITS)
    tick = robot.scene.timestep()
    for q in motion.sample(tick):
        robot.jnt_pos_cmd = q
        robot.update()
        robot.step()
    wait(robot, 0.3)
    return motion


def wait(robot: rc.Robot, seconds: float) -> None:
    """Lets the fingers and the arm come to rest."""
    for _ in range(round(seconds / robot.scene.timestep())):
        robot.update()
        robot.step()


def above(place: list[float]) -> rc.motion.MotionGoal:
    """The TCP over a place, the fingers turned as they like."""
    tcp = rc.Pose(translation=place) * RAISED * DOWN
    return rc.motion.MotionGoal(tcp, free_rotation=(0, 0, math.pi))


def lowered(robot: rc.Robot, place: list[float]) -> rc.Pose:
    """The TCP at a place, turned as it is."""
    return rc.Pose(translation=place, quaternion=robot.tcp_in_world.quaternion)


def main(folder: Path) -> None:
    """Carries the cube around the wall, and draws it into `folder`."""
    scene = build()
    robot = scene.robot("rc7")
    robot.gripper.opening = 1

    free_hand = rc.motion.MotionPlanner(robot, clearance=0.005)
    result = free_hand.plan(above(CUBE), seed=1)
    motion = drive(robot, result)
    print(f"above the cube: {len(result.path)} waypoints, {motion.duration:.2f} s")
    drive(robot, free_hand.plan_line(lowered(robot, CUBE)))
    robot.gripper.opening = 0
    wait(robot, 0.5)
    assert robot.gripper.is_grasping("cube")

    # Off the table: the cube may touch everything. Then it moves with the hand, and nothing but the
    # hand may touch it.
    touching = rc.motion.MotionPlanner(robot, allowed_contacts=[("cube", "")])
    drive(robot, touching.plan_line(RAISED * robot.tcp_in_world))
    upright = rc.motion.AxisConstraint([0, 0, -1], tolerance=0.25)
    carrying = rc.motion.MotionPlanner(
        robot, clearance=0.005, attached=[("cube", robot.prefix + "hand")], keep_axis=upright
    )
    result = carrying.plan(above(PLACE), seed=1)
    motion = drive(robot, result)
    print(f"around the wall: {len(result.path)} waypoints, {motion.duration:.2f} s")
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(0.35, 0, 0.35), distance=1.5, azimuth=200, elevation=-30)
    rc.render.write_png(folder / "picture.png", renderer.render(view, 640, 480)["rgb"])

    drive(robot, touching.plan_line(lowered(robot, PLACE)))
    robot.gripper.opening = 1
    wait(robot, 0.5)
    x, y, _ = scene.body_pose("cube").translation
    off = math.hypot(x - PLACE[0], y - PLACE[1])
    print(f"the cube is within {10 * math.ceil(100 * off):.0f} mm of its place")
    assert off < 0.02

    result = free_hand.plan(rc.Pose(translation=[3, 0, 0.5]))
    print(f"3 m away: {result.failure}")


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
