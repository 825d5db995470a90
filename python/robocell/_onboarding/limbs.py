"""Arms, hands and the rest of a robot: its tree of joints, cut where it branches.

A robot is followed from its root. Where the tree branches into parts that are small against the
way there, that is a hand with its fingers, and the way there is an arm. Where it branches into
large parts, each of them is followed on: a torso. Wheels, heads and legs are limbs without a hand.
"""

from __future__ import annotations

import enum
import itertools
from dataclasses import dataclass, field

import mujoco
import numpy as np

from robocell._onboarding.actuation import Actuation
from robocell._onboarding.jaws import is_jaw
from robocell._onboarding.source_model import SourceModel

# A part is a hand when it is this small against the arm that carries it, or this small at all, m.
HAND_SHARE = 0.5
HAND_SIZE = 0.28
# Fewer joints than this carry no hand; they are a wrist that belongs to it.
LEAST_ARM_JOINTS = 3


class LimbKind(enum.Enum):
    """Kinds of limbs."""

    ARM = "arm"
    LEG = "leg"
    WHEEL = "wheel"
    OTHER = "other"


@dataclass
class Hand:
    """The hand at the end of an arm, or a hand alone.

    Attributes:
        body: The body that carries the fingers.
        joints: All joints below it, and those before it that belong to it.
    """

    body: int
    joints: list[int]


@dataclass
class Limb:
    """A serial chain of joints, perhaps with a hand at its end."""

    joints: list[int]
    end: int  # the body that the last joint moves; of a hand alone, what carries it
    hand: Hand | None = None
    kind: LimbKind = LimbKind.OTHER


@dataclass
class Anatomy:
    """The parts of one robot.

    Attributes:
        root: Its topmost body, a child of the world.
        trunk: Joints before the first branch into several limbs.
        trunk_end: The body that the trunk ends at; limbs hang on it.
        limbs: In the order of the model.
    """

    root: int
    trunk: list[int]
    trunk_end: int
    limbs: list[Limb] = field(default_factory=list)

    @property
    def arms(self) -> list[Limb]:
        """Returns the limbs that are arms."""
        return [limb for limb in self.limbs if limb.kind is LimbKind.ARM]


@dataclass
class _Stretch:
    """Joints one after the other, up to where the tree branches."""

    joints: list[int]
    end: int
    branches: list[int]  # children of `end` with joints below them


def dissect(
    source: SourceModel, actuation: Actuation, root: int, skipped: set[int] | None = None
) -> Anatomy:
    """Returns the parts of the robot with topmost body `root`; `skipped` are the base's joints."""
    return _Dissection(source, actuation, root, skipped or set()).run()


class _Dissection:
    def __init__(self, source: SourceModel, actuation: Actuation, root: int, skipped: set[int]):
        self._source = source
        self._actuation = actuation
        self._skipped = skipped
        self._anatomy = Anatomy(root, [], root)

    def run(self) -> Anatomy:
        anatomy = self._anatomy
        self._split(anatomy.root, [], is_trunk=True)
        if len(self._carriers()) == 1 and anatomy.trunk:
            limb = self._carriers()[0]  # a lift or a waist under a single arm is part of it
            limb.joints = [*anatomy.trunk, *limb.joints]
            anatomy.trunk, anatomy.trunk_end = [], anatomy.root
        self._name_kinds()
        return anatomy

    def _carriers(self) -> list[Limb]:
        """Limbs that may be arms, by their hands or else by their joints."""
        limbs = self._anatomy.limbs
        with_hand = [limb for limb in limbs if limb.hand and limb.joints]
        if with_hand:
            return with_hand
        return [limb for limb in limbs if len(limb.joints) > LEAST_ARM_JOINTS]

    # --- Following the tree ---

    def _stretch(self, body: int) -> _Stretch:
        """Returns the stretch that begins with a body, including its joints."""
        joints = self._joints_of(body)
        while True:
            branches = [
                child for child in self._source.children(body) if self._source.joints_below(child)
            ]
            if len(branches) != 1:
                return _Stretch(joints, body, branches)
            body = branches[0]
            joints.extend(self._joints_of(body))

    def _joints_of(self, body: int) -> list[int]:
        return [joint for joint in self._source.joints_of(body) if joint not in self._skipped]

    def _split(self, begin: int, before: list[int], *, is_trunk: bool) -> None:
        stretch = self._stretch(begin)
        joints = [*before, *stretch.joints]
        limb = Limb(joints, stretch.end)
        if not stretch.branches:
            self._end_limb(limb)
        elif self._is_hand(stretch, joints):
            self._take_hand(limb, stretch)
            self._anatomy.limbs.append(limb)
        elif (main := self._main_branch(stretch)) is not None:
            for branch in stretch.branches:
                if branch != main:
                    self._split(branch, [], is_trunk=False)
            self._split(main, joints, is_trunk=is_trunk)
        else:
            if is_trunk:
                self._anatomy.trunk, self._anatomy.trunk_end = joints, stretch.end
                joints = []
            elif joints:
                self._anatomy.limbs.append(limb)
            for branch in stretch.branches:
                self._split(branch, [], is_trunk=False)

    def _main_branch(self, stretch: _Stretch) -> int | None:
        """Returns the branch that is far longer than all others; a spring is a short one."""
        sizes = {branch: self._size(branch) for branch in stretch.branches}
        depths = {branch: self._depth(branch) for branch in stretch.branches}
        main = max(sizes, key=lambda branch: (depths[branch], sizes[branch]))
        others = [branch for branch in stretch.branches if branch != main]
        beside = all(
            depths[b] <= 2 and 3 * depths[b] <= depths[main] + 1 and sizes[b] < sizes[main]
            for b in others
        )
        return main if beside and depths[main] > LEAST_ARM_JOINTS else None

    def _depth(self, body: int) -> int:
        """Returns the largest number of joints in series below a body."""
        below = [self._depth(child) for child in self._source.children(body)]
        return len(self._source.joints_of(body)) + max(below, default=0)

    def _size(self, body: int) -> float:
        """Returns the extent of a part from its attachment."""
        return self._source.extent_below(body)

    def _length(self, joints: list[int]) -> float:
        """Returns the length along joints at the reference pose, slides at full travel, m."""
        source = self._source
        anchors = [source.data.xanchor[joint] for joint in joints]
        length = sum(float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(anchors))
        for joint in joints:
            limits = source.limits(joint) if source.is_slide(joint) else None
            length += limits[1] - limits[0] if limits else 0.0
        return length

    # --- Hands ---

    def _is_hand(self, stretch: _Stretch, joints: list[int]) -> bool:
        if all(self._is_rolling(branch) for branch in stretch.branches):
            return False
        size = max(self._size(branch) for branch in stretch.branches)
        if size < HAND_SIZE and len(joints) < LEAST_ARM_JOINTS:
            return True  # nothing carries it: a hand alone
        moving = [joint for joint in joints if self._source.is_scalar(joint)]
        if len(moving) < LEAST_ARM_JOINTS:
            return False
        length = self._length(moving) + float(
            np.linalg.norm(
                self._source.data.xpos[stretch.end] - self._source.data.xanchor[moving[-1]]
            )
        )
        return size < max(HAND_SHARE * length, HAND_SIZE if length > 2 * HAND_SIZE else 0.0)

    def _take_hand(self, limb: Limb, stretch: _Stretch) -> None:
        source = self._source
        below = [j for branch in stretch.branches for j in source.joints_below(branch)]
        own: list[int] = []
        # A slider that moves the fingers through equalities is of the hand, not of the arm.
        while limb.joints and self._moves_any(limb.joints[-1], below):
            own.insert(0, limb.joints.pop())
        wrist = [joint for joint in limb.joints if source.is_scalar(joint)]
        body = int(source.model.body_parentid[source.model.jnt_bodyid[own[0]]]) if own else limb.end
        limb.hand = Hand(body, [*own, *below])
        if 0 < len(wrist) < LEAST_ARM_JOINTS:
            limb.hand.joints = [*wrist, *limb.hand.joints]
            limb.joints = [joint for joint in limb.joints if joint not in wrist]
        limb.end = int(source.model.jnt_bodyid[limb.joints[-1]]) if limb.joints else body

    def _moves_any(self, joint: int, others: list[int]) -> bool:
        return any(other in self._actuation.coupled(joint) for other in others)

    def _end_limb(self, limb: Limb) -> None:
        """Classifies a serial chain; its last joint may be a jaw that closes against its parent."""
        if len(limb.joints) > LEAST_ARM_JOINTS and is_jaw(self._source, limb.joints[-1]):
            jaw = limb.joints.pop()
            carrier = int(self._source.model.body_parentid[self._source.model.jnt_bodyid[jaw]])
            limb.hand = Hand(carrier, [jaw])
            limb.end = int(self._source.model.jnt_bodyid[limb.joints[-1]])
        if limb.joints or limb.hand:
            self._anatomy.limbs.append(limb)

    # --- Kinds ---

    def _name_kinds(self) -> None:
        source, limbs = self._source, self._anatomy.limbs
        for limb in limbs:
            if not limb.joints:
                continue
            if self._is_wheel(limb):
                limb.kind = LimbKind.WHEEL
            elif limb.hand:
                limb.kind = LimbKind.ARM
        rest = [limb for limb in limbs if limb.joints and limb.kind is LimbKind.OTHER]
        floor = self._lowest()
        for limb in rest:
            lowest = float(source.data.xpos[limb.end][2])
            stands = lowest < floor + 0.15 and len(limb.joints) >= 3
            if stands and len(rest) > 1 and self._is_legged(rest, floor):
                limb.kind = LimbKind.LEG
        rest = [limb for limb in rest if limb.kind is LimbKind.OTHER]
        has_hands = any(limb.hand for limb in limbs)
        if rest and not has_hands:
            most = max(len(limb.joints) for limb in rest)
            for limb in rest:
                if len(limb.joints) == most and most >= 2:
                    limb.kind = LimbKind.ARM

    def _is_legged(self, rest: list[Limb], floor: float) -> bool:
        """Returns True if the trunk is above the ends of several limbs, on a base that can fall."""
        root = self._anatomy.root
        free = int(mujoco.mjtJoint.mjJNT_FREE)
        joints = self._source.joints_of(root)
        falls = any(int(self._source.model.jnt_type[joint]) == free for joint in joints)
        return falls and self._source.data.xpos[self._anatomy.trunk_end][2] > floor + 0.2

    def _lowest(self) -> float:
        bodies = self._source.subtree(self._anatomy.root)
        return float(min(self._source.data.xpos[body][2] for body in bodies))

    def _is_rolling(self, branch: int) -> bool:
        """Returns True for a branch that is a wheel."""
        joints = self._source.joints_below(branch)
        return bool(joints) and self._is_wheel(Limb(joints, branch))

    def _is_wheel(self, limb: Limb) -> bool:
        """Returns True for one or two joints, the last an unlimited hinge with a level axis."""
        source = self._source
        if limb.hand or len(limb.joints) > 2:
            return False
        joint = limb.joints[-1]
        if not source.is_scalar(joint):
            return False
        level = abs(float(source.data.xaxis[joint][2])) < 0.5
        return source.limits(joint) is None and not source.is_slide(joint) and level
