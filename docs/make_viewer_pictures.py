"""Draws docs/viewer_*.png: the viewer with each of its panels, without a display."""

from __future__ import annotations

import contextlib
import tempfile

import numpy as np
from figures import save
from PIL import Image

import robocell as rc

SIZE = (1000, 640)  # px
WIDTH = 720  # px, of the pictures


def cell() -> rc.Scene:
    """The built-in arm beside a table with some objects."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="arm", config=config, control_modes=config.used_modes()))
    colours = {"red": (0.8, 0.1, 0.1), "green": (0.1, 0.6, 0.2), "blue": (0.1, 0.3, 0.8)}
    for i, (name, rgb) in enumerate(colours.items()):
        spec.objects.append(
            rc.SceneObject(
                name=f"{name}_cube",
                shape=rc.Shape.BOX,
                size=[0.035, 0.035, 0.035],
                rgba=[*rgb, 1],
                mass=0.2,
                friction=[0.8, 0.02, 0.001],
                pos=[0.55, 0.15 * (i - 1), 0.035],
            )
        )
    camera = rc.render.CameraSpec(name="overview", pos=[1.8, -1.6, 1.2], fovy=45)
    camera.look_at = [0.3, 0, 0.3]
    spec.cameras.append(camera)
    return rc.Scene.build(spec)


def swing(viewer: rc.viewer.Viewer, robot: rc.Robot, steps: int) -> None:
    """Moves the arm along a curve."""
    home = np.array(robot.jnt_pos_cmd)
    for i in range(steps):
        bend = np.zeros(len(home))
        bend[:4] = [0.7, 0.25, 0.3, 0.35]
        robot.jnt_pos_cmd = home + bend * np.sin(2 * np.pi * i / 1000 * np.arange(1, len(home) + 1))
        robot.update()
        viewer.step()
    robot.jnt_pos_cmd = home


def main() -> None:
    """All panels, one after the other."""
    scene = cell()
    robot = scene.robot("arm")
    viewer = rc.viewer.open(robot, "cell", *SIZE, on_screen=False)
    viewer.realtime_factor = 0
    viewer.set_free_camera(2.1, 140, -22, (0.25, 0, 0.4))

    def picture(name: str, left: str, right: str = "View") -> None:
        viewer.show_panels(left, right)
        viewer.show()
        save(Image.fromarray(viewer.pixels()), f"viewer_{name}.png", WIDTH)

    for _ in range(200):
        robot.update()
        viewer.step()
    viewer.drag_tcp(robot)
    picture("run", "Run", "Joints")
    for name in ("red_cube", "green_cube", "blue_cube"):
        viewer.show_frame("body", name)
    viewer.show_frame("camera", "overview")
    picture("frames", "Frames")
    for name in ("red_cube", "green_cube", "blue_cube"):
        viewer.show_frame("body", name, False)
    viewer.show_frame("camera", "overview", False)
    viewer.trace("tcp", "arm")
    swing(viewer, robot, 1500)
    picture("trace", "Trace")
    viewer.trace("tcp", "arm", False)
    viewer.contacts = True
    viewer.select("red_cube")
    viewer.show_panels("Perturb", "View")
    pull(viewer)
    picture("perturb", "Perturb")
    viewer.post("release", button=3)
    viewer.show()
    viewer.contacts = False
    viewer.select("")
    viewer.realtime_factor = 0.1  # so slow that drawing in software keeps pace
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        viewer.start_recording("recording.mp4", 30, 320, 240)
        for _ in range(200):
            robot.update()
            viewer.step()
        viewer.show_panels("Recorder", "View")
        viewer.show()
        pixels = viewer.pixels()
        viewer.stop_recording()
    save(Image.fromarray(pixels), "viewer_recorder.png", WIDTH)
    viewer.realtime_factor = 0
    viewer.collision_geoms = True
    picture("rtf", "RTF")
    viewer.collision_geoms = False
    picture("controls", "Run", "Controls")
    viewer.close()


def pull(viewer: rc.viewer.Viewer) -> None:
    """Drags the selected body upwards with the right button and Ctrl."""
    x, y = SIZE[0] / 2, SIZE[1] / 2
    viewer.post("move", x, y, control=True)
    viewer.post("press", x, y, button=3, control=True)
    for i in range(10):
        viewer.post("move", x, y + 12 * i, control=True)
    viewer.show()
    for _ in range(60):
        viewer.step()


if __name__ == "__main__":
    main()
