"""One person at a device: the phases of an episode, its motions, and what is shown of it.

    waiting -> countdown -> recording -> review -> waiting ...

The `Teleoperator` is the expert of a run (`TELEOP`), so that the runner records, judges and commits
its episodes like any others. It acts in real time: `act` waits until its action is due.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from robocell._core import EpisodeStart, Error, GroupCommand, Rng, RunConfig, Scene, StopFlag
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import place_of
from robocell._teleop.arms import Arm, DrivenArms, arm_named, arms_of
from robocell._teleop.device import Device, DeviceLostError, Motion
from robocell._teleop.follower import FollowOptions
from robocell._teleop.real_arms import ArmStoppedError, RealArms
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
        robot: The arm that the device moves first, by its name or that of its robot: "left",
            "torso/left"; "" for the first one.
        follow: How the arm follows.
        countdown_s: Time from `record` to the first action.
        ends_at_success: Whether the task's success ends an episode.
        asks: Whether each ended episode is kept or discarded by command; False keeps it.
        waits: Whether an episode waits for `record`; False begins at once.
        real_time: False acts as fast as the computer can, for recorded sessions.
        episode: Id of the only episode to record; "" for all that are missing.
        max_steps: Most actions of an episode, in the place of the run's; 0 leaves those.
        seed: Seed of the starts of a cell; runs have their own.
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
    seed: int = 0


class Operator:
    """A person at a device, over several episodes.

    Attributes:
        stop: Ends the present rollout without an episode.
        quits: True when the person has enough.
        motions: The motion of each action of the present episode; None where the device was silent.
        phase: What is going on.
        max_steps: Most actions of the present episode.
        lost: The error that ended the session: of a device that is gone, or of a wrong name.
        real_arms: The arms that the session moves beside those of the scene; None without.
    """

    def __init__(
        self,
        device: Device,
        options: OperatorOptions,
        screen: Screen | None = None,
        real_arms: RealArms | None = None,
    ) -> None:
        self.device, self.options, self.real_arms = device, options, real_arms
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

    def close(self) -> None:
        """Releases the device, and holds the real arms."""
        try:
            self.call("close")
        finally:
            if self.real_arms is not None:
                self.real_arms.close()

    def untie(self) -> None:
        """Brakes and holds the real arms. An arm that has stopped ends the session."""
        if self.real_arms is None:
            return
        self.real_arms.untie()
        if self.real_arms.reason:
            self.end(ArmStoppedError(self.real_arms.reason))

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


class Performance:
    """One episode as the operator performs it, whatever records it.

    Args:
        operator: The person.
        scene: Returns the scene.
        seconds: Duration of an action.
        most_actions: Most actions of the episode.
        instruction: What the person shall do.

    Attributes:
        failure: Why the person ended it as a failure; "" otherwise.
        marked: The command that ended it, "success" or "failure"; "" otherwise.
        succeeded: True if the last action was judged as a success; the recorder sets it.
    """

    def __init__(
        self,
        operator: Operator,
        scene: Callable[[], Scene],
        seconds: float,
        most_actions: int,
        instruction: str,
    ) -> None:
        self._operator, self._scene, self._seconds = operator, scene, seconds
        self._most_actions, self._instruction = max(most_actions, 1), instruction
        self._arms: DrivenArms | None = None
        self._due = 0.0
        self._is_done = False
        self.failure, self.marked, self.succeeded = "", "", False

    def begin(self) -> None:
        """Waits for `record`, and counts down."""
        operator, options, scene = self._operator, self._operator.options, self._scene()
        operator.row = {}
        operator.forget_commands()
        arms = arms_of(scene)
        for name in operator.device.arms:
            arm_named(arms, name)  # raises for an unknown one
        arms = self._tie(arms)  # the person sees where the real arms are
        self._arms = DrivenArms(arms, options.robot, options.follow)
        operator.note(
            instruction=self._instruction, success=False, blocked="", ended="", **self._names()
        )
        operator.phase = WAITING
        if options.waits:
            operator.wait_for(scene, "record")
            operator.phase = COUNTDOWN
            operator.wait_for(scene, seconds=options.countdown_s)
            arms = self._tie(arms)  # they may have been moved by hand meanwhile
            self._arms = DrivenArms(arms, options.robot, options.follow)
        operator.phase = RECORDING
        operator.note(dropped="")
        operator.call("begin")
        operator.forget_commands()
        self._due = time.monotonic()

    def act(self) -> DrivenArms | None:
        """Returns the arms with the commands of the next action; None before `begin` succeeded."""
        operator, arms = self._operator, self._arms
        if arms is None:
            return None
        operator.show(self._scene())
        operator.row = {}  # its images cannot be drawn later
        self._wait()
        motion = None if operator.stop.is_set else operator.read(self._seconds)
        operator.motions.append(motion)
        if operator.take("reset_origin"):
            operator.call("reset_origin")
        if operator.take("resync"):
            arms.resync()
        if operator.take("next_arm"):
            arms.choose_next()
        if operator.take("discard"):
            operator.stop.set()
        self.marked = operator.take("success", "failure") or self.marked
        if self.marked:
            self._is_done = True
            self.failure = MARKED if self.marked == "failure" else ""
        operator.note(success=self.succeeded)
        self.succeeded = False
        if operator.real_arms is not None:
            operator.real_arms.renew(arms.held_by(motion))
        arms.follow(motion, self._seconds)
        operator.note(blocked=arms.blocked, **self._names())
        return arms

    def done(self) -> bool:
        """Returns True after `success`, `failure` or the last action, when the episode is kept.

        A discarded one is not done.
        """
        if not self._is_done and len(self._operator.motions) < self._most_actions:
            return False
        return self.review()

    def ends_at_success(self) -> bool:
        """Is called after an action that is judged as a success; True if it ends the episode."""
        self.succeeded = True
        if not self._operator.options.ends_at_success:
            return False
        self._operator.note(success=True)
        return self.review()

    def review(self) -> bool:
        """Asks whether to keep the episode; after `discard` the rollout stops."""
        operator = self._operator
        if operator.stop.is_set:
            return False
        operator.untie()
        operator.phase = REVIEW
        operator.note(ended=self.failure or "ended")
        asks, scene = operator.options.asks, self._scene()
        if asks and operator.wait_for(scene, "keep", "discard") == "discard":
            operator.stop.set()
        return not operator.stop.is_set

    def _names(self) -> dict[str, Any]:
        """Returns which arms there are to choose from, and which one the device moves."""
        assert self._arms is not None
        if self._operator.device.arms:
            return {"arms": [], "arm": ""}
        return {"arms": self._arms.names, "arm": self._arms.name}

    def _tie(self, arms: list[Arm]) -> list[Arm]:
        if self._operator.real_arms is None or self._operator.stop.is_set:
            return arms
        return self._operator.real_arms.tie(arms)

    def _wait(self) -> None:
        """Waits until the next action is due; a slow computer begins to count again."""
        if not self._operator.options.real_time or self._operator.real_arms is not None:
            return  # steps of real arms take their time by themselves
        now = time.monotonic()
        if now < self._due:
            time.sleep(self._due - now)
        elif now > self._due + 2 * self._seconds:
            self._due = now
        self._due += self._seconds


class Teleoperator(Expert):
    """The expert of one rollout: acts as the operator's device moves."""

    def __init__(self, run: RunConfig, start: EpisodeStart, operator: Operator) -> None:
        super().__init__()
        self._operator = operator
        operator.max_steps = run.rates.max_steps
        # The last action is one before the run's `max_steps`, after which nothing could be asked.
        self._performance = Performance(
            operator,
            lambda: start.scene,
            run.rates.policy_period(),
            run.rates.max_steps - 1,
            start.task.instruction(),
        )

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Waits for `record`, and counts down."""
        try:
            self._performance.begin()
        except Error as error:  # else the runner would keep a failed episode
            self._operator.end(error)

    def see(self, row: Mapping[str, Any]) -> None:
        """Stores the recorded row, whose images are shown."""
        self._operator.row = row

    def act(self, scene: Scene, rng: Rng) -> dict[str, dict[str, GroupCommand]]:
        """Returns the commands that follow the device."""
        try:
            arms = self._performance.act()
            return {} if arms is None else arms.commands()
        except Error as error:
            self._operator.end(error)
            return {}

    def done(self) -> bool:
        """Returns True when the episode has ended and is kept."""
        return self._performance.done()

    def ends_at_success(self) -> bool:
        """Is called after an action that the task judges as a success."""
        return self._performance.ends_at_success()

    def failure(self) -> str:
        """Returns why the person ended the episode as a failure."""
        return self._performance.failure

    def phase(self) -> int:
        """Returns 0, the only phase."""
        return 0

    def phase_names(self) -> list[str]:
        """Returns no names."""
        return []
