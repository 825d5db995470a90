"""Tasks: picking, picking and placing, and those that users register with robocell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated

import robocell as rc
from robocell._suggestions import counted
from robocell.compat.rcs._fields import NamedFields
from robocell.compat.rcs._reading import Above, Path, outside
from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.registries import OBJECT_PATHS

__all__ = [
    "PICK_AND_PLACE",
    "BaseTaskConfig",
    "PickPlaceTaskConfig",
    "PickTaskConfig",
]

PICK_AND_PLACE = "pick_and_place"


@dataclass(kw_only=True)
class BaseTaskConfig(NamedFields):
    """A task by its name: one of ``rc.tasks.task_kinds()``, or RCS's ``pick_place``.

    A registered task of your own (``rc.register_task``) needs only this class; subclasses may also
    add to the environment in ``add_to``.
    """

    task_id: str

    def add_to(self, config: rc.EnvConfig) -> None:
        """The task; ``config`` is robocell's own, with all that the environment has besides."""
        self._check_task_id()
        config.task = {"kind": self.kind}

    @property
    def kind(self) -> str:
        """Returns robocell's kind of the task."""
        return PICK_AND_PLACE if self.task_id == "pick_place" else self.task_id

    def _check_task_id(self) -> None:
        kinds = rc.tasks.task_kinds()
        if self.kind not in kinds:
            raise rc.NotFoundError(
                f"task_cfg: no task '{self.task_id}'. Known tasks: {', '.join(kinds)}; your own "
                "are added by rc.register_task"
            )


@dataclass(kw_only=True)
class PickTaskConfig(BaseTaskConfig):
    """Lifts an object that lies at a given position in the root frame.

    It starts there at every reset; only its rotation is drawn, with ``include_rotation``. For
    random positions set ``spread`` of the task in ``to_env_config()``.

    With the ``task_id`` of a registered task, that task acts on the object.

    ``object_joint`` has no effect, and setting it gives a warning: robocell finds the free joint of
    the object, and adds one to a model that has none.
    """

    robot_name: str = "robot"
    object_center_to_root_frame: rc.Pose = field(
        default_factory=lambda: Pose(translation=[0.5, 0, 0.05])
    )
    object_xml: Path = OBJECT_PATHS["green_cube"]
    object_joint: str = "box_joint"
    prefix: str = "PickTask_"
    include_rotation: bool = True
    task_id: str = "pick"

    def add_to(self, config: rc.EnvConfig) -> None:
        """The object among those of the rig, free, and the task about it."""
        self._warn_of_unused(
            {
                "object_joint": "robocell finds the free joint of the object, and adds one to a "
                "model that has none"
            }
        )
        self._check_task_id()
        if self.robot_name not in config.robots:
            raise rc.NotFoundError(
                f"task_cfg.robot_name: no robot '{self.robot_name}'. Known robots: "
                f"{', '.join(config.robots)}"
            )
        name = self.prefix.rstrip("_")
        for taken in ("world_frame_objects", "root_frame_objects"):
            if name in getattr(config, taken):
                raise rc.ArgumentError(
                    f"{taken}.{name}: the object of task_cfg has this name, its prefix "
                    f"'{self.prefix}', and stands in the root frame; leave '{name}' out of "
                    f"{taken}, or give task_cfg another prefix"
                )
        config.root_frame_objects[name] = rc.envs.EnvObject(
            mjcf_path=str(self.object_xml), offset=self.object_center_to_root_frame, fixed=False
        )
        self._add_task(config, name)

    def _add_task(self, config: rc.EnvConfig, name: str) -> None:
        if self.kind == PICK_AND_PLACE:
            raise rc.ArgumentError(
                "task_cfg: pick_place needs the place of the object; PickPlaceTaskConfig has goal"
            )
        config.task = {"kind": self.kind}
        # A task of one's own may be about an object or not.
        for field_name, value in (("object", name), ("rotate", self.include_rotation)):
            if hasattr(config.task, field_name):
                setattr(config.task, field_name, value)


@dataclass(kw_only=True)
class PickPlaceTaskConfig(PickTaskConfig):
    """Picks up the object and puts it at ``goal``.

    ``goal``: final position of its root, metres, in the root frame, within ``goal_tolerance``; the
    default is for the green cube on the ground.
    """

    prefix: str = "PickPlaceTask_"
    task_id: str = "pick_place"
    goal: Sequence[float] = (0.5, 0.25, 0.02)
    goal_tolerance: Annotated[float, Above(0)] = 0.03

    def _check(self) -> None:
        if len(self.goal) != 3:
            raise outside(
                self._of("goal"), "three numbers, metres", counted(len(self.goal), "number")
            )

    def _add_task(self, config: rc.EnvConfig, name: str) -> None:
        config.task = rc.tasks.PickAndPlaceTaskConfig(
            object=name,
            rotate=self.include_rotation,
            goal=list(self.goal),
            goal_tolerance=self.goal_tolerance,
        )
