"""Real arms of a session: they are linked to the robots of its scene while an episode runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from robocell._core import ArgumentError, ArmLink, ArmPort, Error, SafetyOptions
from robocell._hardware.connecting import make_arm
from robocell._teleop.arms import Arm, arm_named


class ArmStoppedError(Error):
    """A real arm has stopped, or does not answer: the session ends."""


@dataclass
class RealArms:
    """Links arms of a scene to real ones, episode by episode.

    The robots of the scene begin where the arms are measured: nothing moves before the person
    does. Between episodes the arms hold.

    Attributes:
        ports: The arms by the names of those of the scene, "" for the first one: names for
            `robocell.hardware.make_arm`, or ports.
        config: A YAML file with the options of arms that are given by name.
        safety: How they are guarded.
    """

    ports: Mapping[str, str | ArmPort]
    config: Path | None = None
    safety: SafetyOptions = field(default_factory=SafetyOptions)

    def __post_init__(self) -> None:
        """Raises ArgumentError without an arm."""
        if not self.ports:
            raise ArgumentError('mode "real" needs an arm, such as --arm udp:127.0.0.1:7071')
        self._links: dict[str, ArmLink] = {}
        self._made: dict[str, ArmPort] = {}
        self._reason = ""

    @property
    def reason(self) -> str:
        """Why an arm has stopped; "" while all go on."""
        for link in self._links.values():
            if not link.ok and not link.closed:
                self._reason = self._reason or link.reason
        return self._reason

    def tie(self, arms: Sequence[Arm]) -> None:
        """Links the robots, which are then where the arms are.

        Raises:
            NotFoundError: The scene has no such arm.
            Error: A real arm cannot be linked, or does not answer.
        """
        self.untie()
        for name, port in self.ports.items():
            arm = arms[arm_named(arms, name)]
            made = self._port(name, port, arm) if isinstance(port, str) else port
            if arm.name in self._links:
                raise ArgumentError(f"two real arms are given for the arm '{arm.name}'")
            self._links[arm.name] = ArmLink(
                arm.robot, made, safety=self.safety, group=arm.robot.arm.name
            )

    def renew(self) -> None:
        """The person holds the clutch: the dead man's switch of the arms is pressed."""
        for link in self._links.values():
            link.renew()

    def untie(self) -> None:
        """Brakes and holds the arms. May be repeated."""
        _ = self.reason
        with ExitStack() as stack:
            for link in self._links.values():
                stack.callback(link.close)
        self._links = {}

    def close(self) -> None:
        """Holds the arms and disconnects those that were made here."""
        with ExitStack() as stack:
            for port in self._made.values():
                stack.callback(getattr(port, "close", lambda: None))
            self._made = {}
            self.untie()

    def _port(self, name: str, port: str, arm: Arm) -> ArmPort:
        """Returns the port by name, which is kept for the session."""
        if name not in self._made:
            self._made[name] = make_arm(port, arm.robot, self.config)
        return self._made[name]
