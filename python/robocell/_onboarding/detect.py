"""Guesses the content of a robot file from a model."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from robocell._onboarding.actuation import Actuation, Actuator, Drive
from robocell._onboarding.arm_control import drive_of
from robocell._onboarding.bases import (
    FLUSH_M,
    Base,
    find_base,
    guess_base,
    is_at_origin,
    lowest_of_base,
    sinks,
)
from robocell._onboarding.cameras import (
    Camera,
    cameras_of_model,
    exo_camera,
    is_on,
    wrist_camera,
)
from robocell._onboarding.gripper_groups import GripperGroups
from robocell._onboarding.guess import Confidence, Guess, shortened
from robocell._onboarding.hands import HandMotion, find_fingers
from robocell._onboarding.home import ArmFrame, Home, PoseJudge, guess_home
from robocell._onboarding.limbs import Anatomy, Hand, Limb, LimbKind
from robocell._onboarding.mounted import find_mounts, mount, reasons_to_mount
from robocell._onboarding.prepared import prepare, reasons_to_prepare
from robocell._onboarding.robot_guess import Field, Group, RobotGuess
from robocell._onboarding.roots import Roots, anatomy_of, find_roots
from robocell._onboarding.source_model import SourceModel, Vector, load_model
from robocell._onboarding.tcp import Tcp, approach_of, rounded, tcp_of_hand, tcp_without_hand
from robocell._onboarding.yaml_text import name_list
from robocell.robots import expand_names

# Chooses one of a guess's value and alternatives; what comes in is what goes out unless asked.
Choose = Callable[[str, Guess[Any]], Guess[Any]]

# Starts vary by this much.
NOISE_RAD = 0.03
NOISE_M = 0.005


def detect(
    path: Path, model_file: Path, name: str, choose: Choose = lambda what, guess: guess
) -> RobotGuess:
    """Guesses the robot file of a model.

    Args:
        path: The model's file.
        model_file: Where a changed model would be written.
        name: Of the robot.
        choose: Asked about every guess that has alternatives.
    """
    source = load_model(path)
    mounts = find_mounts(source)
    mounted = reasons_to_mount(source, mounts)
    if mounts:
        find_roots(source, Actuation(source))  # raises for the file itself if it has no robot
        source = mount(source, mounts, model_file)
    actuation = Actuation(source)
    roots = choose("robot", find_roots(source, actuation))
    reasons = reasons_to_prepare(source, actuation, roots.value)
    if reasons:
        source = prepare(source, actuation, roots.value, model_file)
        actuation = Actuation(source)
        again = find_roots(source, actuation)
        roots = Guess(again.value, f"the base of {roots.value}", roots.confidence)
    return _Detection(source, actuation, roots, mounted + reasons, path, name, choose).run()


@dataclass
class _Arm:
    """An arm with its guesses."""

    limb: Limb
    name: str
    drive_comment: str
    tcp: Guess[Tcp]
    motion: HandMotion | None
    frame: ArmFrame


class _Detection:
    def __init__(
        self,
        source: SourceModel,
        actuation: Actuation,
        roots: Guess[Roots],
        reasons: list[str],
        original: Path,
        name: str,
        choose: Choose,
    ):
        self._source = source
        self._actuation = actuation
        self._choose = choose
        self._root = roots.value.bodies[0]
        self._base: Base = find_base(source, self._root)
        self._anatomy: Anatomy = anatomy_of(source, actuation, self._root)
        self._bodies = source.subtree(self._root)
        self._names: set[str] = {
            str(source.model.site(site).name) for site in range(source.model.nsite)
        }
        self._out = RobotGuess(
            name,
            source,
            original.absolute(),
            reasons,
            Field(source.body_name(self._root_body()), self._root_comment(roots)),
            Field({}),
        )

        self._grippers = GripperGroups(source, actuation, self._out, self._new_name)

    def run(self) -> RobotGuess:
        out = self._out
        arms = self._arms()
        hands = self._hands_alone()
        self._home(arms, hands)
        reach = PoseJudge(self._source, arms[0].frame).reach if arms else 0.0
        out.reach = reach
        base = self._choose(
            "base",
            guess_base(
                self._source,
                self._actuation,
                self._base,
                reach=reach if arms else 0.0,
                on_box=self._root_body() == self._root,
            ),
        )
        out.base = Field(base.value, base.comment())
        if "size" in base.value or sinks(self._source, self._base, self._root):
            self._stand_on_floor()
        if self._base.free_joint is not None:
            joint = self._source.joint_name(self._base.free_joint)
            out.edits.insert(
                0, Field({"delete": {"joint": joint}}, "the base is put somewhere and stays there")
            )
        self._base_groups()
        self._other_groups()
        self._other_cups()
        self._cameras(arms, reach)
        self._gravity(arms)
        self._inactive_welds()
        if not arms and not hands:
            out.notes.append(
                "no arm and no gripper was found. robocell needs a chain of hinges and slides with "
                "one position servo, velocity servo or motor each, or a hand whose fingers an "
                "actuator closes"
            )
        return out

    def _stand_on_floor(self) -> None:
        """Puts the lowest point of the base on its box, or on the floor."""
        low = lowest_of_base(self._source, self._root)
        if abs(low) > FLUSH_M:
            edit = {"body": self._source.body_name(self._root), "pos": [0, 0, round(-low, 4)]}
            why = "the lowest point of the base stands on its box, or on the floor"
            self._out.edits.append(Field(edit, why))
        elif not is_at_origin(self._source, self._root):
            self._out.reset_root_pose = True

    # --- Arms ---

    def _root_body(self) -> int:
        """Returns the body that carries all arms: the base, or a body that a torso moves."""
        source, top = self._source, self._base.body
        roots = [
            int(source.model.body_parentid[source.model.jnt_bodyid[limb.joints[0]]])
            for limb in self._anatomy.arms
        ]
        if not roots:
            return top
        common = roots[0]
        for root in roots[1:]:
            common = source.common_ancestor(common, root)
        between = [
            joint for body in source.bodies_between(top, common) for joint in source.joints_of(body)
        ]
        return common if between else top

    def _root_comment(self, roots: Guess[Roots]) -> str:
        if self._root_body() != self._base.body:
            return (
                "the arms hang on it; the joints before it are a separate group "
                f"[{Confidence.HIGH.value}]"
            )
        if self._base.joints:
            return f"the body that the joints of the base move [{Confidence.HIGH.value}]"
        return roots.comment()

    def _arms(self) -> list[_Arm]:
        limbs = self._anatomy.arms
        arms = []
        for index, limb in enumerate(limbs):
            prefix = self._side(limb, index) if len(limbs) > 1 else ""
            arms.append(self._arm(limb, prefix))
        return arms

    def _side(self, limb: Limb, index: int) -> str:
        """Returns 'left_' or 'right_' by the names of its joints; else a number."""
        text = " ".join(self._source.joint_name(joint) for joint in limb.joints).lower()
        words = re.split(r"[^a-z]+", text)
        for side, short in (("left", "l"), ("right", "r")):
            if any(side in word for word in words) or words.count(short) >= len(limb.joints) - 1:
                return f"{side}_"
        return f"arm{index + 1}_"

    def _arm(self, limb: Limb, prefix: str) -> _Arm:
        source = self._source
        name = f"{prefix}arm" if not prefix.startswith("arm") else prefix.rstrip("_")
        motion = find_fingers(source, self._actuation, limb.hand) if limb.hand else None
        fingers = motion.fingers if motion else None
        cups: list[Actuator] = []
        if limb.hand and fingers:
            approach_body = limb.hand.body
            approach = approach_of(fingers, *self._wrist(limb, limb.hand))
            tcp = tcp_of_hand(source, limb.hand, fingers, approach, self._new_name(f"{prefix}tcp"))
        else:
            cups = self._cups_on(limb)
            cup = cups[0].body if cups else None
            tcp = self._choose(f"TCP of {name}", tcp_without_hand(source, limb, cup))
            approach_body, approach = limb.end, self._outward(limb, tcp.value)
            if not limb.hand and not cups:
                self._out.tool_places.append(tcp.value.leaf)
        drive = drive_of(source, self._actuation, limb.joints)
        frame = self._frame(limb, drive.joints, tcp.value, approach_body, approach)
        if tcp.value.edit:
            self._out.edits.append(Field(tcp.value.edit, f"the TCP of '{name}': {tcp.comment()}"))
        kinds = self._joint_words(limb.joints)
        fields: dict[str, Any] = {"kind": "arm", "joints": self._joints(drive.joints)}
        comment = f"{kinds} in a row"
        if drive.coupled:
            comment += f". {drive.coupled} [{Confidence.HIGH.value}]"
            self._out.control[name] = drive.control
        elif drive.actuators:
            fields["actuators"] = name_list(drive.actuators)
            comment += f", a {drive.drive.value if drive.drive else ''} on each [sure]"
            self._out.control[name] = drive.control
        elif drive.why_not:
            comment += f". It cannot be commanded: {drive.why_not}"
            self._out.notes.append(f"'{name}' cannot be commanded: {drive.why_not}")
        if drive.unused:
            comment += f". Not commanded: {shortened(drive.unused)}"
        fields["leaf"] = tcp.value.leaf
        if not tcp.value.edit:
            comment += f". leaf: {tcp.comment()}"
        group = Group(name, fields, comment, "arm")
        names = [a.name for j in limb.joints for a in self._actuation.of_joint(j)]
        by_joint = {
            **fields,
            "kind": "generic",
            "actuators": name_list(list(dict.fromkeys(names))),
        }
        if drive.coupled:
            group.other_fields = by_joint
        elif drive.why_not and drive.unused:
            group.fields, group.kind = by_joint, "generic"
        self._out.groups.append(group)
        if limb.hand and motion:
            self._grippers.add(limb.hand, motion, f"{prefix}gripper", tcp.value)
        if cups:
            self._add_cups(cups, f"{prefix}cup" if limb.hand else f"{prefix}gripper", tcp.value)
        return _Arm(limb, name, comment, tcp, motion, frame)

    def _cups_on(self, limb: Limb) -> list[Actuator]:
        """Returns the actuators that make bodies at the end of a limb stick."""
        fixed = self._source.rigid_with(limb.end)
        return [
            actuator
            for actuator in self._actuation.actuators
            if actuator.drive is Drive.ADHESION and actuator.body in fixed
        ]

    def _add_cups(self, cups: list[Actuator], name: str, tcp: Tcp) -> None:
        """Adds the gripper that consists of these."""
        bodies = {self._source.body_name(cup.body) for cup in cups if cup.body is not None}
        fields = {
            "kind": "gripper",
            "actuators": name_list([cup.name for cup in cups]),
            "leaf": tcp.leaf,
        }
        comment = (
            f"{shortened([cup.name for cup in cups])} makes {shortened(sorted(bodies))} stick to "
            f"what it touches, as suction cups and magnets do [{Confidence.HIGH.value}]"
        )
        self._out.groups.append(Group(self._out.free_name(name), fields, comment, "gripper"))

    def _wrist(self, limb: Limb, hand: Hand) -> tuple[Vector, Vector | None]:
        """Returns the position of the arm's last joint and a hinge's axis, in the hand's frame."""
        d, joint = self._source.data, limb.joints[-1]
        rotation = d.xmat[hand.body].reshape(3, 3)
        at = np.asarray(rotation.T @ (d.xanchor[joint] - d.xpos[hand.body]))
        axis = None if self._source.is_slide(joint) else np.asarray(rotation.T @ d.xaxis[joint])
        return at, axis

    def _outward(self, limb: Limb, tcp: Tcp) -> Vector:
        """Returns the direction from the last joint to the TCP, else the joint's axis."""
        d = self._source.data
        rotation = d.xmat[limb.end].reshape(3, 3)
        anchor = d.xanchor[limb.joints[-1]]
        away = (tcp.in_world if tcp.in_world is not None else anchor) - anchor
        axis = d.xaxis[limb.joints[-1]]
        if np.linalg.norm(away) < 5e-3:
            return np.asarray(rotation.T @ axis)
        along = abs(float(axis @ away)) / float(np.linalg.norm(away))
        if along > 0.8:
            away = np.sign(axis @ away) * axis
        return np.asarray(rotation.T @ (away / np.linalg.norm(away)))

    def _frame(
        self, limb: Limb, joints: list[int], tcp: Tcp, body: int, approach: Vector
    ) -> ArmFrame:
        d = self._source.data
        rotation = d.xmat[body].reshape(3, 3)
        at = tcp.in_world if tcp.in_world is not None else d.xpos[body]
        return ArmFrame(
            joints=joints,
            followers=[joint for joint in limb.joints if joint not in joints],
            settled=self._actuation.settled,
            base=self._root_body(),
            tip_body=body,
            tip=np.asarray(rotation.T @ (at - d.xpos[body])),
            approach=approach,
            robot=self._bodies,
            moving=self._source.subtree(int(self._source.model.jnt_bodyid[limb.joints[0]])),
        )

    def _joint_words(self, joints: list[int]) -> str:
        slides = sum(self._source.is_slide(joint) for joint in joints)
        hinges = len(joints) - slides
        words = [
            f"{count} {word}{'s' if count > 1 else ''}"
            for count, word in ((hinges, "hinge"), (slides, "slide"))
            if count
        ]
        return " and ".join(words)

    def _joints(self, joints: list[int]) -> Any:
        return name_list([self._source.joint_name(joint) for joint in joints])

    def _new_name(self, name: str) -> str:
        while name in self._names:
            name = f"{name}_point"
        self._names.add(name)
        return name

    # --- Hands ---

    def _hands_alone(self) -> list[HandMotion]:
        """Hands that no arm carries."""
        found = []
        limbs = [
            limb for limb in self._anatomy.limbs if limb.hand and limb.kind is not LimbKind.ARM
        ]
        for index, limb in enumerate(limbs):
            hand = limb.hand
            assert hand is not None
            motion = find_fingers(self._source, self._actuation, hand)
            name = "gripper" if len(limbs) == 1 else f"gripper{index + 1}"
            tcp = Tcp({"body": self._source.body_name(hand.body)})
            if motion.fingers:
                approach = approach_of(motion.fingers, np.zeros(3))
                guess = tcp_of_hand(
                    self._source, hand, motion.fingers, approach, self._new_name("tcp")
                )
                tcp = guess.value
                if tcp.edit:
                    self._out.edits.append(Field(tcp.edit, f"the TCP: {guess.comment()}"))
            self._grippers.add(hand, motion, name, tcp)
            found.append(motion)
        return found

    # --- Home ---

    def _home(self, arms: list[_Arm], hands: list[HandMotion]) -> None:
        start = np.array(self._source.model.qpos0)
        motions = [arm.motion for arm in arms if arm.motion] + hands
        for motion in motions:
            if motion.fingers:
                changed = motion.fingers.open_qpos != self._source.model.qpos0
                start[changed] = motion.fingers.open_qpos[changed]
        home = self._choose("home", guess_home(self._source, [a.frame for a in arms], start))
        value: Home = home.value
        qpos = value.qpos.copy()
        self._out.home_comment = home.comment()
        for group in self._out.groups:
            joints = self._ids(group.fields.get("joints", []))
            if group.kind == "gripper":
                values = self._open_values(joints, motions)
                if values is None:
                    continue
                self._out.home[group.name] = values
            else:
                addresses = [int(self._source.model.jnt_qposadr[joint]) for joint in joints]
                self._out.home[group.name] = self._within_limits(joints, qpos[addresses])
            self._out.home_noise[group.name] = self._noise(group, joints, qpos)

    def _noise(self, group: Group, joints: list[int], qpos: Vector) -> list[float]:
        """Returns the variation of starts: inside the limits of every joint; grippers stay open."""
        if group.kind != "arm":
            return [0.0]
        values = []
        for joint in joints:
            most = NOISE_M if self._source.is_slide(joint) else NOISE_RAD
            value = float(qpos[self._source.model.jnt_qposadr[joint]])
            lower, upper = self._source.limits(joint) or (-np.inf, np.inf)
            values.append(round(max(0.0, min(most, value - lower, upper - value)), 4))
        return values[:1] if len(set(values)) == 1 else values

    def _open_values(self, joints: list[int], motions: list[HandMotion]) -> list[float] | None:
        """Returns the joint values of an open gripper, if all its joints can be set at once."""
        m = self._source.model
        for motion in motions:
            fingers = motion.fingers
            if fingers is None or not any(
                a.joints and set(a.joints) & set(joints) for a in motion.actuators
            ):
                continue
            addresses = [int(m.jnt_qposadr[joint]) for joint in joints]
            return self._within_limits(joints, fingers.open_qpos[addresses])
        return None

    def _within_limits(self, joints: list[int], values: Vector) -> list[float]:
        """Returns the values rounded and clipped to the limits."""
        out = []
        for joint, value in zip(joints, rounded(values, 4), strict=True):
            lower, upper = self._source.limits(joint) or (-np.inf, np.inf)
            out.append(float(np.clip(value, lower, upper)))
        return out

    def _ids(self, names: Any) -> list[int]:
        listed = expand_names(str(names)) if isinstance(names, str) else names
        return [int(self._source.model.joint(name).id) for name in listed]

    # --- The rest ---

    def _base_groups(self) -> None:
        joints = self._base.joints
        self._generic("base_joints", joints, "the joints of the base")
        trunk = [joint for joint in self._anatomy.trunk if self._source.is_scalar(joint)]
        self._generic("torso", trunk, "the joints below the arms")

    def _other_groups(self) -> None:
        counts: dict[str, int] = {}
        for limb in self._anatomy.limbs:
            if limb.kind is LimbKind.ARM or not limb.joints:
                continue
            word = {LimbKind.LEG: "leg", LimbKind.WHEEL: "wheel"}.get(limb.kind, "limb")
            counts[word] = counts.get(word, 0) + 1
            self._generic(f"{word}{counts[word]}", limb.joints, f"neither arm nor hand: a {word}")

    def _generic(self, name: str, joints: list[int], why: str) -> None:
        """Adds a group of joints that are driven one by one; none without actuators."""
        pairs = []
        for joint in joints:
            on = self._actuation.on_joint(joint)
            if on:
                pairs.append((joint, on[0].name))
        if not pairs:
            return
        fields: dict[str, Any] = {
            "kind": "generic",
            "joints": self._joints([joint for joint, _ in pairs]),
            "actuators": name_list([actuator for _, actuator in pairs]),
        }
        self._out.groups.append(Group(name, fields, f"{why} [likely]", "generic"))

    def _other_cups(self) -> None:
        """Notes adhesion that is of no gripper, such as that of pads on fingers."""
        used = {
            name for group in self._out.of_kind("gripper") for name in self._actuators_of(group)
        }
        for actuator in self._actuation.actuators:
            if actuator.drive is not Drive.ADHESION or actuator.body not in self._bodies:
                continue
            if actuator.name in used:
                continue
            body = self._source.body_name(actuator.body)
            self._out.notes.append(
                f"'{actuator.name}' makes '{body}' stick, and no gripper has it: command it with "
                "scene.set_actuator_ctrl"
            )

    def _inactive_welds(self) -> None:
        """Notes welds that hold something once switched on, which robocell does not do."""
        m, source = self._source.model, self._source
        for index in range(m.neq):
            weld = int(m.eq_type[index]) == int(mujoco.mjtEq.mjEQ_WELD)
            if not weld or m.eq_active0[index]:
                continue
            if int(m.eq_objtype[index]) != int(mujoco.mjtObj.mjOBJ_BODY):
                continue
            pair = [int(m.eq_obj1id[index]), int(m.eq_obj2id[index])]
            own = [body for body in pair if body in self._bodies]
            if len(own) != 1:
                continue
            self._out.notes.append(
                f"weld '{m.equality(index).name or f'#{index}'}' of "
                f"'{source.body_name(own[0])}' is off in the model, and nothing of robocell "
                "switches it on. To pick by it, make the body stick: <adhesion "
                f'body="{source.body_name(own[0])}" gain="100" ctrlrange="0 1"/> below <actuator> '
                "is a gripper (docs/robots.md, suction cups and magnets)"
            )

    @staticmethod
    def _actuators_of(group: Group) -> list[str]:
        names = group.fields["actuators"]
        return list(expand_names(names) if isinstance(names, str) else names)

    # --- Cameras and gravity ---

    def _cameras(self, arms: list[_Arm], reach: float) -> None:
        source = self._source
        found = cameras_of_model(source, self._bodies)
        out = self._out
        if found:
            out.camera_note = f"cameras of the model: {shortened(found)}"
        if not arms:
            return
        arm = arms[0]
        frame = arm.frame
        on_hand = [camera for camera in found if is_on(source, camera, arm.limb.end)]
        if on_hand:
            out.streams.append(("wrist", on_hand[0]))
        else:
            fingers = arm.motion.fingers if arm.motion else None
            closing = fingers.closing if fingers else _square_to(frame.approach)
            name = _unused("wrist_camera", found)
            guess: Guess[Camera] = wrist_camera(
                source, frame.tip_body, frame.tip, frame.approach, closing, name
            )
            out.cameras.append(Field(guess.value.field, guess.comment()))
            out.streams.append(("wrist", name))
        name = _unused("exo_camera", found)
        guess = exo_camera(source, self._root_body(), reach, name)
        out.cameras.append(Field(guess.value.field, guess.comment()))
        out.streams.append(("exo", name))

    def _gravity(self, arms: list[_Arm]) -> None:
        m = self._source.model
        if not arms:
            return
        moving = [b for b in self._bodies if m.body_mass[b] > 0 and m.body_weldid[b] != 0]
        if moving and all(m.body_gravcomp[b] == 1 for b in moving):
            return
        self._out.gravcomp = Field(
            True, "the controllers of most real arms carry their weight; without it servos sag"
        )


def _square_to(vector: Vector) -> Vector:
    other = np.cross(vector, np.eye(3)[int(np.argmin(np.abs(vector)))])
    return np.asarray(other / np.linalg.norm(other))


def _unused(name: str, taken: list[str]) -> str:
    while name in taken:
        name = f"robot_{name}"
    return name
