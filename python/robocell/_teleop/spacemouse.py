"""A SpaceMouse through hidapi: six axes that return to zero, and buttons."""

from __future__ import annotations

import struct
import time
from typing import Any

from robocell._extras import needed_by
from robocell._teleop.device import Device, DeviceLostError, Motion

VENDORS = (0x256F, 0x046D)  # 3Dconnexion, and Logitech before
PRODUCTS_OF_LOGITECH = range(0xC603, 0xC640)
FULL = 350.0  # counts of the full deflection
DEAD_ZONE = 0.05
FASTEST = (0.25, 1.2)  # m/s and rad/s
FRESH_S = 0.3  # a deflected SpaceMouse reports about every 10 ms
TRANSLATION, ROTATION, BUTTONS = 1, 2, 3  # numbers of reports


class SpaceMouse(Device):
    """Reads a SpaceMouse.

    Args:
        opened: An open hid device, in the place of the first one that is found.
    """

    help = (
        "SpaceMouse: push and turn the cap; the left button opens and closes the gripper, the "
        "right one records, keeps, and ends an episode"
    )

    def __init__(self, opened: Any = None) -> None:
        self._device = opened
        self._counts = [0.0] * 6
        self._rest = [0.0] * 6
        self._buttons = 0
        self._heard = 0.0
        self._closed_hand = False

    def start(self) -> None:
        """Opens the SpaceMouse."""
        if self._device is not None:
            return
        with needed_by("robocell teleop --device spacemouse", "teleop"):
            import hid
        for each in hid.enumerate():
            vendor, product = each["vendor_id"], each["product_id"]
            if vendor == VENDORS[0] or (vendor == VENDORS[1] and product in PRODUCTS_OF_LOGITECH):
                self._device = hid.device()
                try:
                    self._device.open_path(each["path"])
                except OSError as error:
                    raise DeviceLostError(
                        f"cannot open the SpaceMouse: {error}. A udev rule for vendor "
                        f"{vendor:04x} must let you read hidraw"
                    ) from error
                self._device.set_nonblocking(True)
                return
        raise DeviceLostError("no SpaceMouse was found; plug one in")

    def read(self, seconds: float) -> Motion | None:
        """Returns the displacement of the cap's speed."""
        pressed = self._reports()
        if time.monotonic() - self._heard > FRESH_S:
            self._counts = list(self._rest)  # a lost report must not leave the arm moving
        moved = [self._deflection(axis) for axis in range(6)]
        linear, angular = FASTEST[0] * seconds, FASTEST[1] * seconds
        opening = None
        if pressed & 1:
            self._closed_hand = not self._closed_hand
            opening = 0.0 if self._closed_hand else 1.0
        # Reports have x right, y towards the person, z down.
        return Motion(
            translation=(-linear * moved[1], -linear * moved[0], -linear * moved[2]),
            rotation=(-angular * moved[4], -angular * moved[3], -angular * moved[5]),
            opening=opening,
            commands=("record", "success", "keep") if pressed & 2 else (),
        )

    def begin(self) -> None:
        """Begins with an open hand again."""
        self._closed_hand = False

    def reset_origin(self) -> None:
        """Takes the present deflection as rest."""
        self._rest = list(self._counts)

    def close(self) -> None:
        """Closes the device."""
        if self._device is not None:
            self._device.close()
            self._device = None

    def _reports(self) -> int:
        """Takes what has arrived; returns the buttons that were pressed, as bits."""
        pressed = 0
        while True:
            try:
                data = bytes(self._device.read(64))
            except (OSError, ValueError) as error:
                raise DeviceLostError(f"the SpaceMouse is gone: {error}") from error
            if not data:
                return pressed
            self._heard = time.monotonic()
            number, body = data[0], data[1:]
            if number == TRANSLATION and len(body) >= 6:
                self._counts[:3] = struct.unpack_from("<3h", body)
                if len(body) >= 12:  # newer models send all six at once
                    self._counts[3:] = struct.unpack_from("<3h", body, 6)
            elif number == ROTATION and len(body) >= 6:
                self._counts[3:] = struct.unpack_from("<3h", body)
            elif number == BUTTONS and body:
                pressed |= body[0] & ~self._buttons
                self._buttons = body[0]

    def _deflection(self, axis: int) -> float:
        value = (self._counts[axis] - self._rest[axis]) / FULL
        beyond = max(abs(value) - DEAD_ZONE, 0.0) / (1 - DEAD_ZONE)
        return min(beyond, 1.0) * (1 if value > 0 else -1)
