"""Draws docs/render_soft.png: one view by `gl`, by `soft`, and by `soft` with more quality."""

from __future__ import annotations

from figures import save, sheet
from make_cell_picture import cell

import robocell as rc

WIDTH, HEIGHT = 400, 300
VIEW = rc.render.OrbitCamera(
    lookat=(-0.1, 0, 0.6), distance=1.7, azimuth=143, elevation=-16, fovy=38
)


def main() -> None:
    """Draws it."""
    scene = cell()
    images = []
    for backend, quality in (("gl", "fast"), ("soft", "fast"), ("soft", "standard")):
        renderer = rc.render.Renderer(scene, backend=backend, quality=quality)
        images.append(renderer.render(VIEW, WIDTH, HEIGHT)["rgb"])
    save(sheet([images]), "render_soft.png")


if __name__ == "__main__":
    main()
