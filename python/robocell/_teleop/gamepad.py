"""A gamepad through evdev, with the layout that Linux gives to gamepads."""

from __future__ import annotations

from typing import Any

from robocell._extras import needed_by
from robocell._teleop.device import Device, DeviceLostError, Motion

FASTEST = (0.2, 1.0)  # m/s and rad/s
DEAD_ZONE = 0.12  # of the full deflection
# Codes of linux/input-event-codes.h
EV_SYN, EV_KEY, EV_ABS = 0, 1, 3
SYN_REPORT, SYN_DROPPED = 0, 3
ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ, ABS_HAT0X, ABS_HAT0Y = 0, 1, 2, 3, 4, 5, 16, 17
SOUTH, EAST, NORTH, WEST, LEFT, RIGHT, SELECT, START = 304, 305, 307, 308, 310, 311, 314, 315
LEFT_STICK = 317
COMMANDS = {
    START: ("record", "keep"),
    NORTH: ("success",),
    WEST: ("failure",),
    SELECT: ("discard",),
    LEFT_STICK: ("next_arm",),
}


class Gamepad(Device):
    """Reads a gamepad.

    Args:
        path: Its file, /dev/input/event3; "" for the first one.
        opened: An open device, in the place of a file.
    """

    help = (
        "gamepad: left stick forward and left, triggers down and up, right stick yaw and pitch, "
        "hat roll; south closes, east opens the gripper; the right shoulder holds the clutch open; "
        "start records and keeps, north success, west failure, select discards, left shoulder "
        "re-sync, the left stick pressed chooses the next arm"
    )

    def __init__(self, path: str = "", opened: Any = None) -> None:
        self._path, self._device = path, opened
        self._axes: dict[int, float] = {}
        self._ranges: dict[int, tuple[float, float]] = {}
        self._held: set[int] = set()
        self._rest: dict[int, float] = {}
        self._has_lost_events = False

    def start(self) -> None:
        """Opens the gamepad."""
        if self._device is None:
            with needed_by("robocell teleop --device gamepad", "teleop"):
                import evdev

            self._device = self._found(evdev)
        for code, info in self._device.capabilities().get(EV_ABS, []):
            self._ranges[code] = (float(info.min), float(info.max))
            self._axes[code] = self._normal(code, float(info.value))
        self.reset_origin()

    def read(self, seconds: float) -> Motion | None:
        """Returns the displacement of the sticks' speeds."""
        pressed = self._events()
        linear, angular = FASTEST[0] * seconds, FASTEST[1] * seconds
        opening = {SOUTH: 0.0, EAST: 1.0}
        commands = [name for code in pressed for name in COMMANDS.get(code, ())]
        if LEFT in pressed:
            commands.append("resync")
        return Motion(
            translation=(
                -linear * self._stick(ABS_Y),
                -linear * self._stick(ABS_X),
                linear * (self._trigger(ABS_RZ) - self._trigger(ABS_Z)),
            ),
            rotation=(
                angular * self._axes.get(ABS_HAT0X, 0.0),
                -angular * self._stick(ABS_RY),
                -angular * self._stick(ABS_RX),
            ),
            opening=next((opening[code] for code in pressed[::-1] if code in opening), None),
            clutch=RIGHT not in self._held,
            commands=tuple(commands),
        )

    def reset_origin(self) -> None:
        """Takes the present deflection of the sticks as their rest."""
        self._rest = {code: self._axes.get(code, 0.0) for code in (ABS_X, ABS_Y, ABS_RX, ABS_RY)}

    def close(self) -> None:
        """Closes the gamepad."""
        if self._device is not None:
            self._device.close()
            self._device = None

    def _found(self, evdev: Any) -> Any:
        try:
            if self._path:
                return evdev.InputDevice(self._path)
            for path in evdev.list_devices():
                device = evdev.InputDevice(path)
                if SOUTH in device.capabilities().get(EV_KEY, []):
                    return device
                device.close()
        except OSError as error:
            raise DeviceLostError(f"cannot open the gamepad: {error}") from error
        raise DeviceLostError(
            "no gamepad was found among /dev/input/event*; plug one in, or add yourself to the "
            "group 'input'"
        )

    def _events(self) -> list[int]:
        """Takes what has happened; returns the buttons that were pressed, in order."""
        pressed: list[int] = []
        while True:
            try:
                event = self._device.read_one()
            except OSError as error:
                raise DeviceLostError(f"the gamepad is gone: {error.strerror}") from error
            if event is None:
                return pressed
            if event.type == EV_SYN:
                self._synchronise(event.code)
            elif self._has_lost_events:
                continue  # these events are of a state that is not known
            elif event.type == EV_ABS:
                self._axes[event.code] = self._normal(event.code, float(event.value))
            elif event.type == EV_KEY and event.value == 1:
                pressed.append(event.code)
                self._held.add(event.code)
            elif event.type == EV_KEY and event.value == 0:
                self._held.discard(event.code)

    def _synchronise(self, code: int) -> None:
        """Asks for the present state after the system's queue was full and events were lost."""
        if code == SYN_DROPPED:
            self._has_lost_events = True
        if code != SYN_REPORT or not self._has_lost_events:
            return
        self._has_lost_events = False
        try:
            for axis in self._ranges:
                self._axes[axis] = self._normal(axis, float(self._device.absinfo(axis).value))
            self._held = set(self._device.active_keys())
        except OSError as error:
            raise DeviceLostError(f"the gamepad is gone: {error.strerror}") from error

    def _normal(self, code: int, value: float) -> float:
        """Returns a value from -1 to 1."""
        low, high = self._ranges.get(code, (-1.0, 1.0))
        if high <= low:
            return 0.0
        return min(max(2 * (value - low) / (high - low) - 1, -1.0), 1.0)

    def _stick(self, code: int) -> float:
        value = self._axes.get(code, 0.0) - self._rest.get(code, 0.0)
        beyond = max(abs(value) - DEAD_ZONE, 0.0) / (1 - DEAD_ZONE)
        return min(beyond, 1.0) * (1 if value > 0 else -1)

    def _trigger(self, code: int) -> float:
        """Returns 0 for a trigger that is not pulled, up to 1."""
        if code not in self._ranges:
            return 0.0
        return max((self._axes.get(code, -1.0) + 1) / 2 - DEAD_ZONE, 0.0) / (1 - DEAD_ZONE)
