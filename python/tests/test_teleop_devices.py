"""Drivers of devices, on fakes of the hardware: what they say, and how they fail."""

from __future__ import annotations

import os
import pty
import struct
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robocell as rc
from robocell._teleop import gamepad as pad
from robocell._teleop.gamepad import Gamepad
from robocell._teleop.keyboard import STEP_M, Keyboard
from robocell._teleop.leader import Leader
from robocell._teleop.spacemouse import SpaceMouse
from robocell.teleop import Device, DeviceLostError, make_device


class FakePad:
    """An evdev device: sticks from 0 to 255, triggers from 0 to 1023."""

    def __init__(self) -> None:
        self.events: list[Any] = []
        self.gone = False
        self.absinfo: Any = None
        self.active_keys: Any = None

    def capabilities(self) -> dict[int, list[Any]]:
        sticks = [(code, SimpleNamespace(min=0, max=255, value=128)) for code in (0, 1, 3, 4)]
        triggers = [(code, SimpleNamespace(min=0, max=1023, value=0)) for code in (2, 5)]
        return {pad.EV_ABS: [*sticks, *triggers], pad.EV_KEY: [pad.SOUTH]}

    def read_one(self) -> Any:
        if self.gone:
            raise OSError(19, "No such device")
        return self.events.pop(0) if self.events else None

    def send(self, kind: int, code: int, value: int) -> None:
        self.events.append(SimpleNamespace(type=kind, code=code, value=value))

    def close(self) -> None:
        self.gone = True


def test_a_gamepad_moves_opens_and_commands():
    fake = FakePad()
    device = Gamepad(opened=fake)
    device.start()
    rest = device.read(0.1)
    assert rest is not None
    np.testing.assert_array_equal([*rest.translation, *rest.rotation], 0)
    fake.send(pad.EV_ABS, pad.ABS_Y, 0)  # away
    fake.send(pad.EV_ABS, pad.ABS_RZ, 1023)
    fake.send(pad.EV_KEY, pad.SOUTH, 1)
    fake.send(pad.EV_KEY, pad.START, 1)
    moved = device.read(0.1)
    assert moved is not None
    np.testing.assert_allclose(moved.translation, [0.02, 0, 0.02], atol=1e-9)
    assert moved.opening == 0
    assert moved.commands == ("record", "keep")
    assert moved.clutch
    fake.send(pad.EV_KEY, pad.RIGHT, 1)
    held = device.read(0.1)
    assert held is not None
    assert not held.clutch
    assert held.opening is None
    fake.gone = True
    with pytest.raises(DeviceLostError, match="gone"):
        device.read(0.1)


def test_a_gamepad_forgets_nothing_after_lost_events():
    """The system drops events of a full queue; the sticks are then where they are now."""
    fake = FakePad()
    device = Gamepad(opened=fake)
    device.start()
    fake.absinfo = lambda code: SimpleNamespace(value=128 if code in (0, 1, 3, 4) else 0)
    fake.active_keys = lambda: [pad.RIGHT]
    fake.send(pad.EV_ABS, pad.ABS_Y, 0)
    moved = device.read(0.1)
    assert moved is not None
    assert moved.translation[0] > 0
    fake.send(pad.EV_SYN, pad.SYN_DROPPED, 0)
    fake.send(pad.EV_ABS, pad.ABS_X, 255)
    fake.send(pad.EV_SYN, pad.SYN_REPORT, 0)
    moved = device.read(0.1)
    assert moved is not None
    np.testing.assert_allclose(moved.translation, 0, atol=1e-6)
    assert not moved.clutch
    fake.send(pad.EV_KEY, pad.SOUTH, 1)
    fake.send(pad.EV_KEY, pad.EAST, 1)
    moved = device.read(0.1)
    assert moved is not None
    assert moved.opening == 1, "the last button counts"


class FakeMouse:
    """A hid device with reports."""

    def __init__(self, reports: Sequence[bytes]) -> None:
        self.reports, self.gone = list(reports), False

    def read(self, _size: int) -> list[int]:
        if self.gone:
            raise OSError("read error")
        return list(self.reports.pop(0)) if self.reports else []

    def close(self) -> None:
        self.gone = True


def test_a_spacemouse_moves_and_a_lost_report_stops_it(monkeypatch: pytest.MonkeyPatch):
    now = [0.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    push = b"\x01" + struct.pack("<3h", 0, -350, -350)
    turn = b"\x02" + struct.pack("<3h", 0, 0, 350)
    fake = FakeMouse([push, turn, b"\x03\x01\x00", b"\x01\x00", b"\x7f", b"\x03\x02"])
    device = SpaceMouse(opened=fake)
    device.start()
    moved = device.read(0.1)
    assert moved is not None
    np.testing.assert_allclose(moved.translation, [0.025, 0, 0.025], atol=1e-9)
    np.testing.assert_allclose(moved.rotation, [0, 0, -0.12], atol=1e-9)
    assert moved.opening == 0
    assert "record" in moved.commands
    now[0] += 1
    silent = device.read(0.1)
    assert silent is not None
    np.testing.assert_array_equal([*silent.translation, *silent.rotation], 0)
    fake.gone = True
    with pytest.raises(DeviceLostError):
        device.read(0.1)


def test_a_terminal_is_a_device_and_is_left_as_it_was():
    ours, theirs = pty.openpty()
    device = Keyboard(theirs)
    device.start()
    assert device.read(0.1) is not None
    os.write(ours, b"wwA ?\n")
    moved = device.read(0.1)
    assert moved is not None
    np.testing.assert_allclose(moved.translation, [2 * STEP_M, STEP_M, 0])
    assert moved.opening == 0
    assert moved.commands == ("record", "keep")
    device.close()
    device.close()
    os.close(ours)
    os.close(theirs)
    with open(os.devnull) as null, pytest.raises(DeviceLostError, match="--device web"):
        Keyboard(null.fileno()).start()


def test_the_keyboard_closes_the_hand_of_the_next_arm_first():
    ours, theirs = pty.openpty()
    device = Keyboard(theirs)
    device.start()
    os.write(ours, b" t")
    first = device.read(0.1)
    assert first is not None
    assert (first.opening, first.commands) == (0, ("next_arm",))
    os.write(ours, b" ")
    second = device.read(0.1)
    assert second is not None
    assert second.opening == 0
    os.close(ours)
    with pytest.raises(DeviceLostError, match="the terminal is gone"):
        device.read(0.1)
    device.close()
    os.close(theirs)


def test_a_leader_that_is_unplugged_is_lost():
    arm = Arm()
    device = Leader(arm)
    device.start()
    arm.get_action = lambda: (_ for _ in ()).throw(OSError("no such device"))  # type: ignore[method-assign]
    with pytest.raises(DeviceLostError, match=r"Arm\.get_action\(\).*no such device"):
        device.read(0.1)
    device.close()


class Arm:
    """A leader with LeRobot's interface."""

    def __init__(self, port: str = "", numbers: dict[str, Any] | None = None) -> None:
        self.port, self.connected = port, False
        rest = {"a.pos": 90.0, "b.pos": -45.0, "gripper.pos": 25.0}
        self.numbers = rest if numbers is None else numbers

    def connect(self) -> None:
        if self.port == "none":
            raise ConnectionError("no such port")
        self.connected = True

    def get_action(self) -> dict[str, Any]:
        return self.numbers

    def disconnect(self) -> None:
        self.connected = False


class Wave(Device):
    def __init__(self, speed: float = 1.0) -> None:
        self.speed = speed


def test_a_leader_is_mapped_to_the_joints_of_the_robot(tmp_path: Path):
    device = Leader(arm := Arm())
    device.start()
    moved = device.read(0.1)
    assert moved is not None
    assert moved.joints == pytest.approx({"0": np.pi / 2, "1": -np.pi / 4})
    assert moved.opening == 0.25
    device.close()
    assert not arm.connected
    file = tmp_path / "leader.yaml"
    file.write_text(
        "class: test_teleop_devices:Arm\n"
        "joints: {a.pos: {joint: joint3, scale: 0.01, offset: 0.1}}\n"
        "gripper: {from: gripper.pos, closed: 50, open: 0}\n"
    )
    device = make_device(f"leader:{file}")
    device.start()
    moved = device.read(0.1)
    assert moved is not None
    assert moved.joints == pytest.approx({"joint3": 1.0})
    assert moved.opening == 0.5
    (tmp_path / "options.yaml").write_text("port: none")
    lost = make_device("lerobot:test_teleop_devices:Arm", tmp_path / "options.yaml")
    with pytest.raises(DeviceLostError, match="no such port"):
        lost.start()


@pytest.mark.parametrize(
    "numbers", [{"a.pos": "x"}, {"a.pos": None}, {"c": 1.0}, [], {"a.pos": float("nan")}]
)
def test_a_leader_that_says_nonsense_moves_nothing(numbers: Any):
    device = Leader(Arm(numbers=numbers), {"a.pos": SimpleNamespace(joint="j", scale=1, offset=0)})
    device.start()
    if numbers == {"a.pos": pytest.approx(float("nan"), nan_ok=True)}:
        assert device.read(0.1) is None
    else:
        with pytest.raises(DeviceLostError):
            device.read(0.1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[]", "a map of options"),
        ("class: 3", "module:Class"),
        ("class: x:Y\nspeed: 1", "no field 'speed'"),
        ("class: test_teleop_devices:Arm\njoints: {a: 3}", "a joint is"),
        ("class: test_teleop_devices:Arm\ngripper: {from: a, open: 1, closed: 1}", "are the same"),
        ("class: test_teleop_devices:Leg", "no class 'Leg'"),
        ("class: no_such_module:Leg", "cannot import"),
        ("class: Arm", "module:Class"),
    ],
)
def test_files_of_leaders_are_explained(text: str, message: str, tmp_path: Path):
    file = tmp_path / "leader.yaml"
    file.write_text(text)
    with pytest.raises(rc.SpecError, match=message):
        make_device(f"leader:{file}")


class FakeConfig:
    def __init__(self, port: str, use_degrees: bool = False) -> None:
        self.port, self.use_degrees = port, use_degrees


class FakeLeader(Arm):
    """Reports -100 to 100 unless it is asked for degrees, as LeRobot's arms do."""

    config_class = FakeConfig

    def __init__(self, config: FakeConfig) -> None:
        super().__init__(config.port)
        if not config.use_degrees:
            self.numbers = {"a.pos": 100.0, "b.pos": -100.0, "gripper.pos": 25.0}


class OldConfig:
    def __init__(self, port: str) -> None:
        self.port = port


class OldLeader(FakeLeader):
    config_class = OldConfig  # type: ignore[assignment]

    def __init__(self, config: OldConfig) -> None:
        super().__init__(FakeConfig(config.port))


def test_a_leader_of_lerobot_has_its_own_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    module = ModuleType("lerobot.teleoperators.so101_leader")
    module.SO101Leader, module.Config = FakeLeader, FakeConfig  # type: ignore[attr-defined]
    for name in ("lerobot", "lerobot.teleoperators"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    monkeypatch.setitem(sys.modules, module.__name__, module)
    (tmp_path / "options.yaml").write_text("port: /dev/ttyACM0")
    for name in ("SO101Leader", "so101_leader"):
        device = make_device(f"lerobot:{name}", tmp_path / "options.yaml")
        device.start()
        moved = device.read(0.1)
        assert moved is not None
        assert moved.joints == pytest.approx({"0": np.pi / 2, "1": -np.pi / 4})
    with pytest.raises(rc.SpecError, match="lerobot:module:Class"):
        make_device("lerobot:Koch")
    with pytest.raises(rc.SpecError, match="cannot be made"):
        make_device("lerobot:SO101Leader")


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("FakeLeader", "{port: x, use_degrees: false}", "`use_degrees` is False"),
        ("OldLeader", "{port: x}", "no option `use_degrees`"),
    ],
)
def test_a_leader_that_reports_no_degrees_needs_a_map(
    kind: str, options: str, message: str, tmp_path: Path
):
    file = tmp_path / "leader.yaml"
    file.write_text(f"class: test_teleop_devices:{kind}\noptions: {options}\n")
    with pytest.raises(rc.SpecError, match=rf"{message}.*leader:FILE.yaml"):
        make_device(f"leader:{file}")
    (tmp_path / "options.yaml").write_text(options)
    with pytest.raises(rc.SpecError, match=message):
        make_device(f"lerobot:test_teleop_devices:{kind}", tmp_path / "options.yaml")
    with file.open("a") as more:
        more.write("joints: {a.pos: {joint: joint1, scale: 0.02}}\n")
    device = make_device(f"leader:{file}")
    device.start()
    moved = device.read(0.1)
    assert moved is not None
    assert moved.joints == pytest.approx({"joint1": 2.0})


def test_a_device_of_ones_own(tmp_path: Path):
    (tmp_path / "options.yaml").write_text("speed: 2.5")
    made = make_device("test_teleop_devices:Wave", tmp_path / "options.yaml")
    assert isinstance(made, Device)
    assert made.speed == 2.5  # type: ignore[attr-defined]
    with pytest.raises(rc.SpecError, match="Wave"):
        make_device("test_teleop_devices:Wav")
    with pytest.raises(rc.SpecError, match="a device is a"):
        make_device("test_teleop_devices:Arm")


@pytest.mark.parametrize(("name", "module"), [("gamepad", "evdev"), ("spacemouse", "hid")])
def test_a_missing_driver_is_named(name: str, module: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(ModuleNotFoundError, match="pip install"):
        make_device(name).start()
