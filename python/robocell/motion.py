"""Collision-free motions of robots, and their timing.

    result = robot.plan([grasp, other_grasp], clearance=0.005)
    motion = robocell.motion.time_path(result.path, velocity=1.5)

docs/motion.md describes them.
"""

from robocell._core import (
    AxisConstraint,
    MotionGoal,
    MotionPlanner,
    MotionResult,
    Trajectory,
    time_path,
    why_too_slow,
)

__all__ = [
    "AxisConstraint",
    "MotionGoal",
    "MotionPlanner",
    "MotionResult",
    "Trajectory",
    "time_path",
    "why_too_slow",
]
