"""One side of render.py, in a process of its own: milliseconds of each image as JSON.

render_side.py SIDE ROBOT.yaml VIEW. Sides: soft, gl (robocell's back ends without effects),
soft_standard (shadows and 4 samples a pixel), mujoco (mujoco.Renderer as it is), mujoco_off (the
same without shadows, reflections and multisampling), embree (embree_peer.cc: rays with hard shadows
from C++). An image is colour, depth and segmentation.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from embree import milliseconds

WIDTH, HEIGHT = 640, 480
STATES, WARM = 12, 2
VIEWS = {"whole": (1.6, 130, -25), "near": (0.35, 200, -30)}  # distance, azimuth, elevation


def scene_of(file: str) -> Any:
    """A robot on a floor."""
    import robocell as rc

    config = rc.EnvConfig(robots={"robot": file}, add_floor=True)
    scene = rc.Scene.build(rc.envs.env_scene_spec(config))
    scene.reset()
    return scene


def states(scene: Any) -> list[np.ndarray]:
    """Positions around home, the same in each process."""
    random = np.random.default_rng(5)
    home = scene.data.qpos.copy()
    return [home + random.uniform(-0.1, 0.1, home.shape) for _ in range(WARM + STATES)]


def tip(scene: Any) -> np.ndarray:
    """Where the near view looks: the last body."""
    import mujoco as mj

    mj.mj_forward(scene.model, scene.data)
    return scene.data.xpos[-1].copy()


def view_of(scene: Any, name: str) -> dict[str, Any]:
    """Parameters of an orbit camera."""
    distance, azimuth, elevation = VIEWS[name]
    lookat = tip(scene) if name == "near" else scene.model.stat.center.copy()
    return {"lookat": lookat, "distance": distance, "azimuth": azimuth, "elevation": elevation}


def robocell(scene: Any, view: dict[str, Any], backend: str, quality: str) -> Callable[[], Any]:
    """One call, three images."""
    import robocell as rc

    renderer = rc.render.Renderer(scene, backend=backend, quality=quality)
    camera = rc.render.OrbitCamera(**{**view, "lookat": tuple(view["lookat"])})
    return lambda: renderer.render(camera, WIDTH, HEIGHT, depth=True, segmentation=True)


def mujoco(scene: Any, view: dict[str, Any], effects: bool) -> Callable[[], Any]:
    """Three passes, as its documentation does it."""
    import mujoco as mj

    model, data = scene.model, scene.data
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    if not effects:
        model.vis.quality.offsamples = 0
    renderer = mj.Renderer(model, HEIGHT, WIDTH)
    camera = mj.MjvCamera()
    for name, value in view.items():
        setattr(camera, name, value)
    flags = (mj.mjtRndFlag.mjRND_SHADOW, mj.mjtRndFlag.mjRND_REFLECTION)

    def draw() -> Any:
        mj.mj_kinematics(model, data)
        mj.mj_comPos(model, data)
        mj.mj_camlight(model, data)
        renderer.update_scene(data, camera)
        for flag in flags:
            renderer.scene.flags[flag] = effects
        colour = renderer.render()
        renderer.enable_depth_rendering()
        depth = renderer.render()
        renderer.disable_depth_rendering()
        renderer.enable_segmentation_rendering()
        ids = renderer.render()
        renderer.disable_segmentation_rendering()
        return colour, depth, ids

    return draw


SIDES: dict[str, Callable[[Any, dict[str, Any]], Callable[[], Any]]] = {
    "soft": lambda scene, view: robocell(scene, view, "soft", "fast"),
    "gl": lambda scene, view: robocell(scene, view, "gl", "fast"),
    "soft_standard": lambda scene, view: robocell(scene, view, "soft", "standard"),
    "mujoco": lambda scene, view: mujoco(scene, view, effects=True),
    "mujoco_off": lambda scene, view: mujoco(scene, view, effects=False),
}


def main() -> None:
    """The process."""
    side, file, view = sys.argv[1:]
    scene = scene_of(file)
    if side == "embree":
        with tempfile.TemporaryDirectory() as folder:
            listed = states(scene)
            said = milliseconds(scene.model, listed, view_of(scene, view), Path(folder))
        print(json.dumps(json.loads(said)[WARM:]))
        return
    draw = SIDES[side](scene, view_of(scene, view))
    taken = []
    for state in states(scene):
        scene.data.qpos[:] = state
        begin = time.perf_counter()
        draw()
        taken.append(1e3 * (time.perf_counter() - begin))
    print(json.dumps(taken[WARM:]))


if __name__ == "__main__":
    main()
