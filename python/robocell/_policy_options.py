"""How an evaluation asks its policy for actions: names and units, horizon, ensembling, deadline."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from robocell._core import ArgumentError

if TYPE_CHECKING:
    from robocell._policy_presets import Preset

SCHEMES = ("ws://", "wss://", "zmq://")


def is_url(policy: str) -> bool:
    """Returns True for the URL of a policy server."""
    return policy.startswith(SCHEMES)


@dataclass(frozen=True)
class PolicyOptions:
    """Options of `robocell evaluate` about its policy.

    Attributes:
        preset: Name or file of the preset of a policy server; "" for none.
        horizon: Actions of a chunk that are taken before the next call; None for all, or those of
            the preset.
        ensemble: Average the predictions of several chunks for the same moment.
        timeout_s: Longest time of a call of a policy server; None for the default.
        latency_ms: Simulated time from an observation to the actions that follow from it; 0 lets
            the simulation wait for the policy.
    """

    preset: str = ""
    horizon: int | None = None
    ensemble: bool = False
    timeout_s: float | None = None
    latency_ms: float = 0.0

    def __post_init__(self) -> None:
        """Raises ArgumentError for numbers out of range."""
        if self.horizon is not None and self.horizon < 1:
            raise ArgumentError(f"horizon must be at least 1, got {self.horizon}")
        if self.timeout_s is not None and not 0 < self.timeout_s < float("inf"):
            raise ArgumentError(f"the policy's timeout must be above 0 s, got {self.timeout_s}")
        if not 0 <= self.latency_ms < float("inf"):
            raise ArgumentError(f"the policy's latency is at least 0 ms, got {self.latency_ms}")

    @property
    def suffix(self) -> str:
        """What distinguishes an evaluation with these options: " preset=droid horizon=8"."""
        parts = [
            f" preset={self.preset}" if self.preset else "",
            f" horizon={self.horizon}" if self.horizon is not None else "",
            " ensemble" if self.ensemble else "",
            f" latency={_plain(self.latency_ms)}" if self.latency_ms else "",
        ]
        return "".join(parts)

    def arguments(self) -> list[str]:
        """Returns the options of the command that gives them again."""
        return [
            *([f"--preset={self.preset}"] if self.preset else []),
            *([f"--horizon={self.horizon}"] if self.horizon is not None else []),
            *(["--ensemble"] if self.ensemble else []),
            *([f"--policy-timeout={self.timeout_s}"] if self.timeout_s is not None else []),
            *([f"--latency={_plain(self.latency_ms)}"] if self.latency_ms else []),
        ]

    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        """Adds the options of `arguments` to a parser."""
        parser.add_argument("--preset", default="")
        parser.add_argument("--horizon", type=int)
        parser.add_argument("--ensemble", action="store_true")
        parser.add_argument("--policy-timeout", type=float)
        parser.add_argument("--latency", type=float, default=0.0)

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> PolicyOptions:
        """Makes options from parsed arguments."""
        return cls(
            arguments.preset,
            arguments.horizon,
            arguments.ensemble,
            arguments.policy_timeout,
            arguments.latency,
        )

    def load_preset(self) -> Preset | None:
        """Reads the preset; None without one. Raises as `Preset.load`."""
        if not self.preset:
            return None
        from robocell._policy_presets import Preset

        return Preset.load(self.preset)

    def absolute(self) -> PolicyOptions:
        """Returns them with an absolute path of a preset's file."""
        if Path(self.preset).suffix not in (".yaml", ".yml"):
            return self
        return replace(self, preset=str(Path(self.preset).absolute()))


def delay_of(latency_ms: float, policy_ms: float | None) -> int:
    """Returns a latency in actions, rounded up. Raises ArgumentError if they have no time."""
    if not latency_ms:
        return 0
    if not policy_ms:
        raise ArgumentError(
            "a latency counts in actions of a fixed time, and those of this cell end on arrival: "
            "set rates.policy_ms"
        )
    return math.ceil(latency_ms / policy_ms - 1e-9)


def _plain(number: float) -> str:
    """Returns "80" for 80.0, all digits for others."""
    return repr(float(number)).removesuffix(".0")
