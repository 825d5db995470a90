"""Cells of robocell as environments of LeRobot: `--env.type=robocell --env.task=DATASET`.

LeRobot imports this package because its name begins with lerobot_env_. Versions before 0.5 make the
environment through Gymnasium (`gym_id`, `gym_kwargs`), later ones through `create_envs`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any

import gymnasium
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig

from robocell.lerobot import ExportedEnv

GYM_ID = "lerobot_env_robocell/Cell-v0"


@EnvConfig.register_subclass("robocell")
@dataclass
class RobocellEnv(EnvConfig):  # type: ignore[misc]
    """The cell of a dataset.

    Attributes:
        task: Folder of the dataset that was exported.
        fps: Steps per second; 0 for those of the dataset.
        episode_length: Steps after which an episode is truncated.
        preset: The preset of the export.
        mapping: The mapping file of the export.
        actions: The actions of the export.
        cameras: The cameras of the export, separated by commas; None for all.
        imports: Modules or files to import first, separated by commas, which register the task or
            features: a dataset imports none.
        features: Observations and actions; found in the dataset.
        features_map: Their names in LeRobot datasets.
    """

    task: str | None = None
    fps: int = 0
    episode_length: int = 500
    preset: str | None = None
    mapping: str | None = None
    actions: str | None = None
    cameras: str | None = None
    imports: str | None = None
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.task:
            return  # LeRobot makes configurations without fields to describe them
        with_env = ExportedEnv(**self.of_cell)
        try:
            self._take_features(with_env)
        finally:
            with_env.close()

    def _take_features(self, env: ExportedEnv) -> None:
        self.fps = self.fps or env.metadata["render_fps"]
        if self.features:
            return
        self.features["action"] = _feature(FeatureType.ACTION, env.action_space)
        self.features_map["action"] = "action"
        spaces: Any = env.observation_space.spaces
        self.features["agent_pos"] = _feature(FeatureType.STATE, spaces["agent_pos"])
        self.features_map["agent_pos"] = "observation.state"
        for name, space in spaces["pixels"].spaces.items() if "pixels" in spaces else ():
            self.features[f"pixels/{name}"] = _feature(FeatureType.VISUAL, space)
            self.features_map[f"pixels/{name}"] = f"observation.images.{name}"

    @property
    def package_name(self) -> str:
        """The package to import before `gym_id` is made."""
        return "lerobot_env_robocell"

    @property
    def gym_id(self) -> str:
        """The environment's name in Gymnasium."""
        return GYM_ID

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """Arguments of Gymnasium's environment; Gymnasium would keep `max_episode_steps`."""
        return {"of_cell": self.of_cell}

    @property
    def of_cell(self) -> dict[str, Any]:
        """Arguments of `ExportedEnv`."""
        cameras = self.cameras
        return {
            "dataset": self.task,
            "preset": self.preset,
            "mapping": self.mapping,
            "actions": self.actions,
            "cameras": None if cameras is None else _listed(cameras),
            "imports": _listed(self.imports or ""),
            "max_episode_steps": self.episode_length,
        }

    def create_envs(
        self, n_envs: int = 1, use_async_envs: bool = False, **_: Any
    ) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
        """Returns {suite: {task: vector of environments}}: one suite with one task."""
        if not self.task:
            raise ValueError("--env.task is missing: the folder of the dataset that was exported")
        make = partial(ExportedEnv, **self.of_cell)
        vector = (
            gymnasium.vector.AsyncVectorEnv if use_async_envs else gymnasium.vector.SyncVectorEnv
        )
        mode = gymnasium.vector.AutoresetMode.SAME_STEP
        return {"robocell": {0: vector([make] * n_envs, autoreset_mode=mode)}}


def _listed(text: str) -> list[str]:
    return [each.strip() for each in text.split(",") if each.strip()]


def _feature(kind: FeatureType, space: Any) -> PolicyFeature:
    return PolicyFeature(type=kind, shape=tuple(space.shape))


def _make(of_cell: dict[str, Any], render_mode: str | None = None) -> ExportedEnv:
    """Makes the environment for Gymnasium; it always draws arrays."""
    return ExportedEnv(**of_cell)


if GYM_ID not in gymnasium.registry:
    # Without wrappers: LeRobot looks for `task` and `task_description` of what it is given.
    gymnasium.register(GYM_ID, entry_point=_make, disable_env_checker=True, order_enforce=False)
