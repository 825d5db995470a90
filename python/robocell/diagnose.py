"""Checks of robots, runs, machines and engines, trials of robots, and advice.

    robocell.diagnose.validate_robot(robot)  # raises all problems of its configuration
    for finding in robocell.diagnose.check_robot(robot):  # moves its arms in a trial
        print(finding)
    robocell.diagnose.check_run(run)  # raises its problems, returns warnings
    robocell.diagnose.describe_gl()  # the renderer of this machine

`robocell check`, `robocell generate` and `robocell doctor` print the same.
"""

from robocell._core import (
    EngineDefect,
    Finding,
    Severity,
    check_robot,
    check_run,
    describe_gl,
    graphics_advice,
    known_engine_defects,
    mujoco_version,
    validate_robot,
    why_not,
)

__all__ = [
    "EngineDefect",
    "Finding",
    "Severity",
    "check_robot",
    "check_run",
    "describe_gl",
    "graphics_advice",
    "known_engine_defects",
    "mujoco_version",
    "validate_robot",
    "why_not",
]
