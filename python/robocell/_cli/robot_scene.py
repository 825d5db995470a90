"""A scene with nothing but one robot, for the commands that look at a robot file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from robocell import Robot, RobotConfig, RobotSpec, Scene, SceneSpec
from robocell._cli.common import fail, require_spec_file
from robocell.robots import MoveGroupKind

TIMESTEP_S = 0.002


@dataclass(frozen=True)
class RobotScene:
    """A robot file, and its robot standing at the world's origin, at home."""

    config: RobotConfig
    scene: Scene
    robot: Robot

    @property
    def has_arm(self) -> bool:
        """False for a hand or a base alone."""
        return MoveGroupKind.ARM in _kinds(self.config)


def load_robot(path: Path, *, needs_arm: bool = True) -> RobotScene:
    """Reads the file and builds the scene; robocell's errors end the command.

    Without `needs_arm`, a hand or a base alone is enough: a gripper, or what drives the robot.
    """
    require_spec_file(path, RobotConfig)
    config = RobotConfig.load(path)
    others = set() if needs_arm else {MoveGroupKind.GRIPPER, MoveGroupKind.BASE}
    needed = {MoveGroupKind.ARM} | others
    if not needed & _kinds(config):
        _fail_without_arm(path, config)
    spec = SceneSpec(name=config.name, timestep=TIMESTEP_S, add_floor=True, add_skybox=True)
    spec.robots.append(
        RobotSpec(name=config.name, config=config, control_modes=config.used_modes())
    )
    scene = Scene.build(spec)
    return RobotScene(config, scene, Robot.of(scene, config.name))


def _kinds(config: RobotConfig) -> set[MoveGroupKind]:
    return {group.kind for group in config.move_groups.values()}


def _fail_without_arm(path: Path, config: RobotConfig) -> NoReturn:
    """Ends the command and lists the model's elements from which an arm can be declared."""
    fail(
        f"{path}: robot '{config.name}' has no arm group. Declare one, with the joints from "
        "its base to its tool:\n  move_groups:\n"
        "    arm: {kind: arm, joints: [FIRST, ..., LAST], leaf: {site: TOOL_CENTRE_POINT}}\n"
        f"{_elements(config)}"
    )


def _elements(config: RobotConfig) -> str:
    """Lists the names that a robot file refers to, as its file and attachments have them."""
    spec = SceneSpec(name=config.name, timestep=TIMESTEP_S, add_floor=False, add_skybox=False)
    spec.robots.append(
        RobotSpec(name=config.name, config=config, control_modes=config.used_modes())
    )
    scene = Scene.build(spec)
    prefix = scene.robot(config.name).prefix
    model = scene.model
    kinds = {
        "joints": [model.joint(i).name for i in range(model.njnt)],
        "actuators": [model.actuator(i).name for i in range(model.nu)],
        "sites": [model.site(i).name for i in range(model.nsite)],
        "bodies": [model.body(i).name for i in range(1, model.nbody)],
    }
    return "\n".join(
        f"Its {kind}: {', '.join(n.removeprefix(prefix) for n in names if n) or 'none'}"
        for kind, names in kinds.items()
    )
