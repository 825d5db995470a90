"""Example 3: a robot of your own: its model, ten lines of YAML, and what they make possible.

The robot is desk6/desk6.yaml, a six-axis arm made for this example. The example uses its forward
and inverse kinematics, moves its gripper, and shows the error for a mistake in its file.
The same in C++: 03_own_robot.cc. Run: python examples/03_own_robot.py [folder for the picture]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

ROBOT = Path(__file__).parent / "desk6" / "desk6.yaml"
DOWN = [0, 1, 0, 0]  # quaternion xyzw: the tool points down, as it does at home


def scene_with(config: rc.RobotConfig) -> rc.Scene:
    """The robot alone on a floor, at home."""
    spec = rc.SceneSpec(name="desk", timestep=0.002, add_floor=True, add_skybox=True)
    spec.robots.append(rc.RobotSpec(name="desk6", config=config))
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


def main(folder: Path) -> None:
    """Asks the robot what it can do; draws its frames into `folder`."""
    scene = scene_with(rc.RobotConfig.load(ROBOT))
    robot = rc.Robot.of(scene, "desk6")
    print(f"{robot.name}: {robot.n_joints} joints, reaches {robot.reach:.2f} m")

    # Forward kinematics: the TCP in the robot base frame. The engine must agree.
    tcp = robot.kinematics.fk(robot.arm.joint_pos)
    assert tcp.is_close(robot.base_in_world.inverse() * scene.site_pose(f"{robot.prefix}tcp"))
    print("at home the TCP is at {:.3f} {:.3f} {:.3f}".format(*tcp.translation))

    # Inverse kinematics of many poses at once: the tool pointing down, on a grid before the robot.
    grid = [(0.1 * i, 0.1 * j) for i in range(1, 8) for j in range(-6, 7)]
    poses = [rc.Pose(translation=[x, y, 0.15], quaternion=DOWN) for x, y in grid]
    found = robot.kinematics.ik_batch(np.array([pose.matrix for pose in poses]))
    print(f"of {len(poses)} points {np.sum(found.success)} can be reached")
    for q, success, pose in zip(found.q, found.success, poses, strict=True):
        assert not success or robot.kinematics.fk(q).is_close(pose, 1e-5, 1e-5)

    # The gripper: 0 is closed, 1 is open, whatever its motor calls it. Its distances were measured.
    for opening in (0, 0.5, 1):
        robot.gripper.opening = opening
        for _ in range(500):
            robot.update()
            scene.step()
        print(f"opening {opening}: fingers {robot.gripper.inter_finger_dist:.3f} m apart")

    # An error in a file contains its place and the available names.
    text = ROBOT.read_text().replace("joints: [left, right]", "joints: [left, rihgt]")
    try:
        scene_with(rc.RobotConfig.from_yaml(text, "desk6.yaml", ROBOT.parent))
    except rc.SpecError as error:
        print(error)

    reached = [pose for pose, success in zip(poses, found.success, strict=True) if success]
    frames = [("base", robot.base_in_world), ("tcp", robot.tcp_in_world)]
    frames += [("", robot.base_in_world * pose) for pose in reached]
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(0.28, 0, 0.28), distance=1.2, azimuth=125, elevation=-25)
    image = renderer.render(view, 640, 480, frames=frames, frame_length=0.05)
    rc.render.write_png(folder / "picture.png", image["rgb"])


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
