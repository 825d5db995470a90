"""Determines an arm's actuators and whether robocell can command them."""

from __future__ import annotations

from dataclasses import dataclass

from robocell._onboarding.actuation import Actuation, Drive
from robocell._onboarding.guess import shortened
from robocell._onboarding.source_model import SourceModel

# The order in which robocell itself looks for the actuators of an arm.
DRIVES = (Drive.POSITION, Drive.VELOCITY, Drive.MOTOR)
CONTROL = {
    Drive.POSITION: "joint_position",
    Drive.VELOCITY: "joint_impedance",
    Drive.MOTOR: "joint_impedance",
}


@dataclass
class ArmDrive:
    """The actuators of an arm, one per joint.

    Attributes:
        actuators: Their names; empty where there are none.
        drive: Their kind.
        unused: Other actuators on the same joints.
        why_not: Why the arm cannot be commanded; "" when it can.
    """

    actuators: list[str]
    drive: Drive | None
    unused: list[str]
    why_not: str = ""

    @property
    def control(self) -> str:
        """The controller of the robot file."""
        return CONTROL[self.drive] if self.drive else "joint_position"


def drive_of(source: SourceModel, actuation: Actuation, joints: list[int]) -> ArmDrive:
    """Returns the actuators of an arm."""
    follows = [joint for joint in joints if _leader_in(actuation, joint, joints) is not None]
    pulling = [a for joint in joints for a in actuation.of_joint(joint)]
    if follows:
        pairs = [
            f"'{source.joint_name(joint)}' follows "
            f"'{source.joint_name(_leader_in(actuation, joint, joints) or 0)}'"
            for joint in follows
        ]
        return ArmDrive(
            [], None, [], f"joints are coupled by equalities, which an arm cannot have yet: "
            f"{shortened(pairs)}",
        )  # fmt: skip
    best: list[str] = []
    kind: Drive | None = None
    for drive in DRIVES:
        found = [
            next((a.name for a in actuation.on_joint(joint) if a.drive is drive), "")
            for joint in joints
        ]
        if all(found):
            best, kind = found, drive
            break
    unused = list(dict.fromkeys(a.name for a in pulling if a.name not in best))
    if best:
        return ArmDrive(best, kind, unused)
    if not pulling:
        return ArmDrive([], None, [], "no actuator moves its joints")
    bare = [source.joint_name(j) for j in joints if not actuation.of_joint(j)]
    if bare:
        return ArmDrive([], None, unused, f"no actuator moves {shortened(bare)}")
    return ArmDrive(
        [],
        None,
        unused,
        "its joints do not have one position servo, velocity servo or motor each, which an arm has "
        f"to have: {shortened(unused)}",
    )


def _leader_in(actuation: Actuation, joint: int, joints: list[int]) -> int | None:
    follower = actuation.follower(joint)
    return follower.leader if follower and follower.leader in joints else None
