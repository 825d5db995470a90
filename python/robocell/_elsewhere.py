"""Where a name is that is not at the top of robocell: the message of its AttributeError."""

from __future__ import annotations

import difflib
import functools
import importlib.util
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import NoReturn

# In the order in which they are named to a reader.
TOPICS = (
    "robots",
    "scene",
    "kinematics",
    "control",
    "render",
    "envs",
    "scenes",
    "tasks",
    "features",
    "generate",
    "data",
    "diagnose",
    "log",
    "models",
    "menagerie",
)

# Classes of modules that are imported by name, since they need packages of an extra.
OF_EXTRAS = {
    "GymEnv": "robocell.gym",
    "LeRobotEnv": "robocell.lerobot",
    "Policy": "robocell.policy",
    "VecEnv": "robocell.sb3",
}
# Modules beside the topics: programs import them by name.
BESIDE = {"compat", "evaluate", "gym", "lerobot", "policy", "sb3"}


def not_at_the_top(name: str) -> str:
    """What `robocell.<name>` says when there is no such name: where it lives, or what is near."""
    start = f"module 'robocell' has no attribute '{name}'"
    homes = _homes()
    if name in homes:
        return f"{start}. It is in a topic: {homes[name]}"
    if name in OF_EXTRAS:
        return f"{start}. It is in a module to import: {OF_EXTRAS[name]}.{name}"
    if not name.startswith("_") and importlib.util.find_spec(f"robocell.{name}"):
        return f"{start}. It is a module to import: import robocell.{name}"
    if near := _nearest(name, list(homes)):
        return f"{start}. Did you mean {homes[near]}?"
    return f"{start}. Its topics: {', '.join(TOPICS)}"


def not_in(module: str, name: str, names: Sequence[str]) -> str:
    """What a topic says when it has no such name: what is near in it, or where the name lives."""
    start = f"module '{module}' has no attribute '{name}'"
    near = _nearest(name, names)
    if near:
        return f"{start}. Did you mean {near}?"
    homes = _homes()
    return f"{start}. It is {homes[name]}" if name in homes else start


def add_hints() -> None:
    """Lets each topic without a `__getattr__` of its own say `not_in` of names that it lacks.

    `dir()` of topics and of robocell lists what is public, not what they import. Set from outside,
    so that type checkers still report such names.
    """
    for topic in TOPICS:
        module = sys.modules[f"robocell.{topic}"]
        if "__getattr__" not in vars(module):
            vars(module)["__getattr__"] = functools.partial(_refuse, module)
    for name in ("robocell", *(f"robocell.{topic}" for topic in TOPICS)):
        vars(sys.modules[name])["__dir__"] = functools.partial(_public_names, sys.modules[name])


def no_such(message: str, name: str) -> AttributeError:
    """The error of a name that is not there; Python adds no suggestion of its own to the text."""
    return AttributeError(message, name=name, obj=None)


def _public_names(module: ModuleType) -> list[str]:
    """Returns the names of `__all__`, of robocell those of modules that were imported, too."""
    imported = BESIDE & set(vars(module)) if module.__name__ == "robocell" else set()
    return sorted({*module.__all__, *imported})


def _refuse(module: ModuleType, name: str) -> NoReturn:
    raise no_such(not_in(module.__name__, name, module.__all__), name)


def _nearest(name: str, names: Sequence[str]) -> str:
    near = difflib.get_close_matches(name.lower(), [each.lower() for each in names], 1, 0.75)
    same = [each for each in names if near and each.lower() == near[0]]  # scene and Scene
    return max(same, key=lambda each: _likeness(name, each)) if same else ""


def _likeness(one: str, other: str) -> float:
    return difflib.SequenceMatcher(None, one, other).ratio()


def _homes() -> dict[str, str]:
    """Each public name and where it lives, the top first."""
    homes: dict[str, str] = {}
    for module in ("robocell", *(f"robocell.{topic}" for topic in TOPICS)):
        for name in getattr(sys.modules.get(module), "__all__", ()):
            homes.setdefault(name, f"{module}.{name}")
    return homes
