"""A robot of the original's classes as a robot of robocell: an MJCF file and a RobotConfig.

The robot's own `add_robot_to_scene` puts it into an empty model, and its view says which joints,
actuators and frames its groups have. So whatever the user's class does is in the file.
"""

from __future__ import annotations

import hashlib
import re
import sys
import threading
import warnings
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import robocell as rc
from robocell._core import atomic_write
from robocell._suggestions import shortened
from robocell.compat.molmo_spaces._assembly import (
    compiled,
    no_group,
    robot_alone,
    set_init_qpos,
    view_of,
    write_inertias,
)
from robocell.compat.molmo_spaces._elements import name_of
from robocell.compat.molmo_spaces.configs.robot_configs import BaseRobotConfig
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    FreeJointRobotBaseGroup,
    GripperGroup,
    HoloJointsRobotBaseGroup,
    MJCFFrameMixin,
    MoveGroup,
    RobotBaseGroup,
    RobotView,
    SimplyActuatedMoveGroup,
)

# The robot's names meanwhile. Without a prefix, the default classes of its model and of the empty
# one would have the same names.
PREFIX = "robot_0/"
CONTROLS = {
    "joint_position": "joint_position",
    "joint_rel_position": "relative_joint_position",
    "holo_joint_planar_position": "joint_position",
    "holo_joint_rel_planar_position": "relative_joint_position",
}


def write_robot(robot_config: Any, folder: Path) -> rc.RobotConfig:
    """Writes the robot's model with its files into a folder, and returns its configuration.

    Raises ArgumentError or NotFoundError, with the field, for what robocell cannot take over.
    """
    spec = robot_alone(robot_config, PREFIX)
    model = compiled(spec, robot_config.name)
    data = mujoco.MjData(model)
    view = view_of(robot_config, data, PREFIX)
    set_init_qpos(robot_config, view)
    mujoco.mj_forward(model, data)
    base = own_name(model, "body", view.base.root_body_id)
    path = folder / f"{file_name(robot_config.name)}.xml"
    _write_model(spec, base, path)
    _require_same(model, path)
    groups = {_name_of_group(name): _group(view, name) for name in _groups_of(view)}
    _warn_of_unused(robot_config, view, groups)
    return rc.RobotConfig(
        name=file_name(robot_config.name),
        model=str(path),
        root_body=base,
        base={"kind": _base_kind(view.base)},
        move_groups=groups,
        home=_positions(robot_config.init_qpos, groups),
        home_noise=_positions(robot_config.init_qpos_noise_range or {}, groups),
        control=_controls(robot_config, groups),
    )


def own_name(model: mujoco.MjModel, kind: str, index: int) -> str:
    """Returns the name of an element in the robot's own model."""
    return name_of(model, kind, index).removeprefix(PREFIX)


def file_name(name: str) -> str:
    """Returns a name without the characters that paths do not have."""
    return re.sub(r"[^\w.-]+", "_", name) or "robot"


def _write_model(spec: mujoco.MjSpec, base: str, path: Path) -> None:
    """Writes the model; robocell itself makes the base movable, so the body is an ordinary one."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Attach")
        write_inertias(spec)  # parts may have settings of their own, of which a file has one
        spec.compile()
        text = spec.to_xml()
    text = text.replace(f'"{PREFIX}main"', '"robot_main"').replace(f'"{PREFIX}', '"')
    root = ElementTree.fromstring(text)
    for body in root.iter("body"):
        if body.get("name") == base:
            body.attrib.pop("mocap", None)
    files = path.parent / "files"
    for element in root.iter():
        for attribute, file in list(element.attrib.items()):
            if attribute == "file" or attribute.startswith("file"):
                element.set(attribute, _copied(Path(file), files))
    compiler = root.find("compiler")
    if compiler is not None:
        for attribute in ("meshdir", "texturedir", "assetdir"):
            compiler.attrib.pop(attribute, None)
    text = ElementTree.tostring(root, encoding="unicode")
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_text() != text:  # the same file is not another one
        atomic_write(path, text.encode())


def _require_same(model: mujoco.MjModel, path: Path) -> None:
    """Raises SpecError if the file does not have the elements and numbers of the model."""
    written = mujoco.MjModel.from_xml_path(str(path))
    for kind, count in (
        ("body", "nbody"),
        ("joint", "njnt"),
        ("actuator", "nu"),
        ("site", "nsite"),
    ):
        names = [
            [own_name(each, kind, i) for i in range(getattr(each, count))]
            for each in (model, written)
        ]
        if names[0] != names[1]:
            there, own = ([each for each in names[i] if each not in names[1 - i]] for i in (1, 0))
            raise rc.SpecError(
                f"'{path}' has other elements of the kind '{kind}' than the robot: it lacks "
                f"{shortened(own) or 'none'} and adds {shortened(there) or 'none'}"
            )
    for field in ("body_mass", "body_pos", "jnt_axis", "jnt_range", "actuator_gainprm", "site_pos"):
        wanted, found = (getattr(each, field) for each in (model, written))
        if not np.allclose(found, wanted, rtol=1e-4, atol=1e-5):
            raise rc.SpecError(f"'{path}' has another {field} than the robot")


def _copied(file: Path, folder: Path) -> str:
    """Copies a file into a folder, under a name that its content decides. Returns its path."""
    if not file.is_absolute():
        raise rc.SpecError(
            f"file '{file}' of the robot's model has no absolute path: read the model with "
            "cls._load_robot_spec(robot_config) in add_robot_to_scene"
        )
    content = hashlib.sha256(file.read_bytes()).hexdigest()[:12]
    copy = folder / f"{file.stem}-{content}{file.suffix}"
    if not copy.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        atomic_write(copy, file.read_bytes())
    return f"{folder.name}/{copy.name}"


def _groups_of(view: RobotView) -> list[str]:
    """Returns the groups that robocell drives: those with joints of the engine, bases apart."""
    return [
        name
        for name in view.move_group_ids()
        if not isinstance(view.get_move_group(name), RobotBaseGroup)
        or isinstance(view.get_move_group(name), HoloJointsRobotBaseGroup)
        if view.get_move_group(name).n_joints or view.get_move_group(name).n_actuators
    ]


def _base_kind(base: RobotBaseGroup) -> str:
    return "free" if isinstance(base, FreeJointRobotBaseGroup) else "mocap"


def _name_of_group(name: str) -> str:
    """Returns the name of a group in robocell, where `base` is what carries the robot."""
    return "base_joints" if name == "base" else name


def _group(view: RobotView, name: str) -> dict[str, Any]:
    group: MoveGroup = view.get_move_group(name)
    model = view.mj_model
    fields: dict[str, Any] = {
        "kind": "generic",
        "joints": [own_name(model, "joint", each) for each in group._joint_ids],
        "actuators": [own_name(model, "actuator", each) for each in group._actuator_ids],
    }
    if isinstance(group, RobotBaseGroup):
        return fields  # robocell's own group `base` is that of the body that carries the robot
    if isinstance(group, MJCFFrameMixin):
        leaf = own_name(model, group.leaf_frame_type, group.leaf_frame_id)
        fields["leaf"] = {group.leaf_frame_type: leaf}
    if isinstance(group, GripperGroup):
        return fields | {"kind": "gripper"} | _ends(group, fields["actuators"]) | _fingers(group)
    if isinstance(group, SimplyActuatedMoveGroup) and "leaf" in fields:
        return fields | {
            "kind": "arm",
            "root": {"body": own_name(model, "body", group.root_body_id)},
        }
    return fields


def _ends(group: GripperGroup, actuators: list[str]) -> dict[str, Any]:
    """Returns the controls that the group's own method gives for open and closed."""
    before = group.ctrl.copy()
    ends = {}
    for word, is_open in (("open", True), ("closed", False)):
        group.set_gripper_ctrl_open(is_open)
        ends[word] = [float(value) for value in group.ctrl]
    group.ctrl = before
    if all(len(set(values)) <= 1 for values in ends.values()):
        return {"ctrl": {word: values[0] for word, values in ends.items()}}
    return {
        "poses": {word: dict(zip(actuators, values, strict=True)) for word, values in ends.items()}
    }


def _fingers(group: GripperGroup) -> dict[str, Any]:
    """Returns the geoms between which the group's own `inter_finger_dist` measures.

    Nothing if it measures otherwise; robocell then takes the bodies that the joints move.
    """
    with _measured_geoms(group) as pairs:
        _ = group.inter_finger_dist
    model = group.mj_model
    sides = [list(dict.fromkeys(side)) for side in zip(*pairs, strict=True)] if pairs else []
    bodies = [{int(model.geom_bodyid[geom]) for geom in side} for side in sides]
    if not sides or any(len(each) != 1 for each in bodies):
        return {}
    fingers: list[dict[str, Any]] = []
    for side, (body,) in zip(sides, bodies, strict=True):
        if len(side) > 1:
            fingers.append({"body": own_name(model, "body", body)})
            continue
        name = own_name(model, "geom", side[0])
        place = {
            "body": own_name(model, "body", body),
            "index": int(side[0] - model.body_geomadr[body]),
        }
        fingers.append({"geom": name or place})
    return {"fingers": fingers}


@contextmanager
def _measured_geoms(group: MoveGroup) -> Iterator[list[tuple[int, int]]]:
    """Lists the geoms of this thread's calls of mj_geomDistance meanwhile.

    The modules of the group's classes may have imported the function by its name.
    """
    pairs: list[tuple[int, int]] = []
    measure, own_thread = mujoco.mj_geomDistance, threading.get_ident()

    def listed(m: Any, d: Any, one: int, other: int, *rest: Any) -> float:
        if threading.get_ident() == own_thread:
            pairs.append((int(one), int(other)))
        return measure(m, d, one, other, *rest)

    modules = {sys.modules.get(kind.__module__) for kind in type(group).__mro__} | {mujoco}
    names = [
        (module, name)
        for module in modules
        if module is not None
        for name, value in vars(module).items()
        if value is measure
    ]
    try:
        for module, name in names:
            setattr(module, name, listed)
        yield pairs
    finally:
        for module, name in names:
            setattr(module, name, measure)


def _positions(given: dict[str, list[float]], groups: dict[str, Any]) -> dict[str, Any]:
    return {
        _name_of_group(name): np.asarray(values, dtype=np.float64)
        for name, values in given.items()
        if _name_of_group(name) in groups and len(values)
    }


def _warn_of_unused(robot_config: Any, view: RobotView, groups: dict[str, Any]) -> None:
    """Warns of fields that are set and have no effect in a run of robocell."""
    kind = type(robot_config).__name__
    for field in ("init_qpos_noise_range", "command_mode"):
        for name in getattr(robot_config, field) or {}:
            if name not in view.move_group_ids():
                warnings.warn(no_group(robot_config, field, name, view), stacklevel=4)
    for field in ("init_qpos", "init_qpos_noise_range"):
        for name, values in (getattr(robot_config, field) or {}).items():
            if name in view.move_group_ids() and len(values) and _name_of_group(name) not in groups:
                warnings.warn(
                    f"{kind}.{field}['{name}'] has no effect in robocell: each start places the "
                    "base, by the fields of the task sampler's configuration",
                    stacklevel=4,
                )
    noise = robot_config.action_noise_config
    if noise.enabled and noise != BaseRobotConfig().action_noise_config:
        warnings.warn(
            f"{kind}.action_noise_config has no effect on datasets of robocell: their actions have "
            "no noise unless the run file has `noise:`. Robot.update_control adds it",
            stacklevel=4,
        )


def _controls(robot_config: Any, groups: dict[str, Any]) -> dict[str, str]:
    controls = {}
    for name, mode in robot_config.command_mode.items():
        group = _name_of_group(name)
        if mode is None or group not in groups:
            continue
        if mode not in CONTROLS:
            raise rc.ArgumentError(
                f"{type(robot_config).__name__}.command_mode['{name}']: robocell has no "
                f"'{mode}'. It has: {', '.join(CONTROLS)}"
            )
        if groups[group]["kind"] == "arm" or mode != "joint_position":
            controls[group] = CONTROLS[mode]
    return controls
