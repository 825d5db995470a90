"""Example 13: what a robot reaches: a hundred thousand poses, solved and drawn.

The arm desk6 is loaded from its file. In the plane through its middle, at 50 by 50 places, it is
asked for 40 rotations of its tool each; the picture has the robot from the side, and the share of
the rotations that it reaches at each place, the darker the more.
The same in C++: 13_reach.cc. Run: python examples/13_reach.py [folder for the picture]
`robocell reach examples/desk6/desk6.yaml --plane y=0` makes such a map of any robot.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

ROBOT = Path(__file__).parent / "desk6" / "desk6.yaml"
ROTATIONS = 40
CELL = 0.03  # m
LOWER, UPPER = (-0.75, 0, -0.45), (0.75, 0, 1.05)  # in the robot base frame, m
CELL_PX = 10


def main(folder: Path) -> None:
    """Makes the map, and draws it into `folder`."""
    spec = rc.SceneSpec(name="desk", timestep=0.002, add_floor=True, add_skybox=True)
    spec.robots.append(rc.RobotSpec(name="desk6", config=rc.RobotConfig.load(ROBOT)))
    scene = rc.Scene.build(spec)
    scene.reset()
    kinematics = scene.robot("desk6").kinematics

    found = kinematics.reach_map(LOWER, UPPER, cell=CELL, rotations=ROTATIONS, threads=2)
    solved = np.rint(found.fraction[:, 0] * ROTATIONS).astype(int)  # (x, z)
    print(f"{solved.size * ROTATIONS} poses, {solved.sum()} of them reached")
    print(f"{np.sum(solved > 0)} of {solved.size} places are reached at all")
    x, z = np.unravel_index(np.argmax(solved), solved.shape)
    print(f"most freely at x {found.x[x]:.3f}, z {found.z[z]:.3f}: in {solved[x, z]} ways")

    # One answer as a check: the TCP at that place, any rotation.
    place = rc.Pose(translation=[found.x[x], 0, found.z[z]])
    ik = kinematics.ik(place, position_only=True, prefer="limits")
    reached = kinematics.fk(ik.q).translation
    assert ik.success
    assert np.linalg.norm(reached - place.translation) < 1e-5

    view = rc.render.OrbitCamera(lookat=(0, 0, 0.3), distance=1.8, azimuth=90, elevation=0)
    side = solved.shape[1] * CELL_PX
    image = rc.render.Renderer(scene, shadows=True, multisamples=4).render(view, side, side)["rgb"]
    left = ROTATIONS - solved.T[::-1]  # (z from above, x)
    colours = np.stack([225 * left // ROTATIONS + 30, 195 * left // ROTATIONS + 60, left * 0 + 160])
    colours[:, left == ROTATIONS] = 255
    drawn = colours.astype(np.uint8).repeat(CELL_PX, axis=1).repeat(CELL_PX, axis=2)
    rc.render.write_png(folder / "picture.png", np.hstack([image, drawn.transpose(1, 2, 0)]))


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
