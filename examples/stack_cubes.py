"""A task of your own and its expert: put the red cube on the blue one. See stack_cubes.yaml."""

from dataclasses import dataclass

import numpy as np

import robocell as rc


@rc.register_task("red_on_blue")
class Stack(rc.tasks.Task):
    """Success: red lies on blue, and nothing else touches it."""

    @dataclass
    class Fields:
        """What `task:` may say."""

        edge: float = 0.04  # of the cubes, m

    def __init__(self, fields: Fields) -> None:
        super().__init__()
        self.edge = fields.edge

    def prepare(self, spec: rc.SceneSpec, rng: rc.tasks.Rng) -> None:
        for name, rgba in (("red", [0.9, 0.2, 0.15, 1]), ("blue", [0.15, 0.35, 0.9, 1])):
            cube = rc.SceneObject(name=name, shape=rc.Shape.BOX, size=[self.edge / 2] * 3)
            cube.rgba, cube.mass, cube.friction = rgba, 0.08, [1, 0.02, 0.001]
            spec.objects.append(cube)

    def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
        red, blue = (scene.body_pose(name).translation for name in ("red", "blue"))
        aside = float(np.linalg.norm((red - blue)[:2]))
        above = abs(red[2] - blue[2] - self.edge) < 0.003 and aside < self.edge / 3
        touched = {c.body2 if c.body1 == "red" else c.body1 for c in scene.contacts("red")}
        success = above and touched == {"blue"}
        return rc.tasks.TaskVerdict(1.0 if success else 0.5 * float(np.exp(-10 * aside)), success)

    def instruction(self) -> str:
        return "put the red cube on the blue one"

    def objects(self) -> list[str]:
        return ["red", "blue"]

    def base_range(self) -> rc.tasks.BaseRange:
        return rc.tasks.BaseRange(distance=[0.3, 0.4], height_offset=-0.25)


@rc.tasks.register_expert("red_on_blue")
class Stacker(rc.tasks.PickPlanner):
    """Picks red up as the built-in expert does, then leads it over blue, down, and lets go."""

    def __init__(self, run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> None:
        super().__init__(run, start)
        self.name, self.edge, self.waited = run.robot.name, run.task.edge, 0
        self.stops: list[tuple[np.ndarray, float]] = []

    def act(
        self, scene: rc.Scene, rng: rc.tasks.Rng
    ) -> dict[str, dict[str, rc.control.GroupCommand]]:
        if not super().done():
            return super().act(scene, rng)
        if not self.stops:
            robot = scene.robot(self.name)
            red, blue = (scene.body_pose(name).translation for name in ("red", "blue"))
            self.tcp = robot.tcp_in_world
            on = self.tcp.translation - red + blue + [0, 0, self.edge + 0.002]
            self.base, up = robot.base_in_world.inverse(), np.array([0, 0, 0.07])
            self.stops = [(on + up, 0.0), (on, 0.0), (on, 1.0), (on + up, 1.0)]  # place, opening
        place, opening = self.stops[0]
        way = place - self.tcp.translation
        at = self.tcp.translation + way * min(1.0, 0.02 / max(float(np.linalg.norm(way)), 1e-9))
        self.tcp = rc.Pose(translation=at, quaternion=self.tcp.quaternion)
        self.waited = self.waited + 1 if np.allclose(way, 0) else 0
        if self.waited > 6 and len(self.stops) > 1:
            self.stops.pop(0)
        arm = rc.control.GroupCommand.leaf_pose(self.base * self.tcp)
        return {self.name: {"arm": arm, "gripper": rc.control.GroupCommand.opening(opening)}}

    def done(self) -> bool:
        return bool(self.failure()) or (len(self.stops) == 1 and self.waited > 6)
