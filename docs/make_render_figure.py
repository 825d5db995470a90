"""Draws docs/render_quality.png: one view with the cheapest quality and with everything on."""

from __future__ import annotations

from figures import save, sheet
from make_cell_picture import cell

import robocell as rc

WIDTH, HEIGHT = 470, 340
VIEW = rc.render.OrbitCamera(
    lookat=(-0.1, 0, 0.6), distance=1.7, azimuth=143, elevation=-16, fovy=38
)


def main() -> None:
    """Draws it."""
    scene = cell()
    images = []
    for quality in ({}, {"shadows": True, "reflections": True, "multisamples": 4}):
        renderer = rc.render.Renderer(scene, shadow_size=4096, **quality)
        images.append(renderer.render(VIEW, WIDTH, HEIGHT)["rgb"])
    save(sheet([images]), "render_quality.png")


if __name__ == "__main__":
    main()
