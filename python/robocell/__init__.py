"""robocell: robot cells in MuJoCo, from scene to dataset.

The everyday names are at the top: `Scene`, `SceneSpec`, `SceneObject`, `Shape`, `Robot`,
`RobotSpec`, `RobotConfig`, `Pose`, `Env`, `EnvConfig`, `RunConfig`, `Dataset`, `register_task`, and
the errors. All names are in modules by topic:

    robots      robots, grippers and how they are attached    envs        environments
    scene       scenes: compiling, stepping, editing          tasks       tasks, experts, samplers
    kinematics  poses, chains, inverse kinematics             features    your own columns
    control     controllers, commands, smooth motions         generate    runs and their plans
    render      cameras, pictures, videos                     data        datasets
    viewer      a window to look at scenes and act on them
    scenes      sources of scenes, your own too               policy      policies of your own
    models      built-in robots, objects and scenes           evaluate    success rates
    menagerie   MuJoCo Menagerie's robots                     diagnose    checks, trials, advice
    log         messages                                      motion      collision-free motions
    hardware    real arms and their twins

They are there after `import robocell`. Modules that need packages of an extra are imported by
name: `robocell.gym`, `robocell.sb3`, `robocell.lerobot`, `robocell.export`,
`robocell.policy_server`, `robocell.teleop`, `robocell.identify`,
`robocell.compat`.

Importing it does no work: no file is read, nothing is drawn, the package mujoco is imported by the
first scene.
"""

import importlib
from types import ModuleType
from typing import TYPE_CHECKING

from robocell import _startup as _startup  # first: Ctrl-C and the path of the command

# isort: split
from robocell import _build_tree as _build_tree  # the extension of a checkout
from robocell import _notebook as _notebook  # how objects show themselves in notebooks
from robocell import _pickling as _pickling  # pickles of any protocol
from robocell import (
    control,
    data,
    diagnose,
    envs,
    features,
    generate,
    hardware,
    kinematics,
    log,
    menagerie,
    models,
    motion,
    render,
    robots,
    scene,
    scenes,
    tasks,
    viewer,
)
from robocell._cmake import cmake_dir
from robocell._core import (
    ArgumentError,
    ClosedError,
    Dataset,
    DivergedError,
    EngineError,
    Env,
    EnvConfig,
    Error,
    IoError,
    NotFoundError,
    Pose,
    Robot,
    RobotConfig,
    RobotSpec,
    RunConfig,
    Scene,
    SceneObject,
    SceneSpec,
    Shape,
    SpecError,
    __mujoco_version__,
    __version__,
)
from robocell._elsewhere import ON_FIRST_USE, add_hints, no_such, not_at_the_top
from robocell._notebook import show
from robocell.tasks import register_task

__all__ = [
    "ArgumentError",
    "ClosedError",
    "Dataset",
    "DivergedError",
    "EngineError",
    "Env",
    "EnvConfig",
    "Error",
    "IoError",
    "NotFoundError",
    "Pose",
    "Robot",
    "RobotConfig",
    "RobotSpec",
    "RunConfig",
    "Scene",
    "SceneObject",
    "SceneSpec",
    "Shape",
    "SpecError",
    "__mujoco_version__",
    "__version__",
    "cmake_dir",
    "control",
    "data",
    "diagnose",
    "envs",
    "features",
    "generate",
    "hardware",
    "kinematics",
    "log",
    "menagerie",
    "models",
    "motion",
    "register_task",
    "render",
    "robots",
    "scene",
    "scenes",
    "show",
    "tasks",
    "viewer",
]


if TYPE_CHECKING:
    from robocell import evaluate as evaluate
    from robocell import policy as policy


def __getattr__(name: str) -> ModuleType:
    """Imports the topics that most programs do without; says where any other name is."""
    if name in ON_FIRST_USE:
        return importlib.import_module(f"robocell.{name}")
    raise no_such(not_at_the_top(name), name)


add_hints()
