"""A scene with nothing but one robot, for the commands that look at a robot file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from robocell import Robot, RobotConfig, RobotSpec, Scene, SceneSpec
from robocell.cli.common import require_spec_file

TIMESTEP_S = 0.002


@dataclass(frozen=True)
class RobotScene:
    """A robot file, and its robot standing at the world's origin, at home."""

    config: RobotConfig
    scene: Scene
    robot: Robot


def load_robot(path: Path) -> RobotScene:
    """Reads the file and builds the scene; robocell's errors name what is wrong."""
    require_spec_file(path, RobotConfig)
    config = RobotConfig.load(path)
    spec = SceneSpec(name=config.name, timestep=TIMESTEP_S, add_floor=True, add_skybox=True)
    spec.robots.append(RobotSpec(name=config.name, config=config))
    scene = Scene.build(spec)
    return RobotScene(config, scene, Robot.of(scene, config.name))
