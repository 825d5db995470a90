"""Draws docs/render_quality.png: one view in each quality, and what an image costs by stages.

The costs are those of decision 028 (STAGES), measured on one core with AVX-512.
"""

from __future__ import annotations

from figures import DOCS, Frame, save
from make_cell_picture import cell
from matplotlib import pyplot
from PIL import Image

import robocell as rc

QUALITIES = ("fast", "standard", "high")
WIDTH, HEIGHT = 640, 480
VIEW = rc.render.OrbitCamera(
    lookat=(-0.12, 0, 0.56), distance=1.5, azimuth=143, elevation=-18, fovy=38
)
DETAIL = (slice(215, 395), slice(60, 300))  # rows and columns

# Milliseconds of an image of 640x480 with colour, depth and segmentation: decision 028.
STAGES = {
    "triangles": (1.6, 1.9, 2.9, 3.1),
    "depth, segmentation": (0.4, 0.5, 0.5, 0.6),
    "shadow maps": (0, 3.2, 0, 4.1),
    "colours": (1.7, 2.5, 2.6, 3.6),
    "samples": (0, 2.5, 0, 4.6),
    "list, packing": (0.04, 0.36, 0.07, 0.38),
}
BARS = ("xArm7, fast", "xArm7, standard", "Panda, fast", "Panda, standard")


def main() -> None:
    """Draws it."""
    scene = cell()
    frames: dict[str, Frame] = {}
    for quality in QUALITIES:
        renderer = rc.render.Renderer(scene, backend="soft", quality=quality)
        frames[quality] = renderer.render(VIEW, WIDTH, HEIGHT)["rgb"]
    pyplot.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure = pyplot.figure(figsize=(11, 7.2), layout="constrained")
    grid = figure.add_gridspec(3, 3, height_ratios=(1, 0.9, 0.75))
    for column, (quality, frame) in enumerate(frames.items()):
        for row, part in enumerate((frame, frame[DETAIL])):
            axes = figure.add_subplot(grid[row, column])
            axes.imshow(part, interpolation="nearest")
            axes.axis("off")
            if row == 0:
                axes.set_title(quality)
    bars = figure.add_subplot(grid[2, :])
    left = [0.0] * len(BARS)
    for stage, values in STAGES.items():
        bars.barh(BARS, values, left=left, label=stage)
        left = [one + other for one, other in zip(left, values, strict=True)]
    bars.invert_yaxis()
    bars.set_xlabel("ms an image of 640x480, one core")
    bars.legend(loc="upper right", ncols=3, frameon=False)
    figure.savefig(DOCS / "render_quality.png", dpi=180)
    save(Image.open(DOCS / "render_quality.png"), "render_quality.png", 960)


if __name__ == "__main__":
    main()
