"""Scenes: content, and compiling, stepping, resetting and editing them.

    spec = robocell.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True)
    compiled = robocell.scene.compile_scene(spec)
    scene.reset(robocell.scene.ResetOptions(seed=1))

docs/scenes.md describes them.
"""

from robocell._core import (
    CompiledScene,
    Condim,
    Contact,
    ElementKind,
    ElementRef,
    FrictionCone,
    Integrator,
    ObjectRecord,
    ResetContext,
    ResetInfo,
    ResetOptions,
    RobotRecord,
    Scene,
    SceneObject,
    SceneSpec,
    Shape,
    SimOptions,
    Solver,
    SpecList,
    SpecMap,
    StepResult,
    compile_scene,
    scene_object_element_name,
)

__all__ = [
    "CompiledScene",
    "Condim",
    "Contact",
    "ElementKind",
    "ElementRef",
    "FrictionCone",
    "Integrator",
    "ObjectRecord",
    "ResetContext",
    "ResetInfo",
    "ResetOptions",
    "RobotRecord",
    "Scene",
    "SceneObject",
    "SceneSpec",
    "Shape",
    "SimOptions",
    "Solver",
    "SpecList",
    "SpecMap",
    "StepResult",
    "compile_scene",
    "scene_object_element_name",
]
