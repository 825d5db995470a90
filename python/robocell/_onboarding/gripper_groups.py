"""Groups for the hands of a robot: grippers, and hands that are commanded joint by joint."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robocell._onboarding.actuation import Actuation, Actuator, Drive
from robocell._onboarding.guess import Confidence, shortened
from robocell._onboarding.hands import Fingers, HandMotion
from robocell._onboarding.limbs import Hand
from robocell._onboarding.named_poses import HandPoses
from robocell._onboarding.robot_guess import Field, Group, RobotGuess
from robocell._onboarding.source_model import SourceModel
from robocell._onboarding.tcp import Tcp, rounded
from robocell._onboarding.yaml_text import name_list

# Fingers that overlap when closed squeeze over this share of their travel, and at least this share
# is left out.
SQUEEZE = 0.02
LEAST_GAP = 0.04
# Fingers that turn are measured at their tips when their least distance opens this much less, m.
AT_THE_HINGE = 0.008


def _are_measured_at_tips(fingers: Fingers) -> bool:
    """Whether the distance of fingers is that of their tips: elsewhere they are nearer."""
    return fingers.is_jaw or fingers.pad_open > fingers.open + AT_THE_HINGE


class GripperGroups:
    """Adds the groups of hands to a robot file.

    Args:
        source: The model.
        actuation: Its actuators.
        out: The robot file.
        new_site: Makes the name of a site that the model does not have.
    """

    def __init__(
        self,
        source: SourceModel,
        actuation: Actuation,
        out: RobotGuess,
        new_site: Callable[[str], str],
    ):
        self._source = source
        self._actuation = actuation
        self._out = out
        self._new_site = new_site

    def add(self, hand: Hand, motion: HandMotion, name: str, tcp: Tcp) -> None:
        """Adds one hand."""
        name = self._out.free_name(name)
        names = [actuator.name for actuator in motion.actuators]
        moved = [j for j in hand.joints if self._actuation.is_moved(j)]
        direct = [j for j in hand.joints if self._is_direct(j, motion.actuators)]
        fingers = motion.fingers
        if not fingers:
            self._hand_without_fingers(hand, motion, name)
            return
        if motion.poses:
            self._hand_of_many_joints(hand, motion, motion.poses, name, tcp)
            return
        refs = self._finger_refs(fingers, name)
        fields: dict[str, Any] = {
            "kind": "gripper",
            "joints": self._names_of(direct or moved),
            "actuators": name_list(names),
            "leaf": tcp.leaf,
            "fingers": refs,
        }
        how = f"{'were' if len(names) > 1 else 'was'} closed and opened in a copy of the model"
        closed, opened = fingers.closed, fingers.open
        partners = [fingers.bodies[1], *(body for body, _ in fingers.others)]
        against = ", ".join(f"'{self._source.body_name(body)}'" for body in partners)
        if _are_measured_at_tips(fingers):
            closed, opened = fingers.pad_closed, fingers.pad_open
        comment = (
            f"{' and '.join(names)} {how}: '{self._source.body_name(fingers.bodies[0])}' and "
            f"{against} go from "
            f"{1000 * closed:.0f} to {1000 * opened:.0f} mm [{Confidence.HIGH.value}]"
        )
        if any(actuator.drive is Drive.MOTOR for actuator in motion.actuators):
            comment += ". Its actuators are motors: they push, and hold no opening in between"
            self._out.notes.append(
                f"'{name}' is driven by motors, which hold it open or closed and nothing in between"
            )
        for joint, friction in motion.friction.items():
            edit = {"joint": self._source.joint_name(joint), "frictionloss": friction}
            why = (
                f"dry friction of {self._source.model.dof_frictionloss[self._dof(joint)]:g} holds "
                "this joint against all that its actuator can push with [likely]"
            )
            self._out.edits.append(Field(edit, why))
        other = self._until_they_meet(fields, fingers, motion.actuators)
        self._out.groups.append(Group(name, fields, comment, "gripper", other))

    def _dof(self, joint: int) -> int:
        return int(self._source.model.jnt_dofadr[joint])

    def _until_they_meet(
        self, fields: dict[str, Any], fingers: Fingers, actuators: list[Actuator]
    ) -> dict[str, Any] | None:
        """Returns the group with controls that close the fingers just until contact."""
        if len(actuators) != 1:
            return None
        share = max(fingers.meets - SQUEEZE, LEAST_GAP)
        opened, closed = fingers.open_ctrl[0], fingers.closed_ctrl[0]
        ctrl = {"open": opened, "closed": float(f"{closed + share * (opened - closed):.4g}")}
        return {**fields, "ctrl": ctrl}

    def _hand_of_many_joints(
        self, hand: Hand, motion: HandMotion, found: HandPoses, name: str, tcp: Tcp
    ) -> None:
        """Adds a gripper whose opening goes between two named poses."""
        fingers = motion.fingers
        assert fingers is not None
        body = self._source.body_name
        thumb, *others = [body(tip.body) for tip in found.tips]
        fields: dict[str, Any] = {
            "kind": "gripper",
            "joints": self._names_of([j for j in hand.joints if self._actuation.is_moved(j)]),
            "actuators": name_list([actuator.name for actuator in motion.actuators]),
            "leaf": tcp.leaf,
            "fingers": [{"body": body(tip.body)} for tip in found.tips],
            "poses": found.poses,
        }
        comment = (
            f"a hand of {len(motion.actuators)} actuators: its thumb '{thumb}', the fingertip that "
            f"stands apart, closes against {shortened(others)}. The poses were looked for until "
            "the tips meet, and tried in a copy of the model: it goes from "
            f"{1000 * fingers.closed:.0f} to {1000 * fingers.open:.0f} mm "
            f"[{Confidence.MEDIUM.value}]"
        )
        if "pinch" in found.poses:
            comment += f". pinch: '{thumb}' meets '{body(found.tips[found.partner].body)}' alone"
        if found.keys:
            keys = [f"{pose} ('{key}')" for pose, key in found.keys.items()]
            comment += f". Of the model's keyframes: {shortened(keys)}"
        self._out.groups.append(Group(name, fields, comment, "gripper"))

    def _hand_without_fingers(self, hand: Hand, motion: HandMotion, name: str) -> None:
        self._out.notes.append(
            f"the hand on '{self._source.body_name(hand.body)}' is not a gripper: {motion.why_none}"
        )
        if not motion.actuators:
            return
        own = self._out.free_name(name.replace("gripper", "hand"))
        fields: dict[str, Any] = {
            "kind": "generic",
            "joints": self._names_of(
                [j for j in hand.joints if self._is_direct(j, motion.actuators)]
            ),
            "actuators": name_list([actuator.name for actuator in motion.actuators]),
        }
        comment = f"a hand that is commanded joint by joint: {motion.why_none}"
        self._out.groups.append(Group(own, fields, comment, "generic"))

    def _is_direct(self, joint: int, actuators: list[Actuator]) -> bool:
        """Returns True if an actuator moves a joint, or one that it follows by a joint equality."""
        follower = self._actuation.follower(joint)
        pulled = {each for actuator in actuators for each in actuator.joints}
        return joint in pulled or (follower is not None and follower.leader in pulled)

    def _finger_refs(self, fingers: Fingers, name: str) -> list[Any]:
        """Bodies, or sites at the tips of fingers that turn."""
        source = self._source
        at_tips = _are_measured_at_tips(fingers)
        ends = [*zip(fingers.bodies, fingers.tips, strict=True), *fingers.others]
        if not at_tips:
            return [{"body": source.body_name(body)} for body, _ in ends]
        refs = []
        for index, (body, tip) in enumerate(ends):
            site = self._new_site(f"{name}_tip{index + 1}")
            edit = {"add_site": site, "body": source.body_name(body), "pos": rounded(tip)}
            why = (
                f"the tips of '{name}', between which its opening is measured; the fingers turn, "
                "and are nearer to each other at their hinges"
            )
            self._out.edits.append(Field(edit, why if index == 0 else ""))
            refs.append({"site": site})
        return refs

    def _names_of(self, joints: list[int]) -> Any:
        return name_list([self._source.joint_name(joint) for joint in joints])
