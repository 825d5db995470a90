"""Names of parts of states and actions for GR00T: what exports write and servers are asked with."""

from __future__ import annotations


def short_name(column: str, several_robots: bool) -> str:
    """Returns "arm" for robots/rc7/arm/qpos and robots/rc7/action/arm, "gripper" for an opening."""
    parts = column.split("/")
    name = parts[-1]
    if name == "opening":
        name = "gripper"
    elif name == "qpos" and len(parts) > 2:
        name = parts[-2]
    return f"{parts[1]}_{name}" if several_robots and parts[0] == "robots" else name
