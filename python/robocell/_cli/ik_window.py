"""The window of `robocell ik-test --view`: pose after pose with the answer of the solver."""

from __future__ import annotations

from robocell import Pose
from robocell._cli.ik_answers import Answers
from robocell._cli.robot_scene import RobotScene
from robocell.viewer import Viewer

SECONDS_PER_POSE = 1.0
AXIS_M = 0.1  # length of the axes of a pose
NEXT, PREVIOUS = ord("N"), ord("P")


def show_answers(
    loaded: RobotScene, targets: list[Pose], answers: Answers, tolerance: float
) -> None:
    """Moves the arm from answer to answer, each with its target's axes, until the window closes.

    It goes on by itself until the user presses N or P, which show the next and the previous one.
    """
    with Viewer.open(loaded.robot, f"ik-test: {loaded.config.name}") as viewer:
        walk = Walk(viewer, loaded, targets, answers, tolerance)
        while walk.step():
            pass


class Walk:
    """The answers in a viewer, one of which is shown.

    Attributes:
        number: The one that is shown.
        by_itself: False once the user chose one.
    """

    def __init__(
        self,
        viewer: Viewer,
        loaded: RobotScene,
        targets: list[Pose],
        answers: Answers,
        tolerance: float,
    ) -> None:
        """Shows the first answer."""
        self.viewer, self.robot, self.scene = viewer, loaded.robot, loaded.scene
        self.targets, self.answers = targets, answers
        self.solved = answers.solved(tolerance)
        self.by_itself = True
        viewer.show_frame("tcp", self.robot.name)
        self.show(0)

    def show(self, number: int) -> None:
        """Puts the arm at an answer, or the nearest one that there is."""
        self.number = min(max(number, 0), len(self.targets) - 1)
        self._until = self.scene.time() + SECONDS_PER_POSE
        self.viewer.clear_trace()
        pose = self.robot.base_in_world * self.targets[self.number]
        for axis in range(3):
            tip = pose.translation + AXIS_M * pose.rotation[:, axis]
            colour = [0.0, 0.0, 0.0, 1.0]
            colour[axis] = 1.0
            self.viewer.add_trace_segment(pose.translation, tip, colour)
        self.robot.set_joint_pos(self.answers.joints[self.number])
        self.viewer.text = self.text

    @property
    def text(self) -> str:
        """What the viewer shows beside the picture."""
        lines = [f"pose {self.number + 1} of {len(self.targets)}"]
        if not self.solved[self.number]:
            position = self.answers.position_error[self.number]
            rotation = self.answers.rotation_error[self.number]
            lines.append(f"NOT SOLVED: off by {position:.2g} m, {rotation:.2g} rad")
        return "\n".join([*lines, "N: next, P: previous"])

    def step(self) -> bool:
        """Makes one step of the scene; False once the window was closed."""
        for key in self.viewer.take_keys():
            if key in (NEXT, PREVIOUS):
                self.by_itself = False
                self.show(self.number + (1 if key == NEXT else -1))
        is_last = self.number == len(self.targets) - 1
        if self.by_itself and not is_last and self.scene.time() >= self._until:
            self.show(self.number + 1)
        self.robot.update()
        return self.viewer.step()
