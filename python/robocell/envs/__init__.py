"""Environments: a cell behind reset and step, many of them at once, and the cell of a dataset.

    env = robocell.Env(robocell.EnvConfig.load(robocell.models.cell_file("rc7")))
    observation, info = env.reset(seed=0)

    env = robocell.envs.from_dataset("out/picks", privileged=True)
    row, info = env.reset(seed=0)
    row["robots/rc7/arm/qpos"]  # as the dataset records it
    row, reward, terminated, truncated, info = env.step({"robots/rc7/action/arm": target})

Importing it loads neither numpy nor gymnasium, which `from_dataset` needs. `robocell.gym` registers
environments with Gymnasium. docs/environments.md describes them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from robocell._core import (
    CameraAdderConfig,
    ControlMode,
    Env,
    EnvBatch,
    EnvConfig,
    EnvObject,
    EnvState,
    ObjectVariation,
    OnCollision,
    RelativeTo,
    RunEnv,
    SimSettings,
    WrapperConfig,
    env_scene_spec,
)
from robocell._elsewhere import no_such, not_in
from robocell.envs._protocols import CellEnv, RecordedCellEnv

if TYPE_CHECKING:
    from robocell.envs._dataset_env import DatasetEnv, from_dataset

__all__ = [
    "CameraAdderConfig",
    "CellEnv",
    "ControlMode",
    "DatasetEnv",
    "Env",
    "EnvBatch",
    "EnvConfig",
    "EnvObject",
    "EnvState",
    "ObjectVariation",
    "OnCollision",
    "RecordedCellEnv",
    "RelativeTo",
    "RunEnv",
    "SimSettings",
    "WrapperConfig",
    "env_scene_spec",
    "from_dataset",
]


def __getattr__(name: str) -> Any:
    """Loads the names that need Gymnasium on first use."""
    if name not in ("DatasetEnv", "from_dataset"):
        raise no_such(not_in("robocell.envs", name, __all__), name)
    from robocell.envs import _dataset_env as dataset_env

    value = getattr(dataset_env, name)
    globals()[name] = value
    return value
