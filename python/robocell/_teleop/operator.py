"""One person at a device: the phases of an episode, its motions, and what is shown of it.

    waiting -> countdown -> recording -> review -> waiting ...

The `Teleoperator` is the expert of a run (`TELEOP`), so that the runner records, judges and commits
its episodes like any others. It acts in real time: `act` waits until its action is due.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from robocell._core import EpisodeStart, Error, GroupCommand, Rng, RunConfig, Scene, StopFlag
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import place_of
from robocell._teleop.device import Device, DeviceLostError, Motion
from robocell._teleop.follower import ArmFollower, FollowOptions
from robocell.tasks import Expert

FRAME_S = 1 / 30
SILENT_S = 0.5  # without a word from the device, it counts as silent
WAITING, COUNTDOWN, RECORDING, REVIEW = "waiting", "countdown", "recording", "review"
MARKED = "marked as a failure"


class Screen(Protocol):
    """Shows a session to the person."""

    def show(self, scene: Scene, status: Mapping[str, Any], row: Mapping[str, Any]) -> None:
        """Shows the present state; called often, from the thread of the scene."""


class NoScreen:
    """Shows nothing."""

    def show(self, scene: Scene, status: Mapping[str, Any], row: Mapping[str, Any]) -> None:
        """Does nothing."""


@dataclass(frozen=True)
class OperatorOptions:
    """How a session goes.

    Attributes:
        robot: Name of the robot in its scene; "" for the first one with an arm.
        follow: How the arm follows.
        countdown_s: Time from `record` to the first action.
        ends_at_success: Whether the task's success ends an episode.
        asks: Whether each ended episode is kept or discarded by command; False keeps it.
        waits: Whether an episode waits for `record`; False begins at once.
        real_time: False acts as fast as the computer can, for recorded sessions.
        episode: Id of the only episode to record; "" for all that are missing.
        max_steps: Most actions of an episode, in the place of the run's; 0 leaves those.
    """

    robot: str = ""
    follow: FollowOptions = field(default_factory=FollowOptions)
    countdown_s: float = 3.0
    ends_at_success: bool = True
    asks: bool = True
    waits: bool = True
    real_time: bool = True
    episode: str = ""
    max_steps: int = 0


class Operator:
    """A person at a device, over several episodes.

    Attributes:
        stop: Ends the present rollout without an episode.
        quits: True when the person has enough.
        motions: The motion of each action of the present episode; None where the device was silent.
        phase: What is going on.
        max_steps: Most actions of the present episode.
        lost: The error that ended the session: of a device that is gone, or of a wrong name.
    """

    def __init__(
        self, device: Device, options: OperatorOptions, screen: Screen | None = None
    ) -> None:
        self.device, self.options = device, options
        self.stop, self.quits = StopFlag(), False
        self.motions: list[Motion | None] = []
        self.phase = WAITING
        self.max_steps = 0
        self.lost: Exception | None = None
        self.row: Mapping[str, Any] = {}
        self._screen = screen or NoScreen()
        self._heard = time.monotonic()
        self._commands: list[str] = []
        self._shown_at = 0.0
        self._notes: dict[str, Any] = {}

    def renew(self) -> None:
        """Prepares for another rollout."""
        self.stop = StopFlag()
        self.motions = []
        self.phase = WAITING

    def note(self, **notes: Any) -> None:
        """Adds to what is shown."""
        self._notes |= notes

    @property
    def is_silent(self) -> bool:
        """True if the device has said nothing for a while."""
        return time.monotonic() - self._heard > SILENT_S

    def read(self, seconds: float) -> Motion | None:
        """Reads the device, and keeps its commands for `take`. A lost device ends the session."""
        motion = self.call("read", seconds)
        if motion is None:
            return None
        if not isinstance(motion, Motion):
            kind = type(self.device).__name__
            self.end(DeviceLostError(f"{kind}.read() returned {motion!r}, not a Motion or None"))
            return None
        self._heard = time.monotonic()
        self._commands += motion.commands
        return motion

    def call(self, method: str, *arguments: object) -> Any:
        """Calls a method of the device. Whatever it raises ends the session; then returns None."""
        try:
            return getattr(self.device, method)(*arguments)
        except Error as error:
            self.end(error)
        except RAISED as error:
            raise_interrupt(error)
            kind = type(self.device).__name__
            self.end(DeviceLostError(f"{kind}.{method}(): {place_of(error)}"))
        return None

    def end(self, error: Exception) -> None:
        """Ends the session; the present episode is dropped, and `record` raises the error."""
        self.lost, self.quits = self.lost or error, True
        self.stop.set()

    def take(self, *names: str) -> str:
        """Returns the first waiting command of these, and drops it; "" without one.

        After `quit` the present rollout stops, unless its episode has ended: that one is kept.
        """
        if "quit" in self._commands:
            self.quits = True
            if self.phase != REVIEW:
                self.stop.set()
        for name in names:
            if name in self._commands:
                self._commands.remove(name)
                return name
        return ""

    def forget_commands(self) -> None:
        """Drops what was commanded in another phase."""
        self._commands = [name for name in self._commands if name == "quit"]

    def wait_for(self, scene: Scene, *names: str, seconds: float | None = None) -> str:
        """Shows the scene until one of the commands is given, or the time is over ("")."""
        end = None if seconds is None else time.monotonic() + seconds
        while not (self.stop.is_set or self.quits):
            if end is not None and time.monotonic() >= end:
                return ""
            self.read(FRAME_S)
            if self.take("reset_origin"):
                self.call("reset_origin")
            if found := self.take(*names):
                return found
            self.show(scene, end)
            time.sleep(FRAME_S)
        return ""

    def show(self, scene: Scene, end: float | None = None) -> None:
        """Shows the scene, at most as often as eyes can follow."""
        now = time.monotonic()
        if now - self._shown_at < FRAME_S / 2:
            return
        self._shown_at = now
        left = None if end is None else round(end - now, 1)
        status = {
            "phase": self.phase,
            "left_s": left,
            "silent": self.is_silent,
            "rows": len(self.motions),
            **self._notes,
        }
        self._screen.show(scene, status, self.row)


class Teleoperator(Expert):
    """The expert of one rollout: acts as the operator's device moves."""

    def __init__(self, run: RunConfig, start: EpisodeStart, operator: Operator) -> None:
        super().__init__()
        self._operator, self._start = operator, start
        self._seconds = run.rates.policy_period()
        operator.max_steps = run.rates.max_steps
        self._most_actions = max(run.rates.max_steps - 1, 1)
        self._follower: ArmFollower | None = None
        self._robot = ""
        self._due = 0.0
        self._failure = ""
        self._succeeded = False  # as the task judged the last action
        self._is_done = False

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Waits for `record`, and counts down."""
        try:
            self._begin(scene)
        except Error as error:  # else the runner would keep a failed episode
            self._operator.end(error)

    def _begin(self, scene: Scene) -> None:
        operator, options = self._operator, self._operator.options
        self._robot = options.robot or next(robot.name for robot in scene.robots if _arm_of(robot))
        self._follower = ArmFollower(scene.robot(self._robot), options.follow)
        operator.row = {}
        operator.forget_commands()
        operator.note(
            instruction=self._start.task.instruction(), success=False, blocked="", ended=""
        )
        operator.phase = WAITING
        if options.waits:
            operator.wait_for(scene, "record")
            operator.phase = COUNTDOWN
            operator.wait_for(scene, seconds=options.countdown_s)
        operator.phase = RECORDING
        operator.call("begin")
        operator.forget_commands()
        self._due = time.monotonic()

    def see(self, row: Mapping[str, Any]) -> None:
        """Stores the recorded row, whose images are shown."""
        self._operator.row = row

    def act(self, scene: Scene, rng: Rng) -> dict[str, dict[str, GroupCommand]]:
        """Returns the commands that follow the device."""
        try:
            return {} if self._follower is None else self._act(scene, self._follower)
        except Error as error:
            self._operator.end(error)
            return {}

    def _act(self, scene: Scene, follower: ArmFollower) -> dict[str, dict[str, GroupCommand]]:
        operator = self._operator
        operator.show(scene)
        operator.row = {}  # its images cannot be drawn later
        self._wait()
        motion = None if operator.stop.is_set else operator.read(self._seconds)
        operator.motions.append(motion)
        if operator.take("reset_origin"):
            operator.call("reset_origin")
        if operator.take("resync"):
            follower.resync()
        if operator.take("discard"):
            operator.stop.set()
        ended = operator.take("success", "failure")
        if ended:
            self._is_done = True
            self._failure = MARKED if ended == "failure" else ""
        operator.note(success=self._succeeded)
        self._succeeded = False
        commands = follower.hold() if motion is None else follower.follow(motion, self._seconds)
        operator.note(blocked=follower.blocked)
        return {self._robot: commands}

    def done(self) -> bool:
        """Returns True after `success`, `failure` or the last action, when the episode is kept.

        A discarded one is not done: the runner stops before the next action, and commits nothing.
        The last action is one before the run's `max_steps`, after which nothing could be asked.
        """
        if not self._is_done and len(self._operator.motions) < self._most_actions:
            return False
        return self._review()

    def ends_at_success(self) -> bool:
        """Is called after an action that the task judges as a success."""
        self._succeeded = True
        if not self._operator.options.ends_at_success:
            return False
        self._operator.note(success=True)
        return self._review()

    def failure(self) -> str:
        """Returns why the person ended the episode as a failure."""
        return self._failure

    def phase(self) -> int:
        """Returns 0, the only phase."""
        return 0

    def phase_names(self) -> list[str]:
        """Returns no names."""
        return []

    def _review(self) -> bool:
        """Asks whether to keep the episode; after `discard` the rollout stops."""
        operator = self._operator
        if operator.stop.is_set:
            return False
        operator.phase = REVIEW
        operator.note(ended=self._failure or "ended")
        asks, scene = operator.options.asks, self._start.scene
        if asks and operator.wait_for(scene, "keep", "discard") == "discard":
            operator.stop.set()
        return not operator.stop.is_set

    def _wait(self) -> None:
        """Waits until the next action is due; a slow computer begins to count again."""
        if not self._operator.options.real_time:
            return
        now = time.monotonic()
        if now < self._due:
            time.sleep(self._due - now)
        elif now > self._due + 2 * self._seconds:
            self._due = now
        self._due += self._seconds


def _arm_of(robot: Any) -> str:
    return next((name for name in robot.group_names if robot.group(name).kind == "arm"), "")
