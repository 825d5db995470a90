"""Example 11: pours what is in a bottle into a bowl, and puts the bottle back.

What is planned is where the bottle's mouth is to be, and how far the bottle tilts about it; where
the hand has to be follows from how it holds the bottle. The same in C++: 11_pour.cc.

Run: python examples/11_pour.py [folder for picture]
"""

from __future__ import annotations

import math
import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

BEADS = [(x, y, z) for z in (0, 1, 2) for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]  # 12 mm apart
GRASP = rc.Pose(rpy=[0, -math.pi / 2, math.pi])  # of the hand on the bottle: from behind, level
BACK = rc.Pose(translation=[0, 0, -0.12])  # in the hand's own frame
UP = rc.Pose(translation=[0, 0, 0.2])


def build() -> rc.Scene:
    """The built-in robot on a table, a bottle with beads in it, and a bowl."""
    spec = rc.SceneSpec(name="pour", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.base = rc.robots.BaseConfig()  # it needs no pedestal
    config.home["arm"] = np.array([0, 0.755, 0, 1.892, 0, -1.076, 0])  # with the hand level
    spec.robots.append(rc.RobotSpec(name="rc7", config=config, pos=[-0.45, 0, 0.7]))
    spec.objects.append(rc.SceneObject(name="table", mjcf_path="table", pos=[0, 0, 0.7]))
    bottle = rc.SceneObject(name="bottle", mjcf_path="open_bottle", pos=[0.12, -0.12, 0.775])
    bottle.fixed = False
    bowl = rc.SceneObject(name="bowl", mjcf_path="receiver", pos=[0.12, 0.12, 0.74], fixed=True)
    spec.objects.append(bottle)
    spec.objects.append(bowl)
    for i, (x, y, z) in enumerate(BEADS):
        bead = rc.SceneObject(name=f"bead{i}", shape=rc.Shape.SPHERE, size=[0.006, 0, 0])
        bead.pos = [0.12 + 0.012 * x, -0.12 + 0.012 * y, 0.72 + 0.012 * z]
        bead.rgba, bead.mass, bead.friction = [0.95, 0.7, 0.2, 1], 0.002, [0.3, 0.001, 0.0001]
        spec.objects.append(bead)
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


def count(scene: rc.Scene, vessel: str) -> int:
    """How many beads are within 60 mm of the vessel's middle."""
    middle = scene.body_pose(vessel).translation
    places = [scene.body_pose(f"bead{i}").translation for i in range(len(BEADS))]
    return sum(bool(np.linalg.norm(place - middle) < 0.06) for place in places)


def draw(scene: rc.Scene, file: Path) -> None:
    """A picture of the scene as it is."""
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(-0.05, 0.05, 0.88), distance=1, azimuth=150, elevation=-42)
    rc.render.write_png(file, renderer.render(view, 640, 480)["rgb"])


def main(folder: Path) -> None:
    """Takes, pours, puts back; the picture in `folder` shows the pouring."""
    scene = build()
    robot = scene.robot("rc7")
    arm = robot.set_controller("arm", "cartesian_pose")
    arm.max_linear_speed, arm.max_angular_speed = 0.3, 1.5  # m/s, rad/s

    def move(hand: rc.Pose, seconds: float) -> None:
        """Straight towards a pose of the hand in the world, for so long."""
        arm.pose = robot.base_in_world.inverse() * hand
        for _ in range(round(seconds / scene.timestep())):
            robot.update()
            robot.step()

    stand = scene.body_pose("bottle_open_bottle")
    mouth = stand.inverse() * scene.site_pose("bottle_mouth")
    over_bowl = rc.Pose(translation=[0, -0.03, 0.1]) * scene.body_pose("bowl_receiver")
    before = count(scene, "bottle_open_bottle")

    move(stand * GRASP * BACK, 2)
    move(stand * GRASP, 0.8)
    robot.gripper.opening = 0
    move(stand * GRASP, 0.4)
    move(UP * stand * GRASP, 1)

    def hand_for(degrees: int) -> rc.Pose:
        """Of the hand, with the bottle tilted so far about its mouth over the bowl."""
        tilt = rc.Pose(rpy=[-math.radians(degrees), 0, 0])
        return over_bowl * tilt * mouth.inverse() * GRASP

    move(hand_for(70), 1.5)
    for degrees in range(71, 131):
        move(hand_for(degrees), 0.024)
    draw(scene, folder / "picture.png")
    move(hand_for(130), 0.5)
    move(UP * stand * GRASP, 2)
    move(stand * GRASP, 1)
    robot.gripper.opening = 1
    move(stand * GRASP, 0.4)

    poured = count(scene, "bowl_receiver")
    print(f"{before} beads were in the bottle, {poured} are in the bowl")
    assert poured == before == len(BEADS)
    assert scene.body_pose("bottle_open_bottle").is_close(stand, 0.1, 0.01)


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
