"""The configuration of an experiment: robot, cameras, task, rates and output."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import robocell as rc
from robocell.compat.molmo_spaces.configs.abstract_config import Config
from robocell.compat.molmo_spaces.configs.camera_configs import CameraSystemConfig
from robocell.compat.molmo_spaces.configs.robot_configs import BaseRobotConfig
from robocell.compat.molmo_spaces.configs.task_sampler_configs import PickTaskSamplerConfig

__all__ = ["MlSpacesExpConfig", "TaskConfig"]


class TaskConfig(Config):
    """The task of the present episode, which samplers fill in.

    Attributes:
        robot_base_pose: Pose of the base, xyz and wxyz.
        pickup_obj_name: Body of the object.
        pickup_obj_start_pose: Pose of the object at the beginning, xyz and wxyz.
        pickup_obj_goal_pose: Pose of the object 5 cm higher, xyz and wxyz.
    """

    robot_base_pose: list[float] | None = None
    pickup_obj_name: str | None = None
    pickup_obj_start_pose: list[float] | None = None
    pickup_obj_goal_pose: list[float] | None = None


class MlSpacesExpConfig(Config):
    """An experiment. Subclasses set `robot_config`, and may define `tag`.

    Attributes:
        robot_config: The robot.
        camera_config: The cameras.
        task_sampler_config: Where tasks take place.
        task_config: The task of the present episode.
        scene_dataset: Set of houses; `task_sampler_config.dataset_name` comes before it.
        data_split: "train", "val" or "test".
        output_dir: Folder of the dataset, below which the configuration's name is added.
        num_workers: Worker processes.
        seed: Seed of the run. None: 0; the same seed gives the same dataset.
        policy_dt_ms: Time per action, ms.
        ctrl_dt_ms: Time between two updates of the controllers, ms.
        sim_dt_ms: Time per step of the engine, ms.
        task_horizon: Largest number of actions.
        filter_for_successful_trajectories: Keep successes alone.
        task_type: "pick", the task that robocell generates.
    """

    robot_config: BaseRobotConfig
    camera_config: CameraSystemConfig = CameraSystemConfig()
    task_sampler_config: PickTaskSamplerConfig = PickTaskSamplerConfig()
    task_config: TaskConfig = TaskConfig()
    scene_dataset: str = "procthor-10k"
    data_split: str = "train"
    output_dir: Path = Path("experiment_output")
    num_workers: int = 1
    seed: int | None = None
    policy_dt_ms: float = 66.0
    ctrl_dt_ms: float = 2.0
    sim_dt_ms: float = 2.0
    task_horizon: int = 500
    filter_for_successful_trajectories: bool = True
    task_type: str = "pick"
    # Fields without an effect in robocell, so that configurations which set them are read.
    num_envs: int = 1
    use_passive_viewer: bool = False
    viewer_cam_dict: dict[str, Any] | None = None
    end_on_success: bool = False
    collision_free_pose_limit: int = 3
    profile: bool = False
    datagen_profiler: bool = True
    log_level: str = "info"
    use_wandb: bool = False
    wandb_project: str | None = None
    wandb_name: str | None = None
    environment_light_intensity: float = 15000

    @property
    def tag(self) -> str:
        """A name for the data, which the run's name is made of. Default: the class's name."""
        return type(self).__name__

    @property
    def fps(self) -> float:
        """Rows and frames per second."""
        return 1000 / self.policy_dt_ms

    def model_post_init(self, context: Any) -> None:
        """Raises ArgumentError for rates that do not divide each other."""
        super().model_post_init(context)
        for long, short in (("policy_dt_ms", "ctrl_dt_ms"), ("ctrl_dt_ms", "sim_dt_ms")):
            ratio = getattr(self, long) / getattr(self, short)
            if ratio < 1 or abs(ratio - round(ratio)) > 1e-9:
                raise rc.ArgumentError(
                    f"{type(self).__name__}.{long}: {getattr(self, long):g} ms is not a whole "
                    f"number of {short}, {getattr(self, short):g} ms"
                )


WITHOUT_EFFECT = (
    "num_envs",
    "use_passive_viewer",
    "viewer_cam_dict",
    "end_on_success",
    "collision_free_pose_limit",
    "profile",
    "datagen_profiler",
    "log_level",
    "use_wandb",
    "wandb_project",
    "wandb_name",
    "environment_light_intensity",
)
