"""The pick task."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import robocell as rc
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.registries import OBJECT_PATHS


@dataclass(kw_only=True)
class PickTaskConfig:
    """An object that lies around its place in the root frame and is to be lifted.

    ``object_joint`` is accepted and unused: robocell finds the free joint of the object, and adds
    one to a model that has none.
    """

    robot_name: str = "robot"
    object_center_to_root_frame: rc.Pose = field(
        default_factory=lambda: Pose(translation=[0.5, 0, 0.05])
    )
    object_xml: str | os.PathLike[str] = OBJECT_PATHS["green_cube"]
    object_joint: str = "box_joint"
    prefix: str = "PickTask_"
    include_rotation: bool = True
    task_id: str = "pick"

    def add_to(self, config: rc.EnvConfig) -> None:
        """The object among those of the rig, free, and the task about it."""
        if self.task_id != "pick":
            raise rc.NotFoundError(f"task_cfg: no task '{self.task_id}'. Known tasks: pick")
        if self.robot_name not in config.robots:
            raise rc.NotFoundError(
                f"task_cfg.robot_name: no robot '{self.robot_name}'. Known robots: "
                f"{', '.join(config.robots)}"
            )
        name = self.prefix.rstrip("_")
        config.root_frame_objects[name] = rc.EnvObject(
            mjcf_path=str(self.object_xml), offset=self.object_center_to_root_frame, fixed=False
        )
        config.task = rc.EnvTaskConfig(object=name, rotate=self.include_rotation)
