"""A value that was read off a model, with the reason for it and how sure it is.

Every line of a robot file that `robocell init` writes comes from a guess, and carries it as a
comment:

    Guess("tcp", "the only site between the fingers", Confidence.HIGH).comment()
    # 'the only site between the fingers [sure]'
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


class Confidence(enum.Enum):
    """Confidence of a guess; the value is the word in comments."""

    HIGH = "sure"
    MEDIUM = "likely"
    LOW = "unsure, please check"


@dataclass(frozen=True)
class Guess(Generic[T]):
    """A value with its reason.

    Attributes:
        value: What is written.
        reason: Why, as a clause that can follow a colon.
        confidence: How sure it is.
        alternatives: Other values that the model allows, nearest first.
    """

    value: T
    reason: str
    confidence: Confidence
    alternatives: tuple[T, ...] = ()

    def comment(self) -> str:
        """Returns the reason, the confidence, and the alternatives of a guess that is not sure."""
        text = f"{self.reason} [{self.confidence.value}]"
        if self.alternatives and self.confidence is not Confidence.HIGH:
            text += f"; instead of it: {shortened([str(value) for value in self.alternatives])}"
        return text


def shortened(names: list[str], most: int = 6) -> str:
    """Returns 'a, b, c and 4 more'."""
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[:most])} and {len(names) - most} more"
