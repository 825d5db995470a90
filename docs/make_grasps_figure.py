"""Draws docs/grasps.png: grasps of the built-in arm's hand on a mug and on a bottle.

python docs/make_grasps_figure.py
"""

from __future__ import annotations

import numpy as np
from figures import save

import robocell as rc

SIZE = (960, 480)  # width, height in pixels; drawn at twice the size
MOST = 4  # grasps drawn of each kind
RADIAN_M = 0.03  # a turn by one radian counts like this distance
HEIGHT = 0.3  # m, of the objects
COLOURS = {
    "top": [0.20, 0.45, 0.75, 1],
    "side": [0.25, 0.60, 0.40, 1],
    "antipodal": [0.50, 0.50, 0.55, 1],
    "rim": [0.85, 0.50, 0.15, 1],
    "handle": [0.70, 0.25, 0.35, 1],
}


def scene_of(objects: list[rc.SceneObject]) -> rc.Scene:
    """Objects in front of the built-in arm."""
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config, pos=[2, 0, 0]))
    for each in objects:
        spec.objects.append(each)
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


def thing(name: str, y: float) -> rc.SceneObject:
    """A built-in object that stays in the air."""
    return rc.SceneObject(name=name, mjcf_path=name, pos=[0, y, HEIGHT], fixed=True)


def spread(grasps: rc.tasks.GraspSet) -> list[rc.tasks.Grasp]:
    """The best grasp, and then each time the one that is farthest from those before."""
    chosen = [grasps[0]] if len(grasps) else []

    def apart(grasp: rc.tasks.Grasp) -> float:
        return min(distance(grasp.tcp_in_body, other.tcp_in_body) for other in chosen)

    while chosen and len(chosen) < MOST:
        chosen.append(max(grasps, key=apart))
    return chosen


def distance(a: rc.Pose, b: rc.Pose) -> float:
    """Metres, where a radian counts like some centimetres."""
    step = a.inverse() * b
    return float(np.linalg.norm(step.translation)) + RADIAN_M * step.angle


def fork(name: str, tcp: rc.Pose, grasp: rc.tasks.Grasp) -> list[rc.SceneObject]:
    """Two fingers, what carries them, and the approach, as thin bars."""
    half, length, thin = grasp.width / 2 + 0.003, 0.02, 0.0012
    bars = [
        ([0, half, -length / 2], [thin, thin, length / 2]),
        ([0, -half, -length / 2], [thin, thin, length / 2]),
        ([0, 0, -length], [thin, half, thin]),
        ([0, 0, -1.5 * length], [thin, thin, length / 2]),
    ]
    made = []
    for i, (at, size) in enumerate(bars):
        pose = tcp * rc.Pose(translation=at)
        bar = rc.SceneObject(name=f"{name}_{i}", shape=rc.Shape.BOX, size=size, fixed=True)
        bar.pos, bar.quat = list(pose.translation), list(pose.quaternion)
        bar.rgba, bar.mass, bar.friction = COLOURS[grasp.kind], 1, [1, 0.01, 0.001]
        made.append(bar)
    return made


def main() -> None:
    """Draws it."""
    objects = [thing("mug", -0.09), thing("bottle", 0.09)]
    scene = scene_of(objects)
    forks = []
    for each in objects:
        for kind in COLOURS:
            grasps = rc.tasks.grasps(scene.robot("rc7"), each.name, kinds=kind)
            for i, grasp in enumerate(spread(grasps)):
                tcp = scene.body_pose(grasps.body) * grasp.tcp_in_body
                forks += fork(f"{each.name}_{kind}_{i}", tcp, grasp)
    drawn = scene_of(objects + forks)
    view = rc.render.OrbitCamera(
        lookat=(0, 0, HEIGHT + 0.01), distance=0.5, azimuth=180, elevation=-25, fovy=26
    )
    renderer = rc.render.Renderer(drawn, shadows=True, multisamples=4, shadow_size=8192)
    large = renderer.render(view, width=2 * SIZE[0], height=2 * SIZE[1])
    save(np.ascontiguousarray(large["rgb"]), "grasps.png", SIZE[0])


if __name__ == "__main__":
    main()
