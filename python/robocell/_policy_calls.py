"""Calls of a policy in a rollout: when, and how long each took.

An evaluation keeps them as `policy_calls/<rollout>.json` beside its rollouts. Times are those of
the clock, so two evaluations never have equal ones; the rollouts themselves do not contain them.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robocell._core import IoError, atomic_write
from robocell._durable import flush_path
from robocell._stored_files import read_stored

FOLDER = "policy_calls"


@dataclass
class PolicyCalls:
    """Calls of the policy in the present rollout of this process.

    Attributes:
        rollout: Id of the rollout.
        seed: Seed of the run.
        calls: For each call the number of actions taken before, the number of actions that it
            returned, and its time `ms` with the drawing of images that the policy read; of a
            policy behind a socket also `round_trip_ms` and `server_ms`; and `delay`, the actions
            that were taken meanwhile, if each call has a latency of its own.
        error: Error of the policy that ended the rollout; "" without one.
    """

    rollout: str = ""
    seed: int = 0
    calls: list[dict[str, float]] = field(default_factory=list)
    error: str = ""

    def begin(self) -> None:
        """Forgets the last rollout."""
        self.calls, self.error = [], ""

    def add(self, step: int, actions: int, ms: float, timing: Mapping[str, float]) -> None:
        """Adds a call."""
        finite = {name: round(value, 4) for name, value in timing.items() if math.isfinite(value)}
        self.calls.append({"step": step, "actions": actions, "ms": round(ms, 4), **finite})

    def note_delay(self, delay: int) -> None:
        """Adds the latency of the last call, in actions."""
        self.calls[-1]["delay"] = delay

    def save(self, dataset: Path, result: Mapping[str, Any] | None = None) -> None:
        """Writes the calls of a rollout, and its result if nothing else stores it.

        Raises IoError.
        """
        folder = dataset / FOLDER
        try:
            if not folder.is_dir():
                folder.mkdir(exist_ok=True)
                flush_path(dataset)  # or a power cut takes the folder away
        except OSError as error:
            raise IoError(f"cannot make '{folder}': {error.strerror}") from error
        record = {"rollout": self.rollout, "calls": self.calls, "error": self.error}
        text = json.dumps(record if result is None else record | {"result": result})
        atomic_write(folder / f"{self.rollout}.json", f"{text}\n".encode())


# A worker process makes one rollout at a time.
present = PolicyCalls()


def latency(dataset: Path, rollouts: Iterable[str]) -> dict[str, float]:
    """Returns the number of calls in these rollouts with median, 99th percentile and maximum in ms.

    Rollouts without a record are left out; {} if there is none.
    """
    times = [
        float(call["ms"])
        for rollout in rollouts
        for call in _read(dataset, rollout).get("calls", [])
    ]
    if not times:
        return {}
    import numpy as np  # the command line loads this module, and does without

    median, high = np.percentile(times, [50, 99])
    return {
        "calls": len(times),
        "median_ms": round(float(median), 4),
        "p99_ms": round(float(high), 4),
        "max_ms": max(times),
    }


def recorded_calls(dataset: Path, rollout: str) -> list[dict[str, float]]:
    """Returns the calls in a rollout; [] without a record, or if it is damaged."""
    calls: list[dict[str, float]] = _read(dataset, rollout).get("calls", [])
    return calls


def ms_of_call(call: Mapping[str, float]) -> float:
    """Returns the time from an observation to its actions: without drawing, where that is known."""
    return float(call.get("round_trip_ms", call["ms"]))


def error_of(dataset: Path, rollout: str) -> str:
    """Returns the error of the policy that ended a rollout; "" without one."""
    return str(_read(dataset, rollout).get("error", ""))


def result_of_rollout(dataset: Path, rollout: str) -> dict[str, Any] | None:
    """Returns the result of a rollout that was not kept; None for others."""
    result = _read(dataset, rollout).get("result")
    return result if isinstance(result, dict) else None


def _read(dataset: Path, rollout: str) -> dict[str, Any]:
    """Returns the record of a rollout; {} without one, or if it is damaged."""
    try:
        stored = json.loads(read_stored(dataset / FOLDER / f"{rollout}.json"))
    except (OSError, ValueError):
        return {}
    calls = stored.get("calls") if isinstance(stored, dict) else None
    return stored if isinstance(calls, list) else {}
