"""Draws docs/cell.png, the picture of the README: the built-in robot at a table with objects.

python docs/make_cell_picture.py
"""

from __future__ import annotations

from figures import save

import robocell as rc

SIZE = (960, 540)  # width, height in pixels; drawn at twice the size
TABLE_M = 0.45  # height of the table's top
PEDESTAL_M = [0.22, 0.22, 0.4]
HOLDING = [0.0, 0.25, 0.0, 1.65, 0.0, 1.2416, 0.0]  # rad, the gripper points down

# Name, model or None for a cube, x and y on the table in metres, turn in degrees.
OBJECTS = [
    ("bottle", "bottle", (0.62, -0.24), 0),
    ("mug", "mug", (0.66, 0.22), 60),
    ("bracket", "bracket", (0.47, 0.27), 25),
    ("nut", "nut", (0.5, -0.08), 10),
    ("spool", "spool", (0.74, -0.02), 0),
    ("red", None, (0.49, 0.1), 20),
    ("blue", None, (0.62, 0.06), 65),
]
COLOUR = {"red": [0.85, 0.25, 0.18, 1], "blue": [0.16, 0.42, 0.75, 1]}


def thing(name: str, model: str | None, at: tuple[float, float], turn: float) -> rc.SceneObject:
    """An object a little above the table."""
    pos = [*at, TABLE_M + 0.08]
    if model:
        return rc.SceneObject(name=name, mjcf_path=model, pos=pos, euler=[0, 0, turn], fixed=False)
    return rc.SceneObject(
        name=name, shape=rc.Shape.BOX, size=[0.022, 0.022, 0.022], pos=pos, euler=[0, 0, turn],
        rgba=COLOUR[name], mass=0.08, friction=[0.9, 0.02, 0.001],
    )  # fmt: skip


def cell() -> rc.Scene:
    """The scene, with all objects at rest."""
    spec = rc.SceneSpec(
        name="cell", base="tabletop", timestep=0.002, add_floor=True, add_skybox=True
    )
    spec.root_frame_to_world = rc.Pose()
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.base.size = PEDESTAL_M
    config.home["arm"] = HOLDING
    spec.robots.append(rc.RobotSpec(name="rc7", config=config, pos=[-0.58, 0, 0]))
    for name, model, (x, y), turn in OBJECTS:
        spec.objects.append(thing(name, model, (x - 0.6, y), turn))
    scene = rc.Scene.build(spec)
    scene.reset()
    robot = rc.Robot.of(scene, "rc7")
    for _ in range(1000):
        robot.update()
        scene.step()
    return scene


def main() -> None:
    """Draws it."""
    scene = cell()
    renderer = rc.render.Renderer(
        scene, backend="soft", shadows=True, multisamples=8, shadow_size=4096
    )
    view = rc.render.OrbitCamera(
        lookat=(-0.2, 0, 0.62), distance=1.95, azimuth=143, elevation=-14, fovy=33
    )
    large = renderer.render(view, width=2 * SIZE[0], height=2 * SIZE[1])["rgb"]
    save(large, "cell.png", SIZE[0])


if __name__ == "__main__":
    main()
