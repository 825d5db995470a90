"""Who acts in an evaluation: an error of a policy or an expert ends its rollout as a failure.

The rollout ends where the error came, and is committed with its reason and its video. No other
start takes its place, which the other policies would not get.
"""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol, runtime_checkable

import numpy as np

from robocell import _core
from robocell._core import (
    ArgumentError,
    ClosedError,
    DivergedError,
    EngineError,
    EpisodeStart,
    Error,
    Expert,
    GroupCommand,
    IoError,
    Rng,
    RunConfig,
    Scene,
    SpecError,
)
from robocell._own_code import RAISED

# The reason of a rollout that an error of a policy or an expert ended begins with this.
POLICY_ERROR = "policy error: "
LONGEST_MESSAGE = 300  # characters; where it happened comes after it

ExpertMaker = Callable[[RunConfig, EpisodeStart], Expert]
Action = dict[str, dict[str, GroupCommand]]

_printed: set[str] = set()


@runtime_checkable
class ActsFor(Protocol):
    """An expert that somebody's policy acts for."""

    @property
    def policy(self) -> object:
        """The policy."""


def ending_at_errors(maker: ExpertMaker) -> ExpertMaker:
    """Returns a maker of the same experts; an error of theirs, or of `maker`, ends the rollout."""

    def make(run: RunConfig, start: EpisodeStart) -> Expert:
        try:
            expert = maker(run, start)
            if not isinstance(expert, Expert):
                raise TypeError(f"expected an Expert, got a {type(expert).__name__}")
        except RAISED as error:
            return _EndingAtErrors(None, _reason(error, maker))
        if type(expert).see is Expert.see:
            return _EndingAtErrors(expert)
        return _SeeingEndingAtErrors(expert)

    return make


class ExplainedStart:
    """Makes the experts of one item after the other, and says what raised in a rollout.

    In an evaluation the runner takes no other start in place of one whose rollout raised: it would
    not be the one that other policies get. Experts end at their own errors, so it is something
    else that raised, such as the task.
    """

    def __init__(self, maker: ExpertMaker) -> None:
        self._maker = maker
        self._made = False

    def __call__(self, run: RunConfig, start: EpisodeStart) -> Expert:
        """Makes an expert."""
        expert = self._maker(run, start)
        self._made = True
        return expert

    @contextmanager
    def explained(self) -> Iterator[None]:
        """For one item: an exception that a user's code raised beside the expert names it."""
        from robocell.generate.run_source import place_of

        self._made = False
        try:
            yield
        except (ClosedError, DivergedError, EngineError, IoError, SpecError):
            raise
        except RAISED as error:
            if not self._made:
                raise
            raise Error(
                "something else than the policy raised in the rollout, and an evaluation takes no "
                f"other start in its place: {place_of(error)}"
            ) from error


def expert_of_python(run: RunConfig) -> ExpertMaker | None:
    """Returns the maker of a run's expert that Python code registered; None for one of C++."""
    kind = run.expert or run.task.kind
    maker: ExpertMaker | None = _core._experts.get(kind)
    return maker


class _EndingAtErrors(Expert):
    """Acts as `expert` does until it raises; then the targets are held and the rollout ends."""

    def __init__(self, expert: Expert | None, error: str = "") -> None:
        super().__init__()
        self._expert, self._error = expert, error
        self._phase = 0

    def _tried(self, default: Any, call: Callable[[Any], Any]) -> Any:
        """Returns call(expert); the default after an error, the first of which is the reason."""
        if self._error or self._expert is None:
            return default
        try:
            return call(self._expert)
        except RAISED as error:
            self._error = _reason(error, self._expert)
            return default

    # Expert.act(expert, ...) also checks what the expert's own method returns.

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Begins, if that works."""
        self._tried(None, lambda expert: Expert.begin(expert, scene, rng))

    def act(self, scene: Scene, rng: Rng) -> Action:
        """Returns the expert's action; none after an error."""

        def checked(expert: Expert) -> Action:
            action = Expert.act(expert, scene, rng)
            _require_applicable(f"{type(expert).__name__}.act()", scene, action)
            return action

        action: Action = self._tried({}, checked)
        return action

    def done(self) -> bool:
        """Returns True when the expert is done, and after an error."""
        done = bool(self._tried(True, Expert.done))
        return done or bool(self._error)

    def ends_at_success(self) -> bool:
        """Returns what the expert says."""
        return bool(self._tried(False, lambda expert: bool(expert.ends_at_success())))

    def failure(self) -> str:
        """Returns the error, else what the expert says."""
        failure = str(self._tried("", Expert.failure))
        return self._error or failure

    def phase(self) -> int:
        """Returns the expert's phase; the last one after an error."""
        self._phase = int(self._tried(self._phase, Expert.phase))
        return self._phase

    def phase_names(self) -> list[str]:
        """Returns the expert's names, as far as it has any."""
        return list(self._tried([], Expert.phase_names))


class _SeeingEndingAtErrors(_EndingAtErrors):
    """The same for experts that see the recorded row; making it for others would cost time."""

    def see(self, row: dict[str, Any]) -> None:
        """Passes the row on."""
        self._tried(None, lambda expert: expert.see(row))


def _require_applicable(who: str, scene: Scene, action: Action) -> None:
    """Raises for what the robots would refuse: names, lengths, and numbers that are not finite."""
    for robot_name, commands in action.items():
        robot = scene.robot(robot_name)
        for group_name, command in commands.items():
            group = robot.group(group_name)
            values = np.asarray(command.values, dtype=np.float64)
            place = f"{who}: group '{group_name}' of robot '{robot_name}'"
            sizes = {"arm": len(group.joint_names), "gripper": 1}
            size = sizes.get(group.kind, len(values))
            if len(values) not in (0, size):
                raise ArgumentError(f"{place}: expected {size} values, got {len(values)}")
            pose = command.pose
            numbers = [*values, *pose.translation, *pose.quaternion]
            if not np.isfinite(numbers).all():
                raise ArgumentError(f"{place}: the command has a number that is not finite")


def _reason(error: BaseException, who: object) -> str:
    """Returns "policy error: KeyError: 'x' (mine.py:12, in act)", in one line.

    The traceback is printed once for each reason.
    """
    from robocell.generate.run_source import ends_with_place, text_of, where

    kind = "" if isinstance(error, Error) else f"{type(error).__name__}: "
    said = " ".join(f"{kind}{text_of(error)}".split())
    if len(said) > LONGEST_MESSAGE:
        said = said[:LONGEST_MESSAGE] + " ..."
    # Without a place the code did not raise, but what it returned is wrong.
    place = "" if ends_with_place(said) else where(error) or _home_of(who)
    reason = POLICY_ERROR + said + place
    if reason not in _printed:
        _printed.add(reason)
        traceback.print_exception(error, file=sys.stderr)
    return reason


def _home_of(who: object) -> str:
    """Returns ' (mine.py:12)', where somebody's policy or expert acts; '' when nothing says so."""
    actor = who.policy if isinstance(who, ActsFor) else who
    code = actor if inspect.isroutine(actor) else getattr(type(actor), "act", None)
    try:
        function = inspect.unwrap(code)  # type: ignore[arg-type]
        return f" ({function.__code__.co_filename}:{function.__code__.co_firstlineno})"
    except AttributeError:
        return ""
