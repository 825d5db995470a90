"""Simulated time between an observation of a policy and the actions that follow from it.

Latency.parse(80)                  # every call takes 80 ms
Latency.parse("measured")          # each call takes as long as it took by the clock
Latency.parse("recorded:out/eval") # each call takes as long as the one of that evaluation
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from robocell._core import ArgumentError
from robocell._policy_calls import FOLDER, PolicyCalls, ms_of_call, recorded_calls
from robocell._suggestions import shortened

MEASURED, RECORDED = "measured", "recorded:"


@dataclass(frozen=True)
class Latency:
    """Latency of the calls of a policy.

    Attributes:
        ms: That of each call, in milliseconds; 0 lets the simulation wait for the policy.
        measured: Each call has its own time by the clock.
        folder: Folder of an evaluation whose calls are repeated; "" for none.
    """

    ms: float = 0.0
    measured: bool = False
    folder: str = ""

    @classmethod
    def parse(cls, value: float | str | Latency) -> Latency:
        """Reads milliseconds, "measured" or "recorded:FOLDER". Raises ArgumentError for others."""
        if isinstance(value, Latency):
            return value
        if value == MEASURED:
            return cls(measured=True)
        if isinstance(value, str) and value.startswith(RECORDED) and value != RECORDED:
            return cls(folder=value.removeprefix(RECORDED))
        try:
            ms = float(value)
        except (TypeError, ValueError):
            raise ArgumentError(
                f"latency {value!r}: expected milliseconds, '{MEASURED}' or '{RECORDED}FOLDER' of "
                "an evaluation"
            ) from None
        if not 0 <= ms < math.inf:
            raise ArgumentError(f"the policy's latency is at least 0 ms, got {ms:g}")
        return cls(ms)

    def __bool__(self) -> bool:
        """Returns False if the simulation waits for the policy."""
        return bool(self.ms or self.is_of_calls)

    @property
    def is_of_calls(self) -> bool:
        """Whether each call has its own latency."""
        return self.measured or bool(self.folder)

    def __str__(self) -> str:
        """Returns what `parse` reads."""
        if self.measured:
            return MEASURED
        if self.folder:
            return f"{RECORDED}{self.folder}"
        return repr(float(self.ms)).removesuffix(".0")

    def absolute(self) -> Latency:
        """Returns it with an absolute folder."""
        return replace(self, folder=str(Path(self.folder).absolute())) if self.folder else self

    def require_recorded(self, rollouts: Iterable[str]) -> None:
        """Raises ArgumentError if the folder lacks the calls of one of these rollouts.

        Rollouts that an error of the policy ended may have none.
        """
        if not self.folder:
            return
        folder, missing, there = Path(self.folder), [], 0
        for rollout in rollouts:
            if recorded_calls(folder, rollout):
                there += 1
            elif not self._had_no_calls(rollout):
                missing.append(rollout)
        if not missing and there:
            return
        lacks = f"the calls of {shortened(missing)}" if there else f"'{FOLDER}' with these rollouts"
        raise ArgumentError(
            f"--latency {self}: the folder lacks {lacks}. Name the folder of an evaluation that "
            "`robocell evaluate` completed, with at least as many rollouts"
        )

    def calls_of(self, rollout: str) -> list[float]:
        """Returns the milliseconds of a rollout's recorded calls.

        Raises ArgumentError if the folder lacks them.
        """
        calls = recorded_calls(Path(self.folder), rollout) if rollout else []
        if not calls and not (rollout and self._had_no_calls(rollout)):
            raise ArgumentError(
                f"latency '{self}': the folder lacks the calls of this rollout. `robocell "
                "evaluate` repeats latencies that it recorded; other runs take milliseconds or "
                f"'{MEASURED}'"
            )
        return [ms_of_call(call) for call in calls]

    def _had_no_calls(self, rollout: str) -> bool:
        """Returns whether an error of the policy ended it, perhaps before its first call."""
        from robocell._evaluated import rollout_end

        end = rollout_end(Path(self.folder), rollout)
        return end is not None and end.policy_error


class CallDelays:
    """Latencies of the calls of one rollout after another, in actions.

    Args:
        latency: The latency.
        policy_ms: Time of an action; None if actions end on arrival, which a latency excludes.
    """

    def __init__(self, latency: Latency | None = None, policy_ms: float | None = None) -> None:
        self._latency, self._policy_ms = latency or Latency(), policy_ms
        if self._latency and not policy_ms:
            raise ArgumentError(
                "a latency counts in actions of a fixed time, and those of this cell end on "
                "arrival: set rates.policy_ms"
            )
        self._recorded: list[float] = []

    @property
    def are_of_calls(self) -> bool:
        """Whether each call has its own."""
        return self._latency.is_of_calls

    @property
    def fixed(self) -> int:
        """That of all calls; 0 if each has its own."""
        return self._actions(self._latency.ms)

    def begin(self, rollout: str) -> None:
        """Begins a rollout. Raises ArgumentError if its recorded calls are missing."""
        if self._latency.folder:
            self._recorded = self._latency.calls_of(rollout)

    def of_last(self, calls: PolicyCalls) -> int:
        """Returns the latency of the last of the present rollout's calls.

        Calls beyond the recorded ones take as long as the last of these.
        """
        if self._latency.measured:
            return self._actions(ms_of_call(calls.calls[-1]))
        if not self._recorded:
            return self.fixed
        return self._actions(self._recorded[min(len(calls.calls), len(self._recorded)) - 1])

    def _actions(self, ms: float) -> int:
        """Rounds up."""
        return math.ceil(ms / self._policy_ms - 1e-9) if ms and self._policy_ms else 0
