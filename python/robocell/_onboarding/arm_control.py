"""Determines an arm's actuators and whether robocell can command them."""

from __future__ import annotations

from dataclasses import dataclass, field

from robocell._onboarding.actuation import Actuation, Actuator, Drive
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
    """The actuators of an arm.

    Attributes:
        joints: Its joints without those that follow others of it: one for each degree of freedom.
        actuators: Names of its actuators, one per joint; empty where robocell finds them itself,
            and where there are none.
        drive: Their kind.
        unused: Other actuators on the same joints.
        coupled: Why the file names no actuators; "" where it does.
        why_not: Why the arm cannot be commanded; "" when it can.
    """

    joints: list[int]
    actuators: list[str] = field(default_factory=list)
    drive: Drive | None = None
    unused: list[str] = field(default_factory=list)
    coupled: str = ""
    why_not: str = ""

    @property
    def control(self) -> str:
        """The controller of the robot file."""
        return CONTROL[self.drive] if self.drive else "joint_position"


def drive_of(source: SourceModel, actuation: Actuation, joints: list[int]) -> ArmDrive:
    """Returns the actuators of an arm."""
    leaders = {joint: actuation.leader(joint, joints) for joint in joints}
    free = [joint for joint in joints if leaders[joint] is None]
    pulling = list({a.id: a for joint in joints for a in actuation.of_joint(joint)}.values())
    follows = [
        f"'{source.joint_name(joint)}' follows '{source.joint_name(leader)}'"
        for joint, leader in leaders.items()
        if leader is not None
    ]
    moved = {
        leader if (leader := leaders[joint]) is not None else joint
        for actuator in pulling
        for joint in actuator.joints
        if joint in leaders
    }
    bare = [joint for joint in free if joint not in moved]
    if not pulling:
        return ArmDrive(free, why_not="no actuator moves its joints")
    names = [actuator.name for actuator in pulling]
    if bare:
        return ArmDrive(free, unused=names, why_not=_why_bare(source, actuation, bare))
    if not follows:
        for drive in DRIVES:
            found = [_on_joint(actuation, joint, drive) for joint in free]
            if all(found):
                unused = [name for name in names if name not in found]
                return ArmDrive(free, found, drive, unused)
    for drive in DRIVES:
        of_kind = [actuator for actuator in pulling if actuator.drive is drive]
        if len(of_kind) >= len(free):
            return ArmDrive(free, drive=drive, coupled=_why_found(follows, of_kind))
    return ArmDrive(
        free,
        unused=names,
        why_not="its joints do not have one position servo, velocity servo or motor each, which an "
        f"arm has to have: {shortened(names)}",
    )


def _why_bare(source: SourceModel, actuation: Actuation, bare: list[int]) -> str:
    """Returns why joints without an actuator cannot be commanded, and what to do."""
    names = [source.joint_name(joint) for joint in bare]
    text = f"no actuator moves {shortened(names)}"
    for joint, name in zip(bare, names, strict=True):
        if loop := actuation.loop_of(joint):
            return (
                f"{text}. {name} is {loop}, and joints of an arm are commanded one by one or "
                f"follow one other each: put an actuator on {name}, or write its coupling as "
                f'<joint joint1="{name}" joint2="LEADER"/> below <equality>'
            )
    return text


def _on_joint(actuation: Actuation, joint: int, drive: Drive) -> str:
    """Returns the name of an actuator of a kind that pulls this joint and no other, or ""."""
    return next((a.name for a in actuation.on_joint(joint) if a.drive is drive), "")


def _why_found(follows: list[str], actuators: list[Actuator]) -> str:
    """Returns why a robot file leaves the actuators of an arm to robocell."""
    reasons = [f"{shortened(follows)} by equalities"] if follows else []
    together = [actuator.name for actuator in actuators if not actuator.is_on_joint]
    if together:
        reasons.append(f"{shortened(together)} act through tendons")
    return f"{'; '.join(reasons)}, so its {len(actuators)} actuators are found from the model"
