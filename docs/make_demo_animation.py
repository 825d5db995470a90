"""Draws docs/demo.webp, the moving picture of the README: picks of `make demo` by two cameras.

python docs/make_demo_animation.py

The episodes are those of examples/demo.yaml; only the images are larger and drawn by `soft` with
shadows. Left is the camera beside the robot, right the one on its wrist.
"""

from __future__ import annotations

import tempfile

from figures import DOCS, sheet
from PIL import Image

import robocell as rc

RUN = DOCS.parent / "examples" / "demo.yaml"
SIZE = (352, 264)  # width, height of each view in pixels
SHOWN = (2, 4, 5)  # episodes of the plan
EVERY = 2  # frames of the videos
FRAME_MS = 66  # the time a frame is shown: twice as fast as it was
LAST_MS = 700  # and the last one of an episode
QUALITY = 55  # of WebP, 0 to 100


def make_episodes(folder: str) -> rc.Dataset:
    """Generates these episodes of the demo run."""
    run = rc.RunConfig.load(RUN, [f"output={folder}/demo", "cameras.renderer.quality=high"])
    run.cameras.resolution = SIZE
    rc.generate.prepare_dataset(run)
    runner, plan = rc.generate.Runner(run), rc.generate.make_plan(run)
    for i in SHOWN:
        runner.run(plan[i])
    return rc.Dataset(run.output)


def views(episode: rc.Episode) -> list[Image.Image]:
    """Both cameras side by side, every second frame and the last."""
    exo, wrist = episode.frames("exo"), episode.frames("wrist")
    shown = sorted({*range(0, len(exo), EVERY), len(exo) - 1})
    return [sheet([[exo[i], wrist[i]]]) for i in shown]


def main() -> None:
    """Draws it."""
    images, times = [], []
    with tempfile.TemporaryDirectory() as folder:
        for episode in make_episodes(folder):
            frames = views(episode)
            images += frames
            times += [FRAME_MS] * (len(frames) - 1) + [LAST_MS]
    images[0].save(
        DOCS / "demo.webp",
        save_all=True,
        append_images=images[1:],
        duration=times,
        loop=0,
        quality=QUALITY,
        method=4,
    )
    print(DOCS / "demo.webp")


if __name__ == "__main__":
    main()
