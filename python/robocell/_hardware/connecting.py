"""Connects a robot of a scene to a real arm, or to nothing, for the same program."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from robocell._core import (
    ArgumentError,
    ArmLink,
    ArmPort,
    Robot,
    SafetyOptions,
    SpecError,
    UdpArm,
    UdpArmServer,
)
from robocell._suggestions import did_you_mean

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MODES = ("sim", "real")
ARRIVED = 0.01  # rad or m, as ArmLink.move_to
POLL_S = 0.001
NAMES = {
    "udp:HOST:PORT": "an arm behind a UdpArmServer",
    "lerobot:Class": "a LeRobot Robot, such as SO101Follower, or module:Class",
    "file:FILE.yaml": "a LeRobot Robot, described by a file",
    "module:Class": "your own robocell.hardware.ArmPort, called with the robot",
}


class Connected(Protocol):
    """What a program sees of an arm: an `ArmLink`, or the simulation in its place."""

    @property
    def ok(self) -> bool:
        """True while steps drive the arm."""

    @property
    def state(self) -> str:
        """State of the arm, such as "running", "holding" or "stopped"."""

    @property
    def reason(self) -> str:
        """Why it holds or has stopped."""

    def renew(self) -> None:
        """The dead man's switch is pressed."""

    def stop(self, reason: str = ...) -> None:
        """Stops for good."""

    def move_to(self, q: ArrayLike, timeout: float = ...) -> bool:
        """Moves the joints there."""


class Simulation:
    """Stands in for an `ArmLink` where the scene itself is the arm."""

    def __init__(self, robot: Robot, group: str = "") -> None:
        self._robot, self._reason = robot, ""
        self._arm = robot.group(group) if group else robot.arm

    @property
    def ok(self) -> bool:
        """True until `stop`."""
        return not self._reason

    @property
    def state(self) -> str:
        """State of the simulation: "running" or "stopped"."""
        return "stopped" if self._reason else "running"

    @property
    def reason(self) -> str:
        """Why it was stopped."""
        return self._reason

    def renew(self) -> None:
        """Does nothing."""

    def stop(self, reason: str = "stopped by the program") -> None:
        """Ends `ok`."""
        self._reason = self._reason or reason

    def move_to(self, q: ArrayLike, timeout: float = 30.0) -> bool:
        """Commands the joints and steps the scene until they are there, or `timeout` is over."""
        import numpy as np  # the package loads this module, and does without

        robot, scene, arm = self._robot, self._robot.scene, self._arm
        if arm.name == robot.arm.name:
            robot.jnt_pos_cmd[:] = q
        else:
            robot.controller(arm.name).target = q
        end = scene.time() + timeout
        while self.ok and scene.time() < end:
            robot.update()
            if not robot.step().ok:
                return False
            if abs(arm.joint_pos - np.asarray(q, dtype=float)).max() <= ARRIVED:
                return True
        return False


def make_arm(name: str, robot: Robot, config: str | Path | None = None, **options: Any) -> ArmPort:
    """Returns the port of an arm.

    Args:
        name: One of `NAMES`, such as "udp:127.0.0.1:7071".
        robot: The robot that it is.
        config: A YAML file with its options, for `lerobot:` and classes of one's own.
        options: Those of `UdpArm`, for `udp:`.

    Raises:
        ArgumentError: There is no such arm.
        SpecError: Its module or file cannot be used.
        IoError: It does not answer.
    """
    kind, _, rest = name.partition(":")
    file = None if config is None else Path(config)
    if kind == "udp" and rest:
        if file is not None:
            raise ArgumentError(f"arm '{name}' has no options in a file; leave out config='{file}'")
        return UdpArm(rest, **options)
    if options:
        raise ArgumentError(f"arm '{name}' has no option '{next(iter(options))}'")
    if kind == "file" and file is not None:
        raise ArgumentError(f"arm '{name}' has its options in its file; leave out config='{file}'")
    if kind in ("lerobot", "file") and rest:
        from robocell._hardware.lerobot_arm import LeRobotArm

        if kind == "file":
            return LeRobotArm.of_file(Path(rest), robot)
        return LeRobotArm.of_name(rest, robot, file)
    if rest:
        return _own(name, robot, file)
    names = "".join(f"\n  {each}: {what}" for each, what in NAMES.items())
    known = [each.partition(":")[0] for each in NAMES]
    raise ArgumentError(f"no arm '{name}'.{did_you_mean(name, known)} There are:{names}")


def _own(name: str, robot: Robot, config: Path | None) -> ArmPort:
    """Returns an arm of the user's own class."""
    from robocell._generation.run_source import import_module
    from robocell._teleop.devices import options_of

    module_name, _, attribute = name.rpartition(":")
    maker = getattr(import_module(module_name, Path.cwd()), attribute, None)
    if not callable(maker):
        raise SpecError(f"arm '{name}': module '{module_name}' has no class '{attribute}'")
    made = maker(robot, **options_of(config))
    if not isinstance(made, ArmPort):
        raise SpecError(
            f"arm '{name}': {attribute} is a {type(made).__name__}; an arm is a "
            "robocell.hardware.ArmPort"
        )
    return made


@contextmanager
def connect(
    robot: Robot,
    mode: str = "real",
    arm: str | ArmPort = "",
    *,
    safety: SafetyOptions | None = None,
    period: float = 0.004,
    group: str = "",
    config: str | Path | None = None,
    **options: Any,
) -> Iterator[Connected]:
    """Connects a robot of a scene to a real arm, or leaves it a simulation.

    Args:
        robot: The robot.
        mode: "sim" or "real".
        arm: The arm, for "real": a name for `make_arm`, or a port.
        safety: How the arm is guarded.
        period: Seconds between two commands.
        group: The arm of the robot, if it has several.
        config: A YAML file with options of the arm.
        options: Those of `UdpArm`.

    Yields:
        An `ArmLink`, or an object with its properties and methods that every program needs: `ok`,
        `state`, `reason`, `renew`, `stop`, `move_to`. At the end the arm holds.

    Raises:
        ArgumentError: There is no such mode or arm.

    Examples:
        >>> with rc.hardware.connect(robot, "sim") as arm:
        ...     arm.move_to(robot.jnt_pos_msr)
        True
    """
    if mode not in MODES:
        raise ArgumentError(f"no mode '{mode}'; there are {' and '.join(MODES)}")
    if mode == "sim":
        yield Simulation(robot, group)
        return
    if isinstance(arm, str) and not arm:
        raise ArgumentError('mode "real" needs an arm, such as "udp:127.0.0.1:7071"')
    if not isinstance(arm, str) and (options or config is not None):
        given = next(iter(options), "config")
        raise ArgumentError(f"'{given}' is an option of an arm by name; this arm is made already")
    port = make_arm(arm, robot, config, **options) if isinstance(arm, str) else arm
    try:
        with ArmLink(robot, port, safety=safety, period=period, group=group) as link:
            yield link
    finally:
        if isinstance(arm, str) and (close := getattr(port, "close", None)):
            close()


@contextmanager
def serving(server: UdpArmServer) -> Iterator[UdpArmServer]:
    """Polls a server in a thread of its own until the end of the block.

    Args:
        server: The server. Nobody else uses it or its arm meanwhile.

    Raises:
        Error: What the arm raised meanwhile, at the end of the block.
    """
    ends = threading.Event()
    raised: list[BaseException] = []

    def poll() -> None:
        try:
            while not ends.is_set():
                server.poll()
                time.sleep(POLL_S)
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=poll, name=f"arm at {server.address}", daemon=True)
    thread.start()
    try:
        yield server
    finally:
        ends.set()
        thread.join()
    if raised:
        raise raised[0]
