"""Prints the table of costs in docs/houses.md: processor time of houses on one core.

python docs/measure_houses.py
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import robocell as rc
from robocell.scenes import HouseOptions, make_house, prepare_house_folder

HOUSES = 4
OPTIONS = HouseOptions(seed=7, most_objects=40)
SLEEP = rc.scene.SimOptions(enable=["sleep"])
SPARSE = rc.scene.SimOptions(jacobian="sparse")


def spent(work: Callable[[], object], count: int = 1) -> float:
    """Milliseconds of processor time of one call."""
    start = time.process_time()
    for _ in range(count):
        work()
    return 1000 * (time.process_time() - start) / count


def spec_of(file: Path, options: rc.scene.SimOptions | None = None) -> rc.SceneSpec:
    """The house in this file, seen from a corner of its largest free floor."""
    spec = rc.SceneSpec(name=file.stem, base=str(file), timestep=0.002)
    if options:
        spec.options = options
    return spec


def step_of(file: Path, options: rc.scene.SimOptions | None, steps: int) -> float:
    """Milliseconds of a step, after everything has come to rest."""
    scene = rc.Scene.build(spec_of(file, options))
    for _ in range(1000):
        scene.step()
    return spent(scene.step, steps)


def image_of(file: Path, quality: str, moving: bool) -> float:
    """Milliseconds of an image of 320x240 by `soft`."""
    spec = spec_of(file)
    known = rc.scenes.derive_annotations(spec)
    at = known.free_floor[0].frame_to_world.translation
    table = known.supports[0].face.frame_to_world.translation
    camera = rc.render.CameraSpec(name="inside", pos=[at[0], at[1], 1.6], look_at=list(table))
    spec.cameras.append(camera)
    scene = rc.Scene.build(spec)
    renderer = rc.render.Renderer(scene, backend="soft", quality=quality)
    renderer.render("inside", 320, 240)
    total = 0.0
    for _ in range(20):
        if moving:
            scene.data.qpos[2] += 0.002  # one object
            scene.forward()
        total += spent(partial(renderer.render, "inside", 320, 240))
    return total / 20


def main() -> None:
    """Prints the smallest and the largest time in a few houses."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ROBOCELL_CACHE_DIR"] = folder + "/cache"
        path = Path(folder) / "houses"
        prepare_house_folder(path, OPTIONS)
        files = [path / f"train_{index}.xml" for index in range(HOUSES)]
        rows: dict[str, list[float]] = {}

        def add(what: str, values: list[float]) -> None:
            rows[what] = values
            print(f"| {what} | {min(values):.3g} to {max(values):.3g} ms |", flush=True)

        numbers = range(HOUSES)
        add(
            "a house with all files",
            [spent(partial(make_house, path, OPTIONS, i)) for i in numbers],
        )
        for what in ("compile, first time", "compile, again"):
            add(what, [spent(partial(rc.Scene.build, spec_of(f))) for f in files])
        add(
            "annotations", [spent(partial(rc.scenes.derive_annotations, spec_of(f))) for f in files]
        )
        scenes = [rc.Scene.build(spec_of(file)) for file in files]
        add("reset", [spent(scene.reset, 20) for scene in scenes])
        add("step, dense Jacobian", [step_of(file, None, 300) for file in files])
        add("step, sparse Jacobian", [step_of(file, SPARSE, 300) for file in files])
        add("step, everything asleep", [step_of(file, SLEEP, 300) for file in files])
        for quality in ("fast", "standard"):
            for moving in (False, True):
                what = f"image, {quality}, {'an object moves' if moving else 'at rest'}"
                add(what, [image_of(file, quality, moving) for file in files])


if __name__ == "__main__":
    main()
