"""How an evaluation asks its policy for actions: names and units, horizon, ensembling, deadline."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from robocell._core import ArgumentError
from robocell._policy_latency import Latency

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
        latency: Simulated time from an observation to the actions that follow from it.
        stores: Keep the rollouts, not only their results. Does not distinguish evaluations.
    """

    preset: str = ""
    horizon: int | None = None
    ensemble: bool = False
    timeout_s: float | None = None
    latency: Latency = field(default_factory=Latency)
    stores: bool = True

    def __post_init__(self) -> None:
        """Raises ArgumentError for numbers out of range."""
        if self.horizon is not None and self.horizon < 1:
            raise ArgumentError(f"horizon must be at least 1, got {self.horizon}")
        if self.timeout_s is not None and not 0 < self.timeout_s < float("inf"):
            raise ArgumentError(f"the policy's timeout must be above 0 s, got {self.timeout_s}")

    @property
    def suffix(self) -> str:
        """What distinguishes an evaluation with these options: " preset=droid horizon=8"."""
        parts = [
            f" preset={self.preset}" if self.preset else "",
            f" horizon={self.horizon}" if self.horizon is not None else "",
            " ensemble" if self.ensemble else "",
            f" latency={self.latency}" if self.latency else "",
        ]
        return "".join(parts)

    def arguments(self) -> list[str]:
        """Returns the options of the command that gives them again."""
        return [
            *([f"--preset={self.preset}"] if self.preset else []),
            *([f"--horizon={self.horizon}"] if self.horizon is not None else []),
            *(["--ensemble"] if self.ensemble else []),
            *([f"--policy-timeout={self.timeout_s}"] if self.timeout_s is not None else []),
            *([f"--latency={self.latency}"] if self.latency else []),
            *([] if self.stores else ["--no-rollouts"]),
        ]

    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        """Adds the options of `arguments` to a parser."""
        parser.add_argument("--preset", default="")
        parser.add_argument("--horizon", type=int)
        parser.add_argument("--ensemble", action="store_true")
        parser.add_argument("--policy-timeout", type=float)
        parser.add_argument("--latency", default="0")
        parser.add_argument("--no-rollouts", action="store_true")

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> PolicyOptions:
        """Makes options from parsed arguments."""
        return cls(
            arguments.preset,
            arguments.horizon,
            arguments.ensemble,
            arguments.policy_timeout,
            Latency.parse(arguments.latency),
            not arguments.no_rollouts,
        )

    def load_preset(self) -> Preset | None:
        """Reads the preset; None without one. Raises as `Preset.load`."""
        if not self.preset:
            return None
        from robocell._policy_presets import Preset

        return Preset.load(self.preset)

    def absolute(self) -> PolicyOptions:
        """Returns them with absolute paths of a preset's file and of a recorded evaluation."""
        latency = self.latency.absolute()
        if Path(self.preset).suffix not in (".yaml", ".yml"):
            return replace(self, latency=latency)
        return replace(self, latency=latency, preset=str(Path(self.preset).absolute()))
