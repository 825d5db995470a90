"""Example 4: a task that robocell does not know, pushing a cube, and a dataset of it.

Three small classes: a sampler makes the start, a task judges, an expert acts. The runner does the
rest, as it does for picking.
The same in C++: 04_own_task.cc. Run: python examples/04_own_task.py [folder]
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

FAR = 0.1  # m, how far the cube is to be pushed
DOWN = [1, 0, 0, 0]  # quaternion xyzw: the gripper points down


class Push(rc.tasks.Task):
    """Success: the cube stands FAR further along x than at the start."""

    def begin(self, scene: rc.Scene) -> None:
        self.start = scene.body_pose("cube").translation

    def reward(self, scene: rc.Scene) -> float:
        return float(scene.body_pose("cube").translation[0] - self.start[0])

    def success(self, scene: rc.Scene) -> bool:
        height = float(scene.body_pose("cube").translation[2])
        return self.reward(scene) >= FAR and abs(height - self.start[2]) < 0.005

    def instruction(self) -> str:
        return f"push the cube {100 * FAR:.0f} cm away"

    def objects(self) -> list[str]:
        return ["cube"]


@rc.tasks.register_sampler("push")
class CubeOnTheFloor(rc.tasks.TaskSampler):
    """The robot, and a cube somewhere before it; what is too near is refused."""

    def __init__(self, run: rc.RunConfig) -> None:
        super().__init__()
        self.robot = rc.RobotSpec(name=run.robot.name, config=run.robot)

    def sample(
        self, request: rc.tasks.SampleRequest, rng: rc.tasks.Rng
    ) -> rc.tasks.EpisodeStart | rc.tasks.Refusal:
        at = [rng.uniform(0.2, 0.5), rng.uniform(-0.2, 0.2), 0.02]
        if at[0] < 0.35:
            return rc.tasks.Refusal(
                rc.tasks.RefusalReason.NO_REACHABLE_BASE_POSE, "no room behind the cube"
            )
        cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, pos=at)
        cube.rgba, cube.mass, cube.friction = [0.95, 0.5, 0.1, 1], 0.1, [0.6, 0.02, 0.001]
        spec = rc.SceneSpec(name="push", timestep=0.002, add_floor=True, add_skybox=True)
        spec.robots.append(self.robot)
        spec.objects.append(cube)
        scene = rc.Scene.build(spec)
        scene.reset(seed=rng.integer(2**31))
        return rc.tasks.EpisodeStart(scene, Push(), target_object="cube", object_kinds=["box"])


@rc.tasks.register_expert("pusher")
class Pusher(rc.tasks.Expert):
    """Leads the closed gripper over, behind and against the cube, 15 mm an action."""

    def __init__(self, run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> None:
        super().__init__()
        self.name = run.robot.name

    def begin(self, scene: rc.Scene, rng: rc.tasks.Rng) -> None:
        robot = scene.robot(self.name)
        self.goal = robot.fk_frame()
        x, y, z = (robot.base_in_world.inverse() * scene.body_pose("cube")).translation
        path = [(x - 0.08, y, z + 0.15), (x - 0.08, y, z), (x + FAR, y, z)]
        self.path = [rc.Pose(translation=list(at), quaternion=DOWN) for at in path]
        self.at = 0

    def act(
        self, scene: rc.Scene, rng: rc.tasks.Rng
    ) -> dict[str, dict[str, rc.control.GroupCommand]]:
        way = self.goal.inverse() * self.path[self.at]
        self.goal = self.goal * way.limit_translation(0.015).limit_rotation(0.1)
        if self.goal.is_close(self.path[self.at], 1e-6, 1e-6):
            self.at += 1
        arm, gripper = (
            rc.control.GroupCommand.leaf_pose(self.goal),
            rc.control.GroupCommand.opening(0),
        )
        return {self.name: {"arm": arm, "gripper": gripper}}

    def done(self) -> bool:
        return self.at == len(self.path)

    def failure(self) -> str:
        return ""  # it never gives up; whether the cube was pushed far enough is the task's to say

    def phase(self) -> int:
        return min(self.at, 2)

    def phase_names(self) -> list[str]:
        return ["over", "behind", "push"]


def strip(episode: rc.data.Episode, camera: str) -> np.ndarray:
    """Five frames of a video side by side."""
    frames = episode.frames(camera)
    return np.hstack([frames[i * (len(frames) - 1) // 4] for i in range(5)])


def main(folder: Path) -> None:
    """Makes two episodes in `folder`/push, filmed from the side; draws `folder`/picture.png."""
    run = rc.RunConfig(
        run="push",
        sampler="push",
        expert="pusher",
        episodes_per_scene=2,
        output=str(folder / "push"),
    )
    shutil.rmtree(run.output, ignore_errors=True)
    run.robot = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    side = rc.render.CameraSpec(
        name="side", pos=[0.6, -0.9, 0.3], look_at=[0.45, 0, -0.12], fovy=40
    )
    side.attach_to = rc.robots.AttachTarget(rc.robots.AttachKind.Body, "base_link")
    run.robot.cameras.append(side)
    run.cameras.resolution = [320, 240]
    run.cameras.streams.append(rc.render.CameraConfig(name="side", camera="side"))
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        result = runner.run(item)
        print(f"{item.id}: {result.rows} rows, starts refused: {sum(result.refusals.values())}")

    for episode in rc.Dataset(run.output):
        cube = episode["objects/cube/pose"]
        print(f"{episode.id}: pushed {cube[-1, 0] - cube[0, 0]:.3f} m")
        assert episode.success
        assert episode["reward"][-1] >= FAR
    rc.render.write_png(folder / "picture.png", strip(next(iter(rc.Dataset(run.output))), "side"))
    assert len(rc.data.verify(run.output).good) == 2


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
