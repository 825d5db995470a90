"""Draws docs/kinematics.png: how batched inverse kinematics gets to its answers, on two arms.

Left: steps that a pose takes. Middle: what is still unsolved when so many restarts are allowed.
Right: what the arm of the first one reaches in the plane through its middle.
"""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from figures import DOCS, save
from matplotlib import pyplot
from PIL import Image

import robocell as rc

ROBOTS = {
    "rc7, 7 joints": rc.models.robot_file("rc7"),
    "desk6, 6 joints": DOCS.parent / "examples" / "desk6" / "desk6.yaml",
}
TARGETS = 100_000
MOST_STEPS = 40  # drawn
RESTARTS = np.arange(25)
CORNERS = (-1.0, 0, -0.7), (1.0, 0, 1.3)  # in the robot base frame, m


def kinematics(file: str) -> tuple[rc.Scene, rc.Robot]:
    """The robot in a scene of its own."""
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="a", config=rc.RobotConfig.load(file)))
    scene = rc.Scene.build(spec)
    return scene, scene.robot("a")


def main() -> None:
    """Draws it."""
    mpl.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, (steps, restarts, reach) = pyplot.subplots(
        1, 3, figsize=(12, 3.8), layout="constrained", width_ratios=(1, 1, 1.05)
    )
    reached = None
    for number, (name, file) in enumerate(ROBOTS.items()):
        scene, robot = kinematics(str(file))
        low, high = np.array(robot.joint_limits).T
        rng = np.random.default_rng(1)
        targets = robot.kinematics.fk(rng.uniform(low, high, (TARGETS, len(low))))
        found = robot.kinematics.ik_batch(targets, threads=2)
        steps.hist(np.minimum(found.iterations, MOST_STEPS), np.arange(MOST_STEPS + 2) - 0.5,
                   density=True, histtype="step", color=f"C{number}",
                   label=f"{name}: {found.iterations.mean():.1f} on average")  # fmt: skip
        print(f"{name}: median {np.median(found.iterations):.0f}, {found.success.mean():.5%}")
        unsolved = [
            1 - robot.kinematics.ik_batch(targets, max_restarts=int(k), threads=2).success.mean()
            for k in RESTARTS
        ]
        restarts.semilogy(RESTARTS, np.maximum(unsolved, 0.5 / TARGETS), "o-", markersize=3,
                          color=f"C{number}", label=name)  # fmt: skip
        if reached is None:
            reached = robot.kinematics.reach_map(*CORNERS, cell=0.025, rotations=96, threads=2)
        scene.close()
    steps.set(xlabel="steps until solved, all starts", ylabel="share of the poses",
              title=f"{TARGETS:,} reachable poses without seeds")  # fmt: skip
    steps.legend(frameon=False)
    restarts.axhline(1 / TARGETS, color="0.8", linewidth=0.8)
    restarts.annotate("one pose", (RESTARTS[-1], 1 / TARGETS), (18, 1.2 / TARGETS), color="0.5")
    restarts.set(xlabel="restarts allowed", ylabel="share still unsolved",
                 title="what restarts are for")  # fmt: skip
    restarts.legend(frameon=False)
    image = reach.imshow(
        reached.fraction[:, 0].T, origin="lower", cmap="viridis", vmin=0,
        extent=(CORNERS[0][0], CORNERS[1][0], CORNERS[0][2], CORNERS[1][2]),
    )  # fmt: skip
    figure.colorbar(image, ax=reach, label="share of the rotations", shrink=0.85)
    reach.set(xlabel="x in m", ylabel="z in m", title="rc7: reach in the plane y = 0")
    figure.savefig(DOCS / "kinematics.png", dpi=180)
    save(Image.open(DOCS / "kinematics.png"), "kinematics.png", 1200)


if __name__ == "__main__":
    main()
