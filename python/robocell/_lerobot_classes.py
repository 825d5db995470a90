"""Makes devices of LeRobot, and others with its interfaces, from the names of their classes."""

from __future__ import annotations

import importlib
import inspect
import re
import typing
from collections.abc import Mapping
from typing import Any

from robocell._core import SpecError
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import place_of

UNITS = "use_degrees"  # an option of LeRobot's arms; by default they report -100 to 100


def _parameters(kind: Any) -> Mapping[str, Any]:
    return inspect.signature(kind).parameters


def _with_degrees(name: str, config: Any, options: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns the options with which the joints of a LeRobot arm are degrees. Raises SpecError."""
    if UNITS in _parameters(config):
        if options.get(UNITS, True) is True:
            return {**options, UNITS: True}
        why = f"its option `{UNITS}` is {options[UNITS]!r}"
    else:
        why = f"it has no option `{UNITS}`"
    raise SpecError(
        f"'{name}' does not report degrees: {why}. Set `{UNITS}: true` if it has it, or map its "
        "numbers in a file with `joints:` (leader:FILE.yaml, or file:FILE.yaml for an arm), whose "
        "scale and offset you choose"
    )


def full_name(name: str, package: str, method: str, what: str) -> str:
    """Returns module:Class of a class that comes with LeRobot. Raises SpecError.

    Args:
        name: LeRobot's own name of the class or of its folder, such as SO101Leader or so101_leader;
            or module:Class.
        package: Where it is, such as lerobot.teleoperators.
        method: A method that such classes have.
        what: Begins the messages.
    """
    if ":" in name:
        return name
    folder = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
    module_name = f"{package}.{folder}"
    try:
        module = importlib.import_module(module_name)
    except ImportError as error:
        raise SpecError(
            f"{what} 'lerobot:{name}': cannot import '{module_name}': {error}. Give "
            "lerobot:module:Class for a class elsewhere"
        ) from error
    found = [
        key
        for key, value in vars(module).items()
        if inspect.isclass(value) and hasattr(value, method) and hasattr(value, "config_class")
    ]
    chosen = [key for key in found if key in (name, module.__name__)] or found
    if len(chosen) != 1:
        raise SpecError(
            f"{what} 'lerobot:{name}': '{module_name}' has the classes "
            f"{', '.join(found) or 'none'}; give lerobot:{module_name}:CLASS"
        )
    return f"{module_name}:{chosen[0]}"


def made_by_name(name: str, options: Mapping[str, Any], in_degrees: bool) -> Any:
    """Returns an object of a class by name; a LeRobot class is made from its configuration.

    Args:
        name: The class, as module:Class.
        options: Its options.
        in_degrees: Let a LeRobot arm report degrees, not -100 to 100 of each joint's range.
    """
    module_name, colon, attribute = name.rpartition(":")
    if not colon:
        raise SpecError(f"'{name}' names no class: give module:Class")
    try:
        module = importlib.import_module(module_name)
    except ImportError as error:
        raise SpecError(f"'{name}': cannot import '{module_name}': {error}") from error
    kind: Any = getattr(module, attribute, None)
    if not inspect.isclass(kind):
        raise SpecError(f"'{name}': module '{module_name}' has no class '{attribute}'")
    try:
        config: Any = getattr(kind, "config_class", None)
        if config is None:
            config = typing.get_type_hints(kind.__init__).get("config")
        make: Any = kind
        if not inspect.isclass(config):
            return make(**options)
        if in_degrees and (hasattr(kind, "config_class") or UNITS in _parameters(config)):
            options = _with_degrees(name, config, options)
        return make(config(**options))
    except SpecError:
        raise
    except RAISED as error:
        raise_interrupt(error)
        raise SpecError(f"'{name}' cannot be made: {place_of(error)}") from error
