"""Poses, chains, Jacobians and inverse kinematics.

    chain = robot.chain  # a robocell.kinematics.Chain
    tip = chain.fk(robot.jnt_pos_msr)  # a robocell.Pose in its base frame
    result = robot.ik(robocell.Pose(translation=[0.3, 0, 0.3], quaternion=[1, 0, 0, 0]))

docs/kinematics.md describes them.
"""

from robocell._core import (
    Chain,
    CollisionFilter,
    IkResult,
    IkSolver,
    JacobianKind,
    Kinematics,
    Pose,
    jnt_array,
)

__all__ = [
    "Chain",
    "CollisionFilter",
    "IkResult",
    "IkSolver",
    "JacobianKind",
    "Kinematics",
    "Pose",
    "jnt_array",
]
