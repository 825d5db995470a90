"""Example 8: objects come and go while the robot moves.

A bottle is added by compiling the scene anew: everything else goes on to the bit. Cubes come from
the scene's pool, which takes microseconds, and a reset hook chooses which of them the next episode
has. The same in C++: 08_come_and_go.cc. Run: python examples/08_come_and_go.py [folder for picture]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

WIDTH, HEIGHT = 320, 240


def build() -> rc.Scene:
    """The built-in robot, a camera, and a pool of four cubes."""
    spec = rc.SceneSpec(name="come_and_go", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    for i in range(4):
        cube = rc.SceneObject(name=f"cube{i}", shape=rc.Shape.BOX, size=[0.03, 0.03, 0.03])
        cube.pos, cube.rgba = [0.5, 0.12 * i - 0.18, 0.03], [0.9, 0.2 + 0.2 * i, 0.2, 1]
        cube.mass, cube.friction = 0.1, [0.8, 0.02, 0.001]
        cube.parked = True  # of the pool, and outside of the scene after a reset
        spec.objects.append(cube)
    front = rc.render.CameraSpec(
        name="front", pos=[1.3, 0.75, 0.85], look_at=[0.25, 0, 0.3], fovy=50
    )
    spec.cameras.append(front)
    return rc.Scene.build(spec)


def main(folder: Path) -> None:
    """Adds, removes, resets; the picture in `folder` shows three moments."""
    scene = build()
    robot, renderer = scene.robot("rc7"), rc.render.Renderer(scene, quality="standard")
    pictures = []

    def run(steps: int) -> None:
        for _ in range(steps):
            robot.update()
            robot.step()

    def report(what: str) -> None:
        there, parked = " ".join(scene.object_names), " ".join(scene.parked_objects)
        print(f"{scene.time():.3f} s, {what}: there are [{there}], parked [{parked}]")

    def picture() -> None:
        pictures.append(renderer.render("front", WIDTH, HEIGHT)["rgb"])

    # By compiling, in the middle of a motion. The handles stay.
    robot.jnt_pos_cmd[0] += 0.6
    run(100)
    moving = robot.arm.joint_vel.copy()
    bottle = rc.SceneObject(name="bottle", mjcf_path="bottle", pos=[0.65, 0.2, 0.09], fixed=False)
    scene.add_object(bottle)
    assert np.array_equal(robot.arm.joint_vel, moving)
    report("a bottle")
    run(400)
    print(f"the arm went on to {robot.arm.joint_pos[0]:.3f} rad")
    picture()

    # From the pool. Nothing is compiled.
    model = scene.model
    for i in range(4):
        scene.add_object(f"cube{i}", [0.45, -0.2, 0.05 + 0.07 * i])
        run(50)
    run(300)
    assert scene.model is model
    report("four cubes")
    print(f"the highest stands at {1000 * scene.body_pose('cube3').translation[2]:.0f} mm")
    picture()

    # An invalid change is rejected with the reason, and changes nothing.
    try:
        scene.add_object(bottle)
    except rc.ArgumentError as error:
        print(error)
    scene.remove_object("bottle")
    scene.remove_object("cube1")
    report("less")

    # The pool is the spec's after a reset; a hook chooses what the episode has.
    scene.on_reset(lambda reset: reset.scene.add_object("cube2"))
    scene.reset()
    report("reset")
    picture()
    rc.render.write_png(folder / "picture.png", np.hstack(pictures))


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
