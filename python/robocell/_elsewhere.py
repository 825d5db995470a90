"""The AttributeError for names that are not at the top of robocell: it names their module."""

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
    "motion",
    "hardware",
    "render",
    "viewer",
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

# Topics that robocell imports when they are first used.
ON_FIRST_USE = ("policy", "evaluate")

# Classes of modules that are imported by name, since they need packages of an extra.
OF_EXTRAS = {
    "GymEnv": "robocell.gym",
    "LeRobotEnv": "robocell.lerobot",
    "VecEnv": "robocell.sb3",
}
# Modules beside the topics: programs import them by name.
BESIDE = {
    "benchmark",
    "compat",
    "export",
    "gym",
    "identify",
    "importer",
    "lerobot",
    "sb3",
    "teleop",
}


def not_at_the_top(name: str) -> str:
    """Returns the error text for `robocell.<name>`: the module of the name, or the nearest name."""
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
    return f"{start}. Its topics: {', '.join((*TOPICS, *ON_FIRST_USE))}"


def not_in(module: str, name: str, names: Sequence[str]) -> str:
    """Returns the error text for a name that a topic lacks: the nearest name, or its module."""
    start = f"module '{module}' has no attribute '{name}'"
    near = _nearest(name, names)
    if near:
        return f"{start}. Did you mean {near}?"
    homes = _homes()
    return f"{start}. It is {homes[name]}" if name in homes else start


def add_hints() -> None:
    """Adds `__getattr__` to each topic that has none, so that unknown names raise `not_in`.

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
    """Returns an AttributeError without Python's own suggestion."""
    return AttributeError(message, name=name, obj=None)


def _public_names(module: ModuleType) -> list[str]:
    """Returns the names of `__all__`, of robocell those of modules that were imported, too."""
    names = set(module.__all__)
    if module.__name__ == "robocell":
        names |= {*ON_FIRST_USE, *(BESIDE & set(vars(module)))}
    return sorted(names)


def _refuse(module: ModuleType, name: str) -> NoReturn:
    raise no_such(not_in(module.__name__, name, module.__all__), name)


def _nearest(name: str, names: Sequence[str]) -> str:
    near = difflib.get_close_matches(name.lower(), [each.lower() for each in names], 1, 0.75)
    same = [each for each in names if near and each.lower() == near[0]]  # scene and Scene
    return max(same, key=lambda each: _likeness(name, each)) if same else ""


def _likeness(one: str, other: str) -> float:
    return difflib.SequenceMatcher(None, one, other).ratio()


def _homes() -> dict[str, str]:
    """Returns {public name: its module}, the top first."""
    homes: dict[str, str] = {}
    for module in ("robocell", *(f"robocell.{topic}" for topic in TOPICS)):
        for name in getattr(sys.modules.get(module), "__all__", ()):
            homes.setdefault(name, f"{module}.{name}")
    homes |= {topic: f"robocell.{topic}" for topic in ON_FIRST_USE}
    return homes | {"Policy": "robocell.policy.Policy"}
