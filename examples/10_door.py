"""Example 10: pulls a drawer and opens a hinged door by their handles, with a soft arm.

Neither path has to be exact: the arm is a spring (Cartesian impedance), and the handle leads it.
The same in C++: 10_door.cc. Run: python examples/10_door.py [folder for picture]
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import robocell as rc

# The hand in front of a handle, as seen from the handle's site (x points out of the cabinet): the
# approach axis into it, and the fingers on both sides of an upright bar, or of a level one.
UPRIGHT = rc.Pose(rpy=[0, -math.pi / 2, 0])
FROM_ABOVE = UPRIGHT * rc.Pose(rpy=[0, 0, math.pi / 2]) * rc.Pose(rpy=[-0.5, 0, 0])
BEFORE = rc.Pose(translation=[0, 0, -0.1])  # 10 cm back, in the hand's own frame


def build() -> rc.Scene:
    """The built-in robot in front of the cabinet."""
    spec = rc.SceneSpec(name="door", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    cabinet = rc.SceneObject(name="cabinet", mjcf_path="cabinet", fixed=True)
    cabinet.pos, cabinet.euler = [0.85, -0.05, 0], [0, 0, 180]
    spec.objects.append(cabinet)
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


class Hand:
    """The gripper at the end of a soft arm; poses are the TCP's in the world."""

    def __init__(self, robot: rc.Robot) -> None:
        self.robot = robot
        self.spring = robot.set_controller("arm", "cartesian_impedance")
        self.spring.stiffness = [2000, 2000, 2000, 80, 80, 80]  # N/m, then Nm/rad
        self.pose = robot.tcp_in_world  # where the springs draw it to

    def follow(self, path: Callable[[float], rc.Pose], seconds: float) -> None:
        """Along the poses path(0) to path(1), starting and ending at rest."""
        ticks = round(seconds / self.robot.scene.timestep())
        for i in range(1, ticks + 1):
            self.pose = path(rc.control.minimum_jerk(i, ticks).position)
            self.spring.pose = self.robot.base_in_world.inverse() * self.pose
            self.robot.update()
            self.robot.step()

    def move(self, goal: rc.Pose, seconds: float) -> None:
        """There on a straight line."""
        start = self.pose
        self.follow(lambda s: start.interpolate(goal, s), seconds)

    def wait(self, seconds: float) -> None:
        """Comes to rest."""
        self.move(self.pose, seconds)

    def take(self, handle: rc.Pose) -> None:
        """Grips a handle from in front of it."""
        self.robot.gripper.opening = 0.4  # open wide they would touch the panel behind the bar
        self.move(handle * BEFORE, 1.5)
        self.move(handle, 0.6)
        self.wait(0.3)
        self.robot.gripper.opening = 0
        self.wait(0.3)

    def let_go(self) -> None:
        """Opens and goes back."""
        self.wait(0.3)
        self.robot.gripper.opening = 0.4
        self.wait(0.3)
        self.move(self.pose * BEFORE, 0.6)


def main(folder: Path) -> None:
    """Opens both, and draws the cabinet into `folder`."""
    scene = build()
    hand = Hand(scene.robot("rc7"))

    hand.take(scene.site_pose("cabinet_drawer_handle") * FROM_ABOVE)
    hand.move(rc.Pose(translation=[-0.2, 0, 0]) * hand.pose, 1.5)
    hand.let_go()
    drawer = scene.joint_pos("cabinet_drawer_slide")
    print(f"the drawer is open by {1000 * drawer:.0f} mm")

    hinge = scene.body_pose("cabinet_door")
    hand.take(scene.site_pose("cabinet_door_handle") * UPRIGHT)
    grasp = hand.pose

    def arc(s: float) -> rc.Pose:
        angle = s * math.radians(70)
        bar = hinge * rc.Pose(rpy=[0, 0, angle]) * hinge.inverse() * grasp
        # The fingers can turn around the bar: the hand turns half as far as the door.
        return bar * rc.Pose(rpy=[-angle / 2, 0, 0])

    hand.follow(arc, 2.5)
    hand.let_go()
    door = math.degrees(scene.joint_pos("cabinet_door_hinge"))
    print(f"the door is open by {door:.0f} degrees")

    assert abs(drawer - 0.2) < 0.01
    assert abs(door - 70) < 3
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(0.4, 0, 0.35), distance=1.75, azimuth=-65, elevation=-30)
    rc.render.write_png(folder / "picture.png", renderer.render(view, 640, 480)["rgb"])


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
