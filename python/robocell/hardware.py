"""Real arms below `Robot`: the same programs, environments and recorders drive them.

    with robocell.hardware.connect(robot, "real", "udp:127.0.0.1:7071") as arm:
        while arm.ok:
            robot.jnt_pos_cmd[0] += 0.001
            robot.update()
            robot.step()  # sends the command within the limits, mirrors the measured joints

docs/hardware.md describes the drivers and what guards an arm.
"""

from robocell._core import (
    ArmCommand,
    ArmLimits,
    ArmLink,
    ArmMeasurement,
    ArmPort,
    LinkFaults,
    SafetyCounts,
    SafetyOptions,
    SimulatedArm,
    UdpArm,
    UdpArmServer,
)
from robocell._hardware.connecting import Connected, connect, make_arm, serving

__all__ = [
    "ArmCommand",
    "ArmLimits",
    "ArmLink",
    "ArmMeasurement",
    "ArmPort",
    "Connected",
    "LinkFaults",
    "SafetyCounts",
    "SafetyOptions",
    "SimulatedArm",
    "UdpArm",
    "UdpArmServer",
    "connect",
    "make_arm",
    "serving",
]
