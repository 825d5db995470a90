"""What robocell says about robots, machines and engines: checks, trials and advice.

    robocell.diagnose.check_config(robot)  # raises what is wrong with its configuration
    robocell.diagnose.try_robot(robot)  # what its arms do when they are moved a little
    robocell.diagnose.describe_gl()  # what draws pictures on this machine

`robocell check` and `robocell doctor` print the same.
"""

from robocell._core import (
    EngineDefect,
    check_config,
    describe_gl,
    graphics_advice,
    known_engine_defects,
    mujoco_version,
    try_robot,
    why_no_picks,
)

__all__ = [
    "EngineDefect",
    "check_config",
    "describe_gl",
    "graphics_advice",
    "known_engine_defects",
    "mujoco_version",
    "try_robot",
    "why_no_picks",
]
