"""Draws docs/equipment.png: the built-in equipment and objects, named in docs/assets.md.

python docs/make_equipment_picture.py
"""

from __future__ import annotations

from figures import save

import robocell as rc

SIZE = (960, 540)  # width, height in pixels; drawn at twice the size
TABLE_M = 0.7
# Model, x and y on the table and height of its origin in metres, turn in degrees.
ON_TABLE = [
    ("ft_sensor", (-0.4, -0.2, 0.0), 0),
    ("open_bottle", (-0.22, 0.18, 0.075), 0),
    ("receiver", (-0.05, -0.12, 0.04), 0),
    ("bottle", (0.1, 0.2, 0.07), 0),
    ("mug", (0.22, -0.18, 0.04), 30),
    ("spool", (0.32, 0.14, 0.028), 0),
    ("nut", (0.42, -0.2, 0.016), 15),
    ("bracket", (0.5, 0.08, 0.025), -40),
]


def showroom() -> rc.Scene:
    """Everything at rest, the cabinet opened a little."""
    spec = rc.SceneSpec(name="equipment", timestep=0.002, add_floor=True, add_skybox=True)
    spec.objects.append(
        rc.SceneObject(name="table", mjcf_path="table", pos=[0, 0, TABLE_M], fixed=True)
    )
    spec.objects.append(
        rc.SceneObject(
            name="cabinet", mjcf_path="cabinet", pos=[1.1, 0.15, 0], euler=[0, 0, -90], fixed=True
        )
    )
    for name, (x, y, z), turn in ON_TABLE:
        spec.objects.append(
            rc.SceneObject(
                name=name, mjcf_path=name, pos=[x, y, TABLE_M + z], euler=[0, 0, turn], fixed=False
            )
        )
    scene = rc.Scene.build(spec)
    for joint, value in (("cabinet_door_hinge", 1.1), ("cabinet_drawer_slide", 0.16)):
        scene.data.joint(joint).qpos[0] = value
    scene.forward()
    scene.step_n(300)
    return scene


def main() -> None:
    """Draws it."""
    renderer = rc.render.Renderer(showroom(), backend="soft", quality="high")
    view = rc.render.OrbitCamera(
        lookat=(0.42, 0, 0.48), distance=2.6, azimuth=104, elevation=-24, fovy=36
    )
    large = renderer.render(view, width=2 * SIZE[0], height=2 * SIZE[1])["rgb"]
    save(large, "equipment.png", SIZE[0])


if __name__ == "__main__":
    main()
