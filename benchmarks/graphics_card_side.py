"""One process of graphics_card.py: images a second between two times of the clock.

graphics_card_side.py SIDE ROBOT.yaml: says "ready", reads the two times, and draws 640x480 colour
images of a robot in states around home. Sides: those of render_side.py, in colour only.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Callable
from typing import Any

from render_side import HEIGHT, WIDTH, scene_of, states, view_of


def robocell(scene: Any, view: dict[str, Any]) -> Callable[[], Any]:
    """Back end `gl` without effects."""
    import robocell as rc

    renderer = rc.render.Renderer(scene, backend="gl", quality="fast")
    camera = rc.render.OrbitCamera(**{**view, "lookat": tuple(view["lookat"])})
    return lambda: renderer.render(camera, WIDTH, HEIGHT)


def mujoco(scene: Any, view: dict[str, Any]) -> Callable[[], Any]:
    """`mujoco.Renderer` without effects."""
    import mujoco as mj

    model, data = scene.model, scene.data
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    model.vis.quality.offsamples = 0
    renderer = mj.Renderer(model, HEIGHT, WIDTH)
    camera = mj.MjvCamera()
    for name, value in view.items():
        setattr(camera, name, value)

    def draw() -> Any:
        mj.mj_kinematics(model, data)
        mj.mj_comPos(model, data)
        mj.mj_camlight(model, data)
        renderer.update_scene(data, camera)
        for flag in (mj.mjtRndFlag.mjRND_SHADOW, mj.mjtRndFlag.mjRND_REFLECTION):
            renderer.scene.flags[flag] = False
        return renderer.render()

    return draw


def main() -> None:
    """The process."""
    side, file = sys.argv[1:]
    scene = scene_of(file)
    draw = {"gl": robocell, "mujoco_off": mujoco}[side](scene, view_of(scene, "whole"))
    all_states = itertools.cycle(states(scene))
    for _ in range(20):
        scene.data.qpos[:] = next(all_states)
        draw()
    print("ready", flush=True)
    begin, end = (float(number) for number in sys.stdin.readline().split())
    time.sleep(max(0.0, begin - time.time()))
    images = 0
    while time.time() < end:
        scene.data.qpos[:] = next(all_states)
        draw()
        images += 1
    print(images / (time.time() - begin))


if __name__ == "__main__":
    main()
