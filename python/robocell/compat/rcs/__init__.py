"""The names of RCS's page on scene configuration, for programs that were written for it.

    import robocell.compat.rcs as rcs
    from robocell.compat.rcs.envs.scenes import SimEnvCreatorConfig

A `SimEnvCreatorConfig` becomes an `rc.EnvConfig` (`to_env_config`), and `SimEnvCreator` makes a
`robocell.gym.GymEnv` of it. Nothing here simulates: there are names, defaults and which field
becomes which. What is different: docs/compat.md.
"""

from __future__ import annotations

from robocell.compat.rcs import camera, common, envs, registries, sim
from robocell.compat.rcs.registries import *  # noqa: F403  (their names stand there alone)

__all__ = ["camera", "common", "envs", "sim"]
__all__ += registries.__all__
