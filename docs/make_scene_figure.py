"""Draws docs/scene_parts.png: a scene, with the names that its parts have.

Names are drawn where the scene says that the parts are, through the camera that drew them.
"""

from __future__ import annotations

import numpy as np
from figures import save
from PIL import Image, ImageDraw, ImageFont

import robocell as rc

WIDTH, HEIGHT = 1920, 1200  # px; written at half the size
FONT = ImageFont.load_default(30)
VIEW = rc.render.OrbitCamera(
    lookat=(0.05, 0.05, 0.55), distance=2.3, azimuth=128, elevation=-19, fovy=36
)
NAMES = [  # what is written, the element that it points to, where it is written in pixels
    ("robot 'left', prefix left_", ("body", "left_link3"), (70, 250)),
    ("its TCP: site left_tcp", ("site", "left_tcp"), (70, 500)),
    ("its base: body left_mocap_base", ("body", "left_mocap_base"), (70, 900)),
    ("robot 'right', prefix right_", ("body", "right_link3"), (1330, 130)),
    ("model object 'mug': body mug_mug", ("body", "mug_mug"), (90, 1080)),
    ("primitive 'cube': body cube, geom cube_geom", ("body", "cube"), (760, 1120)),
    ("camera 'front'", ("camera", "front"), (1550, 820)),
    ("base scene 'tabletop': site table_top", ("site", "table_top"), (1270, 980)),
]


def build() -> rc.Scene:
    """Two robots at a table, two objects and a camera."""
    spec = rc.SceneSpec(name="parts", base="tabletop", add_floor=True, add_skybox=True)
    spec.timestep = 0.002
    for name, y in (("left", -0.42), ("right", 0.42)):
        config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
        config.base.size = [0.22, 0.22, 0.4]
        spec.robots.append(rc.RobotSpec(name=name, config=config, prefix=f"{name}_"))
        spec.robots[-1].pos = [-0.55, y, 0]
    mug = rc.SceneObject(name="mug", mjcf_path="mug", pos=[-0.08, -0.3, 0.5], fixed=False)
    cube = rc.SceneObject(
        name="cube", shape=rc.Shape.BOX, size=[0.025] * 3, pos=[-0.12, 0.02, 0.48]
    )
    cube.rgba, cube.mass, cube.friction = [0.85, 0.25, 0.18, 1], 0.1, [1, 0.02, 0.001]
    spec.objects.extend([mug, cube])
    spec.cameras.append(
        rc.render.CameraSpec(name="front", pos=[0.55, 0.5, 0.75], look_at=[0, 0, 0.5], fovy=45)
    )
    scene = rc.Scene.build(spec)
    scene.reset()
    for _ in range(500):
        for robot in scene.robots:
            robot.update()
        scene.step()
    return scene


def main() -> None:
    """Draws it."""
    scene = build()
    renderer = rc.render.Renderer(scene, backend="soft", quality="high")
    front = scene.camera_pose("front")
    view = front * rc.Pose(translation=[0, 0, 0], quaternion=[1, 0, 0, 0])  # z along the view
    image = renderer.render(VIEW, WIDTH, HEIGHT, frames=[("", view)], frame_length=0.12)
    picture = Image.fromarray(np.ascontiguousarray(image["rgb"]))
    pen = ImageDraw.Draw(picture)
    for text, (kind, name), at in NAMES:
        pose = getattr(scene, f"{kind}_pose")(name)
        in_camera = image["extrinsics"] @ [*pose.translation, 1]
        u, v, _ = image["intrinsics"] @ in_camera[:3] / in_camera[2]
        box = pen.textbbox(at, text, FONT)
        x = min(max(u, box[0]), box[2])
        y = box[3] if v > box[3] else box[1]
        pen.line([(x, y), (u, v)], fill="black", width=3)
        pen.ellipse([u - 8, v - 8, u + 8, v + 8], fill="white", outline="black", width=3)
        pen.rectangle([box[0] - 10, box[1] - 8, box[2] + 10, box[3] + 8], fill="white")
        pen.text(at, text, fill="black", font=FONT)
    save(picture, "scene_parts.png", WIDTH // 2)


if __name__ == "__main__":
    main()
