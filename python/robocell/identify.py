"""System identification: fits an arm's model to a recorded motion.

    trajectory = robocell.identify.ArmTrajectory.load("wave.npz")
    found = robocell.identify.identify(robot, trajectory)
    found.value("damping", "joint1")

It needs scipy, of the extra `identify`. docs/identify.md describes it.
"""

from robocell._identify.fitting import PARAMETERS, Identified, Parameter, identify
from robocell._identify.trajectory import ArmTrajectory, excitation

__all__ = [
    "PARAMETERS",
    "ArmTrajectory",
    "Identified",
    "Parameter",
    "excitation",
    "identify",
]
