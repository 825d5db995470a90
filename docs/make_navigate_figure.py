"""Draws docs/navigate.png: ways through built-in houses, from above.

The mobile manipulator and the differential drive go to rooms and objects; then the mobile
manipulator drives to an object and picks it up.

Dots are the base every 0.25 m, from blue at the start to red at the end.
"""

from __future__ import annotations

import tempfile

import numpy as np
from figures import DOCS, save, sheet

import robocell as rc

EXAMPLES = DOCS.parent / "examples"
RUNS = ("tasks/navigate.yaml", 3), ("mobile/cart.yaml", 8), ("mobile/pick.yaml", 5)
WIDTH, HEIGHT = 560, 460
APART = 0.25  # m from dot to dot


def way(run: rc.RunConfig) -> tuple[np.ndarray, str]:
    """Places of the base in the first episode of a run, in the world, and its instruction."""
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    episode = rc.Dataset(run.output)[0]
    column = f"robots/{run.robot.name}/base_pose"
    return np.asarray(episode[column])[:, :2], episode.metadata["instruction"]


def from_above(file: str, index: int, folder: str) -> np.ndarray:
    """A house without its ceiling, with the way."""
    run = rc.RunConfig.load(EXAMPLES / file)
    run.cameras.streams.clear()
    run.scenes = rc.scenes.SceneSourceSpec(source="houses", ceiling=False, houses=[index])
    run.output, run.episodes, run.max_attempts = f"{folder}/{index}", 1, 40
    places, instruction = way(run)
    print(index, instruction, len(places))
    spec = rc.scenes.make_scene_source(run).make(index)
    spec.timestep = 0.002
    driven = np.r_[0, np.cumsum(np.hypot(*np.diff(places, axis=0).T))]
    dots = places[np.searchsorted(driven, np.arange(0, driven[-1], APART))]
    for i, (x, y) in enumerate(dots):
        share = i / max(1, len(dots) - 1)
        spec.objects.append(
            rc.SceneObject(
                name=f"dot{i}",
                shape="cylinder",
                size=[0.06, 0.01, 0],
                rgba=[share, 0.2, 1 - share, 1],
                mass=0.1,
                friction=[1, 0.01, 0.001],
                pos=[x, y, 0.02],
                fixed=True,
            )
        )
    scene = rc.Scene.build(spec)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in range(scene.model.ngeom):
        if scene.model.geom_type[geom] != 0:
            low = np.minimum(low, scene.data.geom_xpos[geom])
            high = np.maximum(high, scene.data.geom_xpos[geom])
    middle = (low + high) / 2
    view = rc.render.OrbitCamera(
        lookat=(middle[0], middle[1], 0.3),
        distance=1.45 * float(max(high[:2] - low[:2])),
        azimuth=90,
        elevation=-72,
        fovy=45,
    )
    renderer = rc.render.Renderer(scene, backend="soft", quality="standard")
    return renderer.render(view, WIDTH, HEIGHT)["rgb"]


def main() -> None:
    """Draws the houses."""
    with tempfile.TemporaryDirectory() as folder:
        row = [from_above(file, index, folder) for file, index in RUNS]
        save(sheet([row]), "navigate.png", 1200)


if __name__ == "__main__":
    main()
