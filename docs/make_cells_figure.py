"""Draws docs/cells.png: the ready-made environments of examples/envs.

python docs/make_cells_figure.py
"""

from __future__ import annotations

from pathlib import Path

from figures import Frame, save, sheet

import robocell as rc
from robocell._window import side_view

ENVS = Path(__file__).parents[1] / "examples" / "envs"
ROWS = (("rc7", "xarm7", "gen3_2f85"), ("panda", "fr3", "fr3_duo"))
SIZE = (320, 280)  # width, height in pixels; drawn at twice the size


def picture(name: str) -> Frame:
    """A cell as its environment's pictures show it, from a little nearer."""
    cell = rc.EnvConfig.load(ENVS / f"{name}.yaml")
    scene = rc.Scene.build(rc.envs.env_scene_spec(cell))
    scene.reset()
    view = side_view(scene, cell)
    view["distance"] *= 0.72 if len(cell.robots) == 1 else 0.9
    view["elevation"] = -32  # environments have no sky
    renderer = rc.render.Renderer(scene, backend="soft", quality="high")
    drawn = renderer.render(rc.render.OrbitCamera(**view), width=2 * SIZE[0], height=2 * SIZE[1])
    frame: Frame = drawn["rgb"]
    return frame


def main() -> None:
    """Draws them."""
    drawn = [[picture(name) for name in row] for row in ROWS]
    save(sheet(drawn), "cells.png", 3 * SIZE[0])


if __name__ == "__main__":
    main()
