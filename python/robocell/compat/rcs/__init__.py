"""The names of RCS's page on scene configuration, for programs that were written for it.

    import robocell.compat.rcs as rcs
    from robocell.compat.rcs.envs.scenes import SimEnvCreatorConfig

A `SimEnvCreatorConfig` becomes an `rc.EnvConfig` (`to_env_config`), and `SimEnvCreator` makes a
`robocell.gym.GymEnv` of it. Nothing here simulates: there are names, defaults and which field
becomes which. What is different: docs/compat.md.
"""

from __future__ import annotations

from robocell.compat.rcs import camera, common, envs, sim
from robocell.compat.rcs.registries import (
    CAMERA_PATHS,
    DEFAULT_TRANSFORMS,
    GRIPPER_MOUNT_OFFSETS,
    GRIPPER_PATHS,
    GRIPPER_TCP_OFFSETS,
    HOME_POSITIONS,
    OBJECT_PATHS,
    SCENE_PATHS,
)

__all__ = [
    "CAMERA_PATHS",
    "DEFAULT_TRANSFORMS",
    "GRIPPER_MOUNT_OFFSETS",
    "GRIPPER_PATHS",
    "GRIPPER_TCP_OFFSETS",
    "HOME_POSITIONS",
    "OBJECT_PATHS",
    "SCENE_PATHS",
    "camera",
    "common",
    "envs",
    "sim",
]
