"""Where a name is that is not at the top of robocell: the message of its AttributeError."""

from __future__ import annotations

import difflib
import importlib.util
import sys

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
    names = [each.lower() for each in homes]
    near = difflib.get_close_matches(name.lower(), names, n=1, cutoff=0.75)
    if near:
        found = next(full for each, full in homes.items() if each.lower() == near[0])
        return f"{start}. Did you mean {found}?"
    return f"{start}. Its topics: {', '.join(TOPICS)}"


def _homes() -> dict[str, str]:
    """Each public name and where it lives, the top first."""
    homes: dict[str, str] = {}
    for module in ("robocell", *(f"robocell.{topic}" for topic in TOPICS)):
        for name in getattr(sys.modules.get(module), "__all__", ()):
            homes.setdefault(name, f"{module}.{name}")
    return homes
