"""Teleoperation: a person moves an arm, and its episodes are recorded.

    robocell teleop examples/demo.yaml --device web

Devices implement `Device`; docs/teleop.md describes them, the commands and the safety stops.

Example of a device of one's own, for `--device my_device.py:Wave`:
    >>> import robocell.teleop
    >>> class Wave(robocell.teleop.Device):
    ...     def read(self, seconds):
    ...         return robocell.teleop.Motion(translation=(0, 0.1 * seconds, 0))
"""

from __future__ import annotations

from robocell._teleop.cell_session import cell_of, record_cell
from robocell._teleop.device import COMMANDS, Device, DeviceLostError, Motion
from robocell._teleop.devices import make_device
from robocell._teleop.follower import FollowOptions
from robocell._teleop.operator import OperatorOptions
from robocell._teleop.real_arms import ArmStoppedError, RealArms
from robocell._teleop.session import Recorded, record
from robocell._teleop.several import DeviceForEach

__all__ = [
    "COMMANDS",
    "ArmStoppedError",
    "Device",
    "DeviceForEach",
    "DeviceLostError",
    "FollowOptions",
    "Motion",
    "OperatorOptions",
    "RealArms",
    "Recorded",
    "cell_of",
    "make_device",
    "record",
    "record_cell",
]
