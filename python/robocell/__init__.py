"""robocell: robot cells in MuJoCo, from scene to dataset.

At the top are the everyday names. Everything is in a module of its topic:

    robots      robots, grippers and how they are attached    envs        environments
    scene       scenes: compiling, stepping, editing          tasks       tasks, experts, samplers
    kinematics  poses, chains, inverse kinematics             features    columns of your own
    control     controllers, commands, smooth motions         generate    runs and their plans
    render      cameras, pictures, videos                     data        datasets
    scenes      where runs take place, sources of your own    log         messages
    diagnose    checks, trials, advice
    models      built-in robots, objects and scenes           menagerie   MuJoCo Menagerie's robots

They are there after `import robocell`. Modules that need packages of an extra are imported by
name: `robocell.gym`, `robocell.sb3`, `robocell.lerobot`, `robocell.compat`.

Importing it does no work: no file is read, nothing is drawn, the package mujoco is imported by the
first scene.
"""

from typing import NoReturn

from robocell import _startup as _startup  # first: Ctrl-C and the path of the command

# isort: split
from robocell import _build_tree as _build_tree  # the extension of a checkout
from robocell import _notebook as _notebook  # how objects show themselves in notebooks
from robocell import (
    control,
    data,
    diagnose,
    envs,
    features,
    generate,
    kinematics,
    log,
    menagerie,
    models,
    render,
    robots,
    scene,
    scenes,
    tasks,
)
from robocell._cmake import cmake_dir
from robocell._core import (
    ArgumentError,
    AttachmentSpec,
    ClosedError,
    ControlMode,
    Dataset,
    DivergedError,
    EngineError,
    Env,
    EnvConfig,
    Error,
    IoError,
    NotFoundError,
    Pose,
    RelativeTo,
    Robot,
    RobotConfig,
    RobotSpec,
    RunConfig,
    Scene,
    SceneObject,
    SceneSpec,
    Shape,
    SpecError,
    VideoRecorder,
    __mujoco_version__,
    __version__,
)
from robocell._elsewhere import add_hints, no_such, not_at_the_top
from robocell.features import register_feature
from robocell.tasks import (
    register_expert,
    register_sampler,
    register_scene_source,
    register_task,
)

__all__ = [
    "ArgumentError",
    "AttachmentSpec",
    "ClosedError",
    "ControlMode",
    "Dataset",
    "DivergedError",
    "EngineError",
    "Env",
    "EnvConfig",
    "Error",
    "IoError",
    "NotFoundError",
    "Pose",
    "RelativeTo",
    "Robot",
    "RobotConfig",
    "RobotSpec",
    "RunConfig",
    "Scene",
    "SceneObject",
    "SceneSpec",
    "Shape",
    "SpecError",
    "VideoRecorder",
    "__mujoco_version__",
    "__version__",
    "cmake_dir",
    "control",
    "data",
    "diagnose",
    "envs",
    "features",
    "generate",
    "kinematics",
    "log",
    "menagerie",
    "models",
    "register_expert",
    "register_feature",
    "register_sampler",
    "register_scene_source",
    "register_task",
    "render",
    "robots",
    "scene",
    "scenes",
    "tasks",
]


def __getattr__(name: str) -> NoReturn:
    """Says where a name is that is not at the top."""
    raise no_such(not_at_the_top(name), name)


add_hints()
