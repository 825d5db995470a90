"""Draws docs/start_cameras.png: the first image of a random camera in six starts of a run.

White dots are points on the target, as `object_view` returns them.
"""

from __future__ import annotations

import numpy as np
from figures import DOCS, save
from PIL import Image, ImageDraw

import robocell as rc

RUN = DOCS.parent / "examples" / "demo.yaml"
COLUMNS, ROWS = 3, 2
WIDTH, HEIGHT = 312, 176
CAMERA = {
    "around": ["target", "gripper"],
    "distance": [0.6, 0.9],
    "height": [0.15, 0.5],
    "azimuth": [-110, 110],
    "look_at_noise": 0.05,
    "fovy": 45,
    "fovy_noise": 6,
    "sees": {
        "target": {"pixels": 150, "share": 0.4, "not_hidden_by": ["gripper"]},
        "gripper": {"pixels": 100},
    },
}


def starts(run: rc.RunConfig) -> list[rc.tasks.EpisodeStart]:
    """As many starts as there are pictures."""
    sampler = rc.tasks.StartSampler(run)
    found: list[rc.tasks.EpisodeStart] = []
    for episode in range(100):
        start = sampler.sample(
            rc.tasks.SampleRequest(scene=0, episode=episode, attempt=0),
            rc.tasks.Rng.stream(episode, "figure"),
        )
        if not isinstance(start, rc.tasks.Refusal):
            found.append(start)
        if len(found) == COLUMNS * ROWS:
            return found
    raise RuntimeError("too few starts")


def picture(start: rc.tasks.EpisodeStart) -> Image.Image:
    """The image of the camera, with the points."""
    renderer = rc.render.Renderer(start.scene, backend="soft", quality="high")
    image = Image.fromarray(renderer.render("side", 2 * WIDTH, 2 * HEIGHT)["rgb"])
    image = image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    view = rc.scenes.object_view(
        start.scene, start.target_object, "side", width=WIDTH, height=HEIGHT, points=5
    )
    draw = ImageDraw.Draw(image)
    for column, row in np.asarray(view.points):
        draw.ellipse((column - 2, row - 2, column + 2, row + 2), fill="white", outline="black")
    return image


def main() -> None:
    """Draws it."""
    run = rc.RunConfig.load(RUN)
    run.start.cameras = {"side": CAMERA}
    run.cameras.streams = [{"name": "side", "camera": "side", "width": WIDTH, "height": HEIGHT}]
    run.start.visible_from = []
    gap = 4
    sheet = Image.new("RGB", (COLUMNS * (WIDTH + gap) - gap, ROWS * (HEIGHT + gap) - gap), "white")
    for i, start in enumerate(starts(run)):
        at = (i % COLUMNS * (WIDTH + gap), i // COLUMNS * (HEIGHT + gap))
        sheet.paste(picture(start), at)
    save(sheet, "start_cameras.png")


if __name__ == "__main__":
    main()
