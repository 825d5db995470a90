"""Robots in a model of their own: specs whose files are found anywhere, and compiled robots."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import mujoco

import robocell as rc
from robocell._suggestions import did_you_mean
from robocell.compat.molmo_spaces.robots.robot_views.abstract import RobotView

# Kinds of elements that have files, and the folder of the spec that their files are in.
_WITH_FILES = {
    "meshes": "meshdir",
    "hfields": "meshdir",
    "skins": "meshdir",
    "textures": "texturedir",
}


def load_spec(path: Path) -> mujoco.MjSpec:
    """Reads a model, to be attached to another one. Raises SpecError with the reason.

    The paths of its files become absolute. Its options become the engine's defaults: those of the
    other model hold, and MuJoCo would warn of each that differs.
    """
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (ValueError, mujoco.FatalError) as error:
        raise rc.SpecError(f"'{path}' cannot be read: {error}") from None
    for kind, folder_field in _WITH_FILES.items():
        folder = path.parent / (getattr(spec, folder_field) or "")
        for element in getattr(spec, kind):
            if element.file:
                element.file = str((folder / element.file).resolve())
            for i, file in enumerate(getattr(element, "cubefiles", ())):
                if file:
                    element.cubefiles[i] = str((folder / file).resolve())
    spec.meshdir = spec.texturedir = ""
    defaults = mujoco.MjSpec().option
    for name in dir(defaults):
        if not name.startswith("_") and not callable(getattr(defaults, name)):
            setattr(spec.option, name, getattr(defaults, name))
    return spec


def write_inertias(spec: mujoco.MjSpec) -> None:
    """Writes the mass and inertia that each body has in the compiled model into the spec."""
    model = spec.compile()
    for body in spec.bodies[1:]:
        of_model = model.body(body.id)
        if of_model.mass[0] > 0:
            body.explicitinertial = True
            body.mass, body.inertia = of_model.mass[0], of_model.inertia
            body.ipos, body.iquat = of_model.ipos, of_model.iquat
            body.fullinertia = [float("nan")] * 6


def without_meshes(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Deletes the geoms of meshes. Bodies keep their masses and inertias."""
    write_inertias(spec)
    for body in spec.bodies[1:]:
        for geom in list(body.geoms):
            if geom.type == mujoco.mjtGeom.mjGEOM_MESH:
                spec.delete(geom)
    return spec


def robot_alone(robot_config: Any, prefix: str, strip_meshes: bool = False) -> mujoco.MjSpec:
    """Returns a spec with nothing but the robot, at the origin, with its overrides."""
    robot_cls, _ = robot_config.require_classes()
    spec = mujoco.MjSpec()
    robot_cls.add_robot_to_scene(
        robot_config,
        spec,
        prefix=prefix,
        pos=[0.0, 0.0, 0.0],
        quat=[1.0, 0.0, 0.0, 0.0],
        strip_meshes=strip_meshes,
    )
    # Those of robocell's scenes.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10
    own = robot_config.model_copy(update={"robot_namespace": prefix})
    robot_cls.apply_control_overrides(spec, own)
    return spec


def compiled(spec: mujoco.MjSpec, name: str) -> mujoco.MjModel:
    """Compiles the spec of a robot. Raises SpecError with the engine's reason."""
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Attach")  # options that the empty model keeps
            return spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        raise rc.SpecError(f"robot '{name}' does not compile: {error}") from None


def compile_alone(
    robot_config: Any, prefix: str, strip_meshes: bool = False
) -> tuple[mujoco.MjModel, mujoco.MjData, RobotView]:
    """Compiles the robot alone, and returns model, data and view, at `init_qpos`.

    Raises SpecError with the engine's reason for a model that does not compile.
    """
    spec = robot_alone(robot_config, prefix, strip_meshes)
    model = compiled(spec, robot_config.name)
    data = mujoco.MjData(model)
    view = view_of(robot_config, data, prefix)
    set_init_qpos(robot_config, view)
    mujoco.mj_forward(model, data)
    return model, data, view


def set_init_qpos(robot_config: Any, view: RobotView) -> None:
    """Puts the groups where they begin. Raises NotFoundError for a group that the view lacks."""
    for name, positions in robot_config.init_qpos.items():
        if name not in view.move_group_ids():
            raise rc.NotFoundError(no_group(robot_config, "init_qpos", name, view))
        view.get_move_group(name).joint_pos = positions


def no_group(robot_config: Any, field: str, name: str, view: RobotView) -> str:
    """Returns the message about a group in a field of a configuration that the view lacks."""
    groups = view.move_group_ids()
    return (
        f"{type(robot_config).__name__}.{field}: robot view '{view.name}' has no move group "
        f"'{name}'.{did_you_mean(name, groups)} Its groups: {', '.join(groups)}"
    )


def view_of(robot_config: Any, data: mujoco.MjData, namespace: str) -> RobotView:
    """Makes the robot's view. A name that the model lacks raises NotFoundError with the class."""
    _, factory = robot_config.require_classes()
    try:
        return factory(data, namespace)
    except KeyError as error:
        raise rc.NotFoundError(
            f"{getattr(factory, '__name__', factory)} (robot '{robot_config.name}', namespace "
            f"'{namespace}'): {' '.join(str(part) for part in error.args)}"
        ) from error
