"""Arms with few joints under the default actions of an environment, from the file of `init`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import init_models
import robocell as rc
from command_line import robocell_command

STEP = 0.005  # m
# Five times forwards and back along each axis: the arm stays near its home.
ACTIONS = [sign * STEP * np.eye(3)[axis] for axis in range(3) for sign in [1, -1] * 5]


@pytest.mark.parametrize("name", ["scara", "desktop_arm"])
def test_every_default_action_reaches_its_position(tmp_path: Path, name: str):
    (tmp_path / "arm.xml").write_text(getattr(init_models, name)())
    done = robocell_command("init", tmp_path / "arm.xml", "-o", tmp_path / "arm.yaml")
    assert done.returncode == 0, done.stdout + done.stderr
    config = rc.EnvConfig(control_mode="cartesian_trpy")
    config.robots["arm"] = rc.RobotConfig.load(tmp_path / "arm.yaml")
    env = rc.Env(config)
    env.reset(seed=0)
    robot = env.scene.robot("arm")
    assert len(ACTIONS) == 30
    for action in ACTIONS:
        before = robot.tcp_in_world.translation
        own: dict[str, object] = {"xyzrpy": [*action, 0, 0, 0]}
        if name == "desktop_arm":
            own["gripper"] = 1
        *_, info = env.step({"arm": own})
        assert info["reason"] in ("arrived", "settled")
        moved = robot.tcp_in_world.translation - before
        np.testing.assert_allclose(moved, action, atol=1.5e-3)
