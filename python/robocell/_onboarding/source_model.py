"""The model of a new robot file: a compiled MJCF or URDF whose elements all have names.

Elements without a name get the label that robot files call them by (`elbow:joint0`, `root_body`;
docs/robots.md, "Naming what is unnamed").
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from robocell import SpecError, _core

Vector = NDArray[np.float64]

SCALAR_JOINTS = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


@dataclass
class SourceModel:
    """A compiled model with its spec, and lookups over its tree of bodies.

    Attributes:
        path: The file, absolute.
        spec: Where it was compiled from; labelled.
        model: The compiled model.
        data: At the reference pose, with everything computed.
    """

    path: Path
    spec: Any
    model: Any
    data: Any
    _children: list[list[int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._children = [[] for _ in range(self.model.nbody)]
        for body in range(1, self.model.nbody):
            self._children[self.model.body_parentid[body]].append(body)

    # --- Names ---

    def body_name(self, body: int) -> str:
        """Returns the name or label of a body."""
        return str(self.model.body(body).name)

    def joint_name(self, joint: int) -> str:
        """Returns the name or label of a joint."""
        return str(self.model.joint(joint).name)

    def actuator_name(self, actuator: int) -> str:
        """Returns the name or label of an actuator."""
        return str(self.model.actuator(actuator).name)

    def site_name(self, site: int) -> str:
        """Returns the name or label of a site."""
        return str(self.model.site(site).name)

    # --- The tree ---

    def children(self, body: int) -> list[int]:
        """Returns the child bodies of a body."""
        return self._children[body]

    def subtree(self, body: int) -> list[int]:
        """Returns the body and all below it, parents first."""
        found = [body]
        for each in found:  # grows while it is walked through
            found.extend(self._children[each])
        return found

    def is_below(self, body: int, ancestor: int) -> bool:
        """Returns True if a body is the ancestor or below it."""
        while body != ancestor and body != 0:
            body = self.model.body_parentid[body]
        return body == ancestor

    def bodies_between(self, top: int, body: int) -> list[int]:
        """Returns the bodies between `top` (excluded) and `body`."""
        found: list[int] = []
        while body not in (top, 0):
            found.insert(0, body)
            body = int(self.model.body_parentid[body])
        return found

    def common_ancestor(self, first: int, second: int) -> int:
        """Returns the lowest common ancestor of both bodies."""
        while not self.is_below(second, first):
            first = int(self.model.body_parentid[first])
        return first

    def joints_of(self, body: int) -> list[int]:
        """Returns the joints of a body itself."""
        begin = int(self.model.body_jntadr[body])
        return list(range(begin, begin + int(self.model.body_jntnum[body]))) if begin >= 0 else []

    def joints_below(self, body: int) -> list[int]:
        """Returns the joints of a body and of all below it."""
        return [joint for each in self.subtree(body) for joint in self.joints_of(each)]

    def geoms_of(self, body: int) -> list[int]:
        """Returns the geoms of a body itself."""
        begin = int(self.model.body_geomadr[body])
        return list(range(begin, begin + int(self.model.body_geomnum[body]))) if begin >= 0 else []

    def collides(self, geom: int) -> bool:
        """Returns True if a geom can collide."""
        return bool(self.model.geom_contype[geom] or self.model.geom_conaffinity[geom])

    def rigid_with(self, body: int) -> list[int]:
        """Returns all bodies rigidly connected to this one."""
        weld = self.model.body_weldid[body]
        return [each for each in range(1, self.model.nbody) if self.model.body_weldid[each] == weld]

    # --- Joints ---

    def is_scalar(self, joint: int) -> bool:
        """Returns True for a hinge or a slide."""
        return int(self.model.jnt_type[joint]) in SCALAR_JOINTS

    def is_slide(self, joint: int) -> bool:
        """Returns True for a slide."""
        return int(self.model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE)

    def limits(self, joint: int) -> tuple[float, float] | None:
        """Returns lower and upper limit; None for an unlimited joint."""
        if not self.model.jnt_limited[joint]:
            return None
        lower, upper = self.model.jnt_range[joint]
        return float(lower), float(upper)

    def joint_of_dof(self, dof: int) -> int:
        """Returns the joint of a degree of freedom."""
        return int(self.model.dof_jntid[dof])

    # --- Geometry at a state ---

    def new_data(self, qpos: Vector | None = None) -> Any:
        """Returns a new state, at the reference pose or at joint positions."""
        data = mujoco.MjData(self.model)
        if qpos is not None:
            data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        return data

    def extent_below(self, body: int) -> float:
        """Returns the extent of a subtree from its origin at the reference pose, m."""
        origin = self.data.xpos[body]
        most = 0.0
        for each in self.subtree(body):
            most = max(most, float(np.linalg.norm(self.data.xpos[each] - origin)))
            for geom in self.geoms_of(each):
                if self.model.geom_rbound[geom] <= 0:
                    continue  # a plane
                distance = np.linalg.norm(self.data.geom_xpos[geom] - origin)
                most = max(most, float(distance))
        return most


def load_model(path: Path) -> SourceModel:
    """Compiles a model file. Raises SpecError with the problem and the next step."""
    try:
        spec = _urdf(path) if _root_element(path) == "robot" else mujoco.MjSpec.from_file(str(path))
        _label(spec)
        model = spec.compile()
    except SpecError:
        raise
    except (ValueError, OSError) as error:
        raise SpecError(_unreadable(path, str(error))) from error
    if model.nbody < 2:
        raise SpecError(
            f"{path}: the model has no bodies. Give the file whose <worldbody> has the robot; "
            "files with defaults or assets only are included by that one"
        )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return SourceModel(path.absolute(), spec, model, data)


def _urdf(path: Path) -> Any:
    """Reads a URDF like robot files do: with servos, fixed links and joints that follow others."""
    folder = str(path.absolute().parent)
    text, _ = _core.urdf_to_mjcf(str(path), folder)
    spec = mujoco.MjSpec.from_string(text)
    spec.modelfiledir = folder
    return spec


def _root_element(path: Path) -> str:
    """Returns the name of the file's first element: 'mujoco', 'robot'."""
    try:
        for _, element in ElementTree.iterparse(path, events=("start",)):
            return str(element.tag)
    except ElementTree.ParseError as error:
        text = f"{path}: not an XML file: {error}. Give an MJCF or a URDF"
        raise SpecError(_core.advice_about_pointers(str(path)) or text) from error
    return ""


def _unreadable(path: Path, reason: str) -> str:
    if pointers := _core.advice_about_pointers(str(path)):
        return pointers
    text = f"{path}: MuJoCo cannot read it: {reason.strip()}"
    if "Error opening file" in reason:
        text += ". Put the missing file where the model expects it"
    elif _root_element(path) not in ("mujoco", "robot"):
        text += ". A model file begins with <mujoco> or <robot>; others are included by one"
    return text


def _label(spec: Any) -> None:
    """Gives every body, joint, site and actuator without a name the label of robot files."""
    taken = {
        kind: {element.name for element in elements}
        for kind, elements in (
            ("body", spec.bodies),
            ("joint", spec.joints),
            ("site", spec.sites),
            ("actuator", spec.actuators),
        )
    }

    def name(element: Any, kind: str, label: str) -> None:
        if element.name:
            return
        while label in taken[kind]:
            label += "_"
        taken[kind].add(label)
        element.name = label

    for index, root in enumerate(_direct(spec.worldbody, "bodies")):
        name(root, "body", f"root_body{index or ''}")
    for body in _bodies_in_order(spec.worldbody):
        for kind, elements in (
            ("joint", body.joints),
            ("site", body.sites),
            ("body", _direct(body, "bodies")),
        ):
            for index, element in enumerate(elements):
                name(element, kind, f"{body.name}:{kind}{index}")
    seen: Counter[str] = Counter()
    for actuator in spec.actuators:
        target = actuator.target
        name(actuator, "actuator", f"{target}:actuator{seen[target]}")
        seen[target] += 1


def _direct(body: Any, kind: str) -> list[Any]:
    return list(getattr(body, kind))


def _bodies_in_order(body: Any) -> Iterator[Any]:
    yield body
    for child in _direct(body, "bodies"):
        yield from _bodies_in_order(child)
