"""Draws docs/houses_top.png and docs/houses_kitchen.png: generated houses from above and inside."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from figures import save, sheet

import robocell as rc
from robocell.scenes import HouseOptions, make_house, prepare_house_folder

OPTIONS = HouseOptions(seed=7, rooms=(3, 5), most_objects=40)
HOUSES = (0, 1)
WIDTH, HEIGHT = 760, 560


def scene_of(file: Path) -> rc.Scene:
    """The house in this file."""
    return rc.Scene.build(rc.SceneSpec(name=file.stem, base=str(file), timestep=0.002))


def from_above(file: Path) -> np.ndarray:
    """The house without its ceiling."""
    scene = scene_of(file)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in range(scene.model.ngeom):
        low = np.minimum(low, scene.data.geom_xpos[geom])
        high = np.maximum(high, scene.data.geom_xpos[geom])
    middle = (low + high) / 2
    view = rc.render.OrbitCamera(
        lookat=(middle[0], middle[1], 0.3),
        distance=1.45 * float(max(high[:2] - low[:2])),
        azimuth=90,
        elevation=-62,
        fovy=45,
    )
    renderer = rc.render.Renderer(scene, backend="soft", quality="standard")
    return renderer.render(view, WIDTH, HEIGHT)["rgb"]


def kitchen(file: Path) -> np.ndarray:
    """A kitchen, seen from the corner that is farthest from its sink."""
    scene = scene_of(file)
    model, data = scene.model, scene.data
    names = [model.body(body).name for body in range(model.nbody)]
    room = next(name for name in names if name.startswith("room_") and name.endswith("kitchen"))
    sink = next(data.body(name).xpos for name in names if name.startswith("sink_"))
    floor = data.body(room).xpos
    half = model.geom(f"{room}_floor").size
    corner = floor - np.sign(sink - floor + 1e-6) * (half - 0.25)
    spec = rc.SceneSpec(name="kitchen", base=str(file), timestep=0.002)
    spec.cameras.append(
        rc.render.CameraSpec(
            name="inside",
            pos=[corner[0], corner[1], 1.75],
            look_at=[*(0.7 * sink[:2] + 0.3 * floor[:2]), 0.85],
            fovy=68,
        )
    )
    scene = rc.Scene.build(spec)
    renderer = rc.render.Renderer(scene, backend="soft", quality="standard")
    return renderer.render("inside", WIDTH, HEIGHT)["rgb"]


def main() -> None:
    """Draws both."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        prepare_house_folder(path, OPTIONS)
        for index in HOUSES:
            make_house(path, OPTIONS, index)
        views = [from_above(path / f"train_{index}.xml") for index in HOUSES]
        save(sheet([views]), "houses_top.png", 1200)
        save(kitchen(path / f"train_{HOUSES[1]}_ceiling.xml"), "houses_kitchen.png")


if __name__ == "__main__":
    main()
