"""Example 5: cameras: colour, depth in metres, who is seen in each pixel, and a video.

Everything that is measured in an image is compared with the scene: a point is projected into the
image, and pixels are turned back into points.
The same in C++: 05_cameras.cc. Run: python examples/05_cameras.py [folder for picture and video]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

WIDTH, HEIGHT = 320, 240
COLOURS = np.array([[230, 60, 50], [50, 130, 220], [250, 190, 40], [60, 170, 90], [150, 90, 200]])


def build() -> rc.Scene:
    """Returns the built-in robot with three objects before it, and a camera on the floor."""
    spec = rc.SceneSpec(name="cameras", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    for name, at in (("mug", [0.55, -0.15, 0.04]), ("bottle", [0.6, 0.15, 0.09])):
        spec.objects.append(rc.SceneObject(name=name, mjcf_path=name, pos=at, fixed=False))
    ball = rc.SceneObject(name="ball", shape=rc.Shape.SPHERE, size=[0.04, 0, 0])
    ball.pos, ball.rgba = [0.45, 0, 0.04], [0.9, 0.3, 0.2, 1]
    ball.mass, ball.friction = 0.1, [0.8, 0.02, 0.001]
    spec.objects.append(ball)
    front = rc.render.CameraSpec(
        name="front", pos=[1.3, 0.75, 0.85], look_at=[0.25, 0, 0.4], fovy=50
    )
    spec.cameras.append(front)
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


def main(folder: Path) -> None:
    """Renders, measures, and films into `folder`."""
    scene = build()
    renderer = rc.render.Renderer(scene, quality="standard")
    image = renderer.render("front", WIDTH, HEIGHT, depth=True, segmentation=True)
    rgb, depth, bodies = image["rgb"], image["depth"], image["segmentation"]
    names = [scene.model.body(i).name for i in range(scene.model.nbody)]
    print(f"cameras: {' '.join(scene.camera_names())}")
    print("pixels of mug, bottle, ball:", end="")
    for body in ("mug_mug", "bottle_bottle", "ball"):
        print(f" {np.sum(bodies == names.index(body))}", end="")

    # From the world into the image: intrinsics and extrinsics are OpenCV's.
    ball = scene.body_pose("ball").translation
    in_camera = image["extrinsics"] @ [*ball, 1]
    u, v, _ = image["intrinsics"] @ (in_camera[:3] / in_camera[2])
    column, row = round(u), round(v)
    print(f"\nthe ball's middle is at pixel {u:.1f} {v:.1f}, {in_camera[2]:.3f} m from the camera")
    assert names[bodies[row, column]] == "ball"
    print(f"there the depth image says {depth[row, column]:.3f} m, of the surface")

    # And back: every pixel of the ball is a point on its surface.
    rows, columns = np.nonzero(bodies == names.index("ball"))
    pixels = np.stack([columns, rows, np.ones(len(rows))])
    points = np.linalg.inv(image["intrinsics"]) @ pixels * depth[rows, columns]
    points = np.linalg.inv(image["extrinsics"]) @ np.vstack([points, np.ones(len(rows))])
    radius = np.linalg.norm(points[:3].T - ball, axis=1)
    print(f"its {len(rows)} pixels lie {1000 * np.median(radius):.1f} mm from its middle")
    assert np.max(np.abs(radius - 0.04)) < 0.002

    # A picture of all three: colour, depth (near is bright), and a colour for each body.
    near = np.clip((2.3 - depth) / 1.6, 0, 1) * (depth > 0)
    grey = (255 * near).astype(np.uint8)[..., None].repeat(3, axis=2)
    ids = np.where(bodies[..., None] > 0, COLOURS[bodies % len(COLOURS)], 235).astype(np.uint8)
    rc.render.write_png(folder / "picture.png", np.hstack([rgb, grey, ids]))

    # A video: one call, one frame. The camera goes around the robot.
    with rc.render.VideoRecorder(scene, folder / "around.mp4", WIDTH, HEIGHT, fps=30) as video:
        for degrees in range(0, 360, 6):
            video.set_free_camera(1.8, degrees, -20, (0.3, 0, 0.3))
            video.record_frame()
    print(f"around.mp4: {video.frames} frames")


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
