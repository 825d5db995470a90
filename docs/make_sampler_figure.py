"""Draws docs/sampler.png: starts that StartSampler makes of examples/demo.yaml.

Left: where the robot's base stands, seen from above, with the target in the middle. Right: the
distance and height of the base, beside what the run file asks for.
"""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from figures import DOCS, save
from matplotlib import pyplot
from matplotlib.patches import Circle, Rectangle
from PIL import Image

import robocell as rc

STARTS = 120
RUN = DOCS.parent / "examples" / "demo.yaml"


def starts(run: rc.RunConfig) -> tuple[np.ndarray, np.ndarray, int]:
    """Base positions relative to the target (n, 3), their headings (n,), and what was refused."""
    sampler = rc.tasks.StartSampler(run)
    places, headings, refused = [], [], 0
    for episode in range(STARTS):
        start = sampler.sample(
            rc.tasks.SampleRequest(scene=0, episode=episode, attempt=0),
            rc.tasks.Rng.stream(episode, "figure"),
        )
        if isinstance(start, rc.tasks.Refusal):
            refused += 1
            continue
        target = start.scene.body_pose(body_of(start.scene, start.target_object))
        places.append(start.base_in_world.translation - target.translation)
        headings.append(start.base_in_world.rpy[2])
    return np.array(places), np.array(headings), refused


def body_of(scene: rc.Scene, name: str) -> str:
    """The body of an object, a primitive or a model."""
    return next(body for body in scene.body_names() if body == name or body.startswith(f"{name}_"))


def main() -> None:
    """Draws it."""
    run = rc.RunConfig.load(RUN)
    places, headings, refused = starts(run)
    near, far = run.start.base_distance
    low, high = run.start.base_height_offset + np.array(run.start.base_height_noise)
    mpl.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, (above, spread) = pyplot.subplots(1, 2, figsize=(9.6, 4.4), layout="constrained")
    above.add_patch(Circle((0, 0), far, color="0.9"))
    above.add_patch(Circle((0, 0), near, color="white"))
    above.quiver(*places[:, :2].T, np.cos(headings), np.sin(headings), color="tab:blue",
                 scale=28, width=0.005, pivot="mid")  # fmt: skip
    above.plot(0, 0, "o", color="tab:red", markersize=8)
    above.annotate("target", (0, 0), (0.04, 0.03))
    above.set(aspect="equal", xlim=(-0.65, 0.65), ylim=(-0.65, 0.65), xlabel="x in m",
              ylabel="y in m", title="bases around the target, and where they face")  # fmt: skip
    spread.add_patch(Rectangle((near, low), far - near, high - low, color="0.9"))
    spread.plot(np.hypot(places[:, 0], places[:, 1]), places[:, 2], ".", color="tab:blue")
    spread.set(xlabel="distance in m: base_distance",
               ylabel="height in m: base_height_offset, _noise",
               title=f"{len(places)} starts, {refused} refused")  # fmt: skip
    figure.savefig(DOCS / "sampler.png", dpi=200)
    save(Image.open(DOCS / "sampler.png"), "sampler.png", 960)


if __name__ == "__main__":
    main()
