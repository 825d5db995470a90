"""Draws docs/randomize.png: twelve starts of examples/randomized_pick.yaml."""

from __future__ import annotations

from figures import DOCS, save, sheet

import robocell as rc

RUN = DOCS.parent / "examples" / "randomized_pick.yaml"
STARTS, COLUMNS = 12, 4


def main() -> None:
    """Draws them with the back end of the run, `soft`."""
    env = rc.envs.RunEnv(rc.RunConfig.load(RUN))
    images = []
    for index in range(STARTS):
        env.reset(index)
        images.append(env.row()["cameras/exo"])
    rows = [images[i : i + COLUMNS] for i in range(0, STARTS, COLUMNS)]
    save(sheet(rows), "randomize.png", 960)


if __name__ == "__main__":
    main()
