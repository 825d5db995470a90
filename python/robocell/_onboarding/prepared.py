"""Makes a copy of a model with changes that robot files cannot make.

Robot files change a model by `edits`. These cannot add actuators to a model that has none, put a
body under an arm whose first joint moves the model's topmost body, or make one robot
of two arms that stand beside each other in the model's world. For such models `robocell init`
writes a separate MJCF with only these changes.
"""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from robocell import SpecError
from robocell._onboarding.actuation import Actuation, reflected_inertia
from robocell._onboarding.bases import find_base
from robocell._onboarding.limbs import Limb, LimbKind
from robocell._onboarding.roots import Roots, anatomy_of
from robocell._onboarding.source_model import SourceModel, Vector

BASE_NAME = "robot_base"
UPRIGHT = 0.99  # cosine of the tilt of a body that stands
# Servos are made as stiff as a mass on a spring with this many radians per second.
FREQUENCY = 25.0
FINGER_FREQUENCY = 60.0
# They are no softer than the damping and the friction of the joint itself ask for.
FOLLOWING = 10.0  # 1/s, against its damping
STUCK_RAD, STUCK_M = 0.01, 0.001  # where its friction may hold it
MOST_FREQUENCY = 250.0  # stable with steps of 2 ms
FINGER_SECONDS = 0.08  # of its motion: light fingers that are faster pass through each other
FINGER_FORCE = 30.0  # N that a slide of a hand pushes with, at half its travel
LEAST_ARMATURE = 0.01  # kg m2 of a joint of an arm that has none: rotors behind gears weigh more


def reasons_to_prepare(source: SourceModel, actuation: Actuation, roots: Roots) -> list[str]:
    """Returns why the model needs a modified copy; empty if it does not."""
    reasons = []
    if len(roots.bodies) > 1:
        reasons.append(f"{roots} stand beside each other, and a robot has one root")
    elif _starts_at_root(source, actuation, roots.bodies[0]):
        reasons.append(
            f"a joint of the arm moves the model's topmost body '{roots.names[0]}', and an arm "
            "begins behind its base"
        )
    bare = [
        limb
        for root in roots.bodies
        for limb in anatomy_of(source, actuation, root).limbs
        if _is_bare(actuation, limb)
    ]
    if bare:
        names = [source.joint_name(limb.joints[0]) for limb in bare if limb.joints]
        reasons.append(f"no actuator moves the arm from joint {', '.join(names) or 'the hand'} on")
    return reasons


def prepare(source: SourceModel, actuation: Actuation, roots: Roots, file: Path) -> SourceModel:
    """Returns the changed model, as it will be read from `file`, which does not exist yet."""
    spec = source.spec.copy()
    make_paths_absolute(spec, source)
    for name in _joints_without_servo(source, actuation, roots):
        _add_servo(source, actuation, spec, name)
    _drop_others(source, spec, roots)
    needs_base = len(roots.bodies) > 1 or _starts_at_root(source, actuation, roots.bodies[0])
    try:
        spec.compile()
        if needs_base:
            spec = mujoco.MjSpec.from_string(_with_base(str(spec.to_xml()), source, roots))
        model = spec.compile()
        if source.model.nkey and not model.nkey:
            add_keys(source, spec, model)
            model = spec.compile()
    except (ValueError, OSError) as error:
        raise SpecError(
            f"{source.path}: the changed model does not compile: {str(error).strip()}. Add what is "
            "missing to the model's file by hand"
        ) from error
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return SourceModel(file.absolute(), spec, model, data)


def model_text(source: SourceModel, reasons: list[str], original: Path) -> str:
    """Returns the MJCF of a prepared model; files that it refers to are named from its folder."""
    folder = source.path.parent
    text = str(source.spec.to_xml())
    for element in _with_files(source.spec):
        text = text.replace(
            f'file="{element.file}"', f'file="{os.path.relpath(element.file, folder)}"'
        )
    note = (
        f"Made from {os.path.relpath(original, folder)} by `robocell init`: {'; '.join(reasons)}."
    )
    return f"<!-- {note.replace('--', '- -')} -->\n{text}"


# --- What it needs ---


def _starts_at_root(source: SourceModel, actuation: Actuation, root: int) -> bool:
    """Returns True if a joint of an arm or hand moves the topmost body itself."""
    base = find_base(source, root)
    own = {j for j in source.joints_of(root) if j != base.free_joint and j not in base.joints}
    limbs = anatomy_of(source, actuation, root).limbs
    return any(own & {*limb.joints, *(limb.hand.joints if limb.hand else [])} for limb in limbs)


def _is_bare(actuation: Actuation, limb: Limb) -> bool:
    if limb.kind is LimbKind.ARM:
        return not any(actuation.is_moved(joint) for joint in limb.joints)
    is_hand_alone = limb.hand is not None and not limb.joints
    return is_hand_alone and not any(
        actuation.is_moved(joint) for joint in (limb.hand.joints if limb.hand else [])
    )


def _joints_without_servo(source: SourceModel, actuation: Actuation, roots: Roots) -> list[str]:
    """Returns the joints of arms and hands that neither an actuator nor another joint moves."""
    names = []
    for root in roots.bodies:
        for limb in anatomy_of(source, actuation, root).limbs:
            arm = limb.joints if limb.kind is LimbKind.ARM else []
            for joints in (arm, limb.hand.joints if limb.hand else []):
                if any(actuation.is_moved(joint) for joint in joints):
                    continue
                names += [
                    source.joint_name(joint)
                    for joint in joints
                    if source.is_scalar(joint) and actuation.follower(joint) is None
                ]
    return names


# --- Changes ---


def _add_servo(source: SourceModel, actuation: Actuation, spec: Any, name: str) -> None:
    """Adds a position servo that is stiff enough to carry the load of the joint."""
    m = source.model
    joint = int(m.joint(name).id)
    is_finger = source.is_slide(joint) and source.extent_below(int(m.jnt_bodyid[joint])) < 0.2
    element = spec.joint(name)
    dof = int(m.jnt_dofadr[joint])
    inertia = max(_largest_inertia(source, each) for each in actuation.coupled(joint))
    if m.dof_armature[dof] == 0 and not source.is_slide(joint):
        element.armature = LEAST_ARMATURE if inertia > LEAST_ARMATURE else 0.3 * inertia
        inertia += element.armature
    kp = inertia * (FINGER_FREQUENCY if is_finger else FREQUENCY) ** 2
    limits = source.limits(joint)
    if is_finger and limits:
        kp = max(kp, 2 * FINGER_FORCE / (limits[1] - limits[0]))
    stuck = STUCK_M if source.is_slide(joint) else STUCK_RAD
    own = max(FOLLOWING * m.dof_damping[dof], m.dof_frictionloss[dof] / stuck)
    kp = max(kp, min(own, inertia * MOST_FREQUENCY**2))
    servo = spec.add_actuator(name=_free_name(spec, name), target=name)
    servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
    kv = max(2 * math.sqrt(kp * inertia), FINGER_SECONDS * kp if is_finger else 0.0)
    servo.set_to_position(kp=_two_digits(kp), kv=_two_digits(kv))
    if limits:
        servo.ctrlrange = list(limits)
        servo.ctrllimited = mujoco.mjtLimited.mjLIMITED_TRUE
    if m.jnt_actfrclimited[joint]:
        servo.forcerange = [float(value) for value in m.jnt_actfrcrange[joint]]
        servo.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE


def _largest_inertia(source: SourceModel, joint: int) -> float:
    """Returns the largest inertia over some poses spread over the joints' ranges."""
    rng = np.random.default_rng(0)
    most = reflected_inertia(source, joint, source.model.qpos0)
    for _ in range(12):
        qpos = source.model.qpos0.copy()
        for each in range(source.model.njnt):
            limits = source.limits(each)
            if limits and source.is_scalar(each):
                qpos[source.model.jnt_qposadr[each]] = rng.uniform(*limits)
        most = max(most, reflected_inertia(source, joint, qpos))
    return most


def _free_name(spec: Any, name: str) -> str:
    taken = {actuator.name for actuator in spec.actuators}
    while name in taken:
        name += "_servo"
    return name


def _two_digits(value: float) -> float:
    return float(f"{value:.2g}")


def _drop_others(source: SourceModel, spec: Any, roots: Roots) -> None:
    """Objects, tables and floors stay behind; keyframes come back when their numbers are known."""
    others = [b for b in source.children(0) if b not in roots.bodies]
    if others or len(roots.bodies) > 1:
        drop_keys(spec)
    for body in others:
        spec.delete(spec.body(source.body_name(body)))
    for elements in (spec.worldbody.geoms, spec.worldbody.sites, spec.worldbody.cameras):
        for element in list(elements):
            spec.delete(element)


def drop_keys(spec: Any) -> None:
    """Deletes the keyframes of a model whose joints change."""
    for key in list(spec.keys):
        spec.delete(key)


def add_keys(source: SourceModel, spec: Any, model: Any) -> None:
    """Adds the keyframes of the given model, for the remaining joints."""
    for key in range(source.model.nkey):
        qpos = np.array(model.qpos0)
        for joint in range(model.njnt):
            name = model.joint(joint).name
            size = len(model.joint(joint).qpos0)
            begin = int(model.jnt_qposadr[joint])
            old = int(source.model.jnt_qposadr[source.model.joint(name).id])
            qpos[begin : begin + size] = source.model.key_qpos[key][old : old + size]
        spec.add_key(name=source.model.key(key).name or f"key{key}", qpos=qpos.tolist())


def _with_base(text: str, source: SourceModel, roots: Roots) -> str:
    """Adds a body without joints around all bodies of the world, at the pose of the first.

    Arms keep their places to each other; the first one stands at the origin if it is upright.
    """
    tree = ElementTree.fromstring(text)
    world = tree.find("worldbody")
    assert world is not None
    taken = {body.get("name") for body in tree.iter("body")}
    name = BASE_NAME
    while name in taken:
        name += "_"
    if len(roots.bodies) > 1:
        _put_at_the_first(world, source, roots)
    base = ElementTree.Element("body", name=name)
    for element in list(world):
        world.remove(element)
        base.append(element)
    world.append(base)
    return ElementTree.tostring(tree, encoding="unicode")


def _put_at_the_first(world: ElementTree.Element, source: SourceModel, roots: Roots) -> None:
    """Writes the poses of the roots in the frame of the first, if that stands upright.

    Arms that hang sideways are held by something that the model leaves out, at a height that they
    need: they are put above a frame on the floor below the first.
    """
    m, first = source.model, roots.bodies[0]
    inverse = np.zeros(3), np.zeros(4)
    pos, quat = m.body_pos[first].copy(), m.body_quat[first].copy()
    if source.data.xmat[first][8] < UPRIGHT:
        pos[2], quat = 0, np.array([1.0, 0, 0, 0])
    mujoco.mju_negPose(*inverse, pos, quat)
    for body, name in zip(roots.bodies, roots.names, strict=True):
        pos, quat = np.zeros(3), np.zeros(4)
        mujoco.mju_mulPose(pos, quat, *inverse, m.body_pos[body], m.body_quat[body])
        for element in world.iter("body"):
            if element.get("name") == name:
                write_pose(element, pos, quat)


def write_pose(element: ElementTree.Element, pos: Vector, quat: Vector) -> None:
    """Writes the pose of a body."""
    for old in ("euler", "axisangle", "xyaxes", "zaxis"):
        element.attrib.pop(old, None)
    element.set("pos", " ".join(f"{value:.9g}" for value in pos))
    element.set("quat", " ".join(f"{value:.9g}" for value in quat))


def _with_files(spec: Any) -> list[Any]:
    elements = [*spec.meshes, *spec.textures, *spec.hfields, *spec.skins]
    return [element for element in elements if element.file]


def make_paths_absolute(spec: Any, source: SourceModel) -> None:
    """Names the files of a model from the root, so that it is read from any folder."""
    folder = source.path.parent
    for elements, kind in (
        ([*spec.meshes, *spec.hfields, *spec.skins], spec.meshdir),
        (list(spec.textures), spec.texturedir),
    ):
        for element in elements:
            if element.file:
                name = Path(element.file).name if spec.strippath else element.file
                element.file = str((folder / kind / name).resolve())
    spec.meshdir = spec.texturedir = ""
    spec.strippath = False
