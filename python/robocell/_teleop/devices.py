"""Makes devices by the names that `robocell teleop --device` takes."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, SpecError
from robocell._suggestions import did_you_mean
from robocell._teleop.device import Device

NAMES = {
    "web": "the page: keys, mouse, touch, a phone",
    "keyboard": "the keys of this terminal",
    "gamepad": "a gamepad, or gamepad:/dev/input/eventN",
    "spacemouse": "a SpaceMouse",
    "leader:FILE.yaml": "a leader arm, described by a file",
    "lerobot:Class": "a LeRobot Teleoperator, such as SO101Leader, with --device-config FILE.yaml",
    "replay:FILE": "a recorded session, of a dataset's device_sessions/",
    "module:Class": "your own robocell.teleop.Device",
}


def make_device(name: str, config: Path | None = None) -> Device:
    """Returns a device.

    Args:
        name: One of `NAMES`.
        config: A YAML file with its options, for `lerobot:` and devices of one's own.

    Raises:
        ArgumentError: There is no such device.
        SpecError: Its module or file cannot be used.
        ModuleNotFoundError: A package of the extra `teleop` is missing.
    """
    kind, _, rest = name.partition(":")
    if name == "web":
        from robocell._web.teleop_page import PageDevice

        return PageDevice()
    if name == "keyboard":
        from robocell._teleop.keyboard import Keyboard

        return Keyboard()
    if kind == "gamepad":
        from robocell._teleop.gamepad import Gamepad

        return Gamepad(rest)
    if name == "spacemouse":
        from robocell._teleop.spacemouse import SpaceMouse

        return SpaceMouse()
    if kind == "replay" and rest:
        from robocell._teleop.recorded import RecordedDevice

        return RecordedDevice(Path(rest))
    if kind in ("leader", "lerobot") and rest:
        from robocell._teleop.leader import Leader

        if kind == "leader":
            return Leader.of_file(Path(rest))
        return Leader.of_lerobot(rest, config)
    if rest:
        return _own(name, config)
    names = "".join(f"\n  {each}: {what}" for each, what in NAMES.items())
    known = [each.partition(":")[0] for each in NAMES]
    raise ArgumentError(f"no device '{name}'.{did_you_mean(name, known)} There are:{names}")


def by_arm(given: Sequence[str], what: str) -> dict[str, str]:
    """Returns what is given for each arm: ["left=gamepad"] is {"left": "gamepad"}.

    One without a name is for the chosen arm, "". Raises ArgumentError for two of one arm.
    """
    found: dict[str, str] = {}
    for each in given:
        head, mark, rest = each.partition("=")
        arm, name = (head, rest) if mark and ":" not in head else ("", each)
        if arm in found or (found and "" in (arm, *found)):
            raise ArgumentError(
                f"{what} is given {len(given)} times: name the arm of each, as in {what} "
                f"left={name} {what} right=..."
            )
        found[arm] = name
    return found


def _own(name: str, config: Path | None) -> Device:
    """Returns a device of the user's own class."""
    from robocell._generation.run_source import import_module

    module_name, _, attribute = name.rpartition(":")
    module = import_module(module_name, Path.cwd())
    maker = getattr(module, attribute, None)
    if not callable(maker):
        named = [
            key
            for key, value in vars(module).items()
            if inspect.isclass(value) and issubclass(value, Device) and value is not Device
        ]
        raise SpecError(
            f"device '{name}': module '{module_name}' has no class '{attribute}'."
            f"{did_you_mean(attribute, named)} Its devices: {', '.join(named) or 'none'}"
        )
    made = maker(**options_of(config))
    if not isinstance(made, Device):
        raise SpecError(
            f"device '{name}': {attribute} is a {type(made).__name__}; a device is a "
            "robocell.teleop.Device"
        )
    return made


def options_of(config: Path | None) -> dict[str, Any]:
    """Returns the content of a YAML file of options; {} without one. Raises SpecError."""
    if config is None:
        return {}
    import yaml

    try:
        content = yaml.safe_load(config.read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise SpecError(f"'{config}' cannot be read: {error}") from error
    if not isinstance(content, dict) or not all(isinstance(key, str) for key in content):
        raise SpecError(f"'{config}' must be a map of options")
    return content
