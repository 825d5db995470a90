"""Results of an evaluation that keeps no rollouts, beside the calls of the policy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from robocell._generation.items import ItemRecord
from robocell._policy_calls import PolicyCalls, result_of_rollout


@dataclass(frozen=True)
class UnstoredRollout:
    """A rollout of which the result is there.

    Attributes:
        record: The item's result.
        failure: Why it failed; "" if it succeeded.
    """

    record: ItemRecord
    failure: str

    def save(self, calls: PolicyCalls, dataset: Path) -> None:
        """Writes it, with the rollout's calls of the policy. Raises IoError."""
        calls.save(dataset, {"record": self.record.to_json(), "failure": self.failure})

    @classmethod
    def find(cls, dataset: Path, rollout: str) -> UnstoredRollout | None:
        """Reads the one of this id; None if it is not there, or damaged."""
        result = result_of_rollout(dataset, rollout)
        if result is None:
            return None
        try:
            return cls(ItemRecord.from_json(result["record"]), str(result["failure"]))
        except (TypeError, KeyError):
            return None
