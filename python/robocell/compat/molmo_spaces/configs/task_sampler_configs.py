"""Configurations of the samplers of tasks: where tasks take place, and where the robot stands."""

from __future__ import annotations

import math

from robocell.compat.molmo_spaces.configs.abstract_config import Config

__all__ = ["PickTaskSamplerConfig"]


class PickTaskSamplerConfig(Config):
    """Picks in houses.

    Attributes:
        task_sampler_class: A subclass of PickTaskSampler. None: PickTaskSampler itself.
        dataset_name: Set of houses, looked for in ROBOCELL_SCENE_PATH; robocell's built-in houses
            where it is not there. "user": the files of `scene_xml_paths`.
        house_inds: Numbers of the houses. None: all.
        scene_xml_paths: MJCF files of your own scenes.
        house_variant: "ceiling" or "base".
        samples_per_house: Episodes in each house.
        max_tasks: Largest number of episodes in all.
        base_pose_sampling_radius_range: Horizontal distance of the base from the object, m.
        robot_object_z_offset: Height of the base's bottom above the object, m.
        robot_object_z_offset_random_min: Smallest random change of this height, m.
        robot_object_z_offset_random_max: Largest random change of this height, m.
        robot_safety_radius: Without effect: robocell uses the distance of the robot's geoms.
        robot_placement_rotation_range_rad: Largest angle by which the base is turned away from the
            object, rad.
        check_robot_placement_visibility: Respect the visibility constraints of the cameras.
        pickup_types: Kinds and categories of robocell's catalogue. None: its default kinds.
        grasp_libraries: Names of grasp libraries of yours. None: all that are registered.
        max_total_attempts_multiplier: Starts tried for each episode that is wanted.
    """

    task_sampler_class: type | None = None
    dataset_name: str = "procthor-10k"
    house_inds: list[int] | None = [0, 1, 2, 3]
    scene_xml_paths: list[str] | None = None
    house_variant: str = "ceiling"
    samples_per_house: int | None = 2
    max_tasks: float = math.inf
    base_pose_sampling_radius_range: tuple[float, float] = (0.0, 0.7)
    robot_object_z_offset: float = -0.75
    robot_object_z_offset_random_min: float = -0.30
    robot_object_z_offset_random_max: float = 0.25
    robot_safety_radius: float = 0.15
    robot_placement_rotation_range_rad: float = math.radians(45)
    check_robot_placement_visibility: bool = True
    pickup_types: list[str] | None = None
    grasp_libraries: list[str] | None = None
    max_total_attempts_multiplier: int = 6
    # Fields without an effect in robocell, so that configurations which set them are read.
    episodes_per_batch: int = 4
    task_batch_size: int = 1
    sim_settle_timesteps: int = 500
    verbose: bool = False
    randomize_lighting: bool = False
    randomize_textures: bool = False
    randomize_textures_all: bool = False
    randomize_robot_textures: bool = False
    randomize_dynamics: bool = False
    max_allowed_sequential_task_sampler_failures: int = 10
    max_allowed_sequential_rollout_failures: int = 10
    max_allowed_sequential_irrecoverable_failures: int = 5
    max_asset_failures: int = 10
    max_robot_placement_attempts: int = 10
    robot_placement_exclusion_threshold: float = 0.15
    objaverse_oversampling_factor: int = 30
    filter_for_grasps: bool = True
    referral_expression_clip_filter: bool = False
    added_pickup_objects: list[str] | None = None
    num_added_pickups: int = 30


WITHOUT_EFFECT = (
    "robot_safety_radius",
    "episodes_per_batch",
    "task_batch_size",
    "sim_settle_timesteps",
    "verbose",
    "randomize_lighting",
    "randomize_textures",
    "randomize_textures_all",
    "randomize_robot_textures",
    "randomize_dynamics",
    "max_allowed_sequential_task_sampler_failures",
    "max_allowed_sequential_rollout_failures",
    "max_allowed_sequential_irrecoverable_failures",
    "max_asset_failures",
    "max_robot_placement_attempts",
    "robot_placement_exclusion_threshold",
    "objaverse_oversampling_factor",
    "filter_for_grasps",
    "referral_expression_clip_filter",
    "added_pickup_objects",
    "num_added_pickups",
)
