"""Real arms of a session: they are linked to the robots of its scene while an episode runs."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path

from robocell._core import ArgumentError, ArmLink, ArmPort, Error, SafetyOptions
from robocell._hardware.connecting import make_arm
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import place_of
from robocell._teleop.arms import Arm, arm_named


class ArmStoppedError(Error):
    """A real arm has stopped, or does not answer: the session ends."""


@dataclass
class RealArms:
    """Links arms of a scene to real ones, episode by episode.

    The robots of the scene begin where the arms and their grippers are measured: nothing moves
    before the person does. Between episodes the arms hold.

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

    def tie(self, arms: Sequence[Arm]) -> list[Arm]:
        """Links the robots, which are then where the arms are.

        Returns:
            The arms, with the openings that the real grippers have.

        Raises:
            NotFoundError: The scene has no such arm.
            Error: A real arm cannot be linked, does not answer, or its driver raises an error.
        """
        self.untie()
        found = list(arms)
        for name, port in self.ports.items():
            place = arm_named(arms, name)
            arm = arms[place]
            if arm.name in self._links:
                raise ArgumentError(f"two real arms are given for the arm '{arm.name}'")
            try:
                made = self._port(name, port, arm) if isinstance(port, str) else port
                link = ArmLink(arm.robot, made, safety=self.safety, group=arm.robot.arm.name)
            except Error:
                raise
            except RAISED as error:  # of a driver
                raise_interrupt(error)
                raise ArmStoppedError(f"the real arm '{arm.name}': {place_of(error)}") from error
            self._links[arm.name] = link
            found[place] = self._with_gripper(arm, link)
        return found

    def renew(self, names: Collection[str]) -> None:
        """The person holds the clutch of these arms: their dead man's switches are pressed."""
        for name, link in self._links.items():
            if name in names:
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

    def _with_gripper(self, arm: Arm, link: ArmLink) -> Arm:
        """Lets the commands of a gripper begin at its measured opening."""
        if arm.hand is not None:
            warnings.warn(
                f"the gripper of the arm '{arm.name}' is the robot '{arm.hand.name}', which no "
                "real arm moves: it stays a simulation. Describe arm and gripper in one robot file",
                stacklevel=2,
            )
        opening = link.measured.opening
        if opening is None or not arm.robot.has_gripper:
            return arm
        opening = min(max(opening, 0.0), 1.0)
        arm.robot.gripper.opening = opening
        return replace(arm, opening=opening)

    def _port(self, name: str, port: str, arm: Arm) -> ArmPort:
        """Returns the port by name, which is kept for the session."""
        if name not in self._made:
            self._made[name] = make_arm(port, arm.robot, self.config)
        return self._made[name]
