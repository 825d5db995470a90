"""Several devices, each of which moves an arm of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from robocell._teleop.device import Device, Motion


class DeviceForEach(Device):
    """Devices by the names of the arms that they move.

    Args:
        devices: The devices, such as `{"left": ..., "right": ...}`.
    """

    def __init__(self, devices: Mapping[str, Device]) -> None:
        self._devices = dict(devices)
        self.arms = tuple(self._devices)
        self.help = "\n".join(
            f"{arm}: {device.help}" for arm, device in self._devices.items() if device.help
        )

    def start(self) -> None:
        """Opens the devices."""
        for device in self._devices.values():
            device.start()

    def read(self, seconds: float) -> Motion | None:
        """Returns the motions of the arms whose devices say something; None if none does."""
        said = {arm: device.read(seconds) for arm, device in self._devices.items()}
        commands = tuple(
            name for motion in said.values() if motion is not None for name in motion.commands
        )
        arms = {
            arm: replace(motion, commands=())
            for arm, motion in said.items()
            if motion is not None and motion.clutch
        }
        if not arms and not commands:
            heard = any(motion is not None for motion in said.values())
            return Motion(clutch=False) if heard else None
        return Motion(arms=arms, commands=commands, clutch=bool(arms))

    def begin(self) -> None:
        """Begins an episode."""
        for device in self._devices.values():
            device.begin()

    def reset_origin(self) -> None:
        """Makes the present poses of the devices their zeros."""
        for device in self._devices.values():
            device.reset_origin()

    def close(self) -> None:
        """Releases the devices, also if one of them fails."""
        first: BaseException | None = None
        for device in self._devices.values():
            try:
                device.close()
            except BaseException as error:
                first = first or error
        if first is not None:
            raise first
