"""Every code block of RCS's page on scene configuration runs as it is written."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
import robocell.compat.rcs as rcs
from compat_rcs_code import BLOCKS
from robocell.compat.rcs import DEFAULT_TRANSFORMS, OBJECT_PATHS, SCENE_PATHS
from robocell.compat.rcs.envs.base import ControlMode
from robocell.compat.rcs.envs.scenes import CameraAdderConfig, SimEnvCreator, SimEnvCreatorConfig
from robocell.compat.rcs.sim import SimCameraConfig, SimConfig, SimGripperConfig, SimRobotConfig

PAGE = Path(__file__).resolve().parents[3] / "shared/reference/seeds/sim-scene-configuration.txt"
SMALL = {"resolution_width": 32, "resolution_height": 24}


@pytest.fixture
def names() -> dict[str, Any]:
    """What the page's code expects to be there: its imports, and two arms and cameras."""
    from menagerie import require_menagerie

    require_menagerie("franka_fr3", "franka_emika_panda")
    return {
        "CameraAdderConfig": CameraAdderConfig,
        "ControlMode": ControlMode,
        "DEFAULT_TRANSFORMS": DEFAULT_TRANSFORMS,
        "OBJECT_PATHS": OBJECT_PATHS,
        "SCENE_PATHS": SCENE_PATHS,
        "SimConfig": SimConfig,
        "SimEnvCreatorConfig": SimEnvCreatorConfig,
        "np": np,
        "rcs": rcs,
        "robot_cfg": SimRobotConfig(),
        "robot_cfg_left": SimRobotConfig(),
        "robot_cfg_right": SimRobotConfig(),
        "gripper_cfg": SimGripperConfig(),
        "bird_eye_cfg": SimCameraConfig("bird_eye", 30, **SMALL),
        "wrist_cfg": SimCameraConfig("wrist", 30, **SMALL),
        "robot_name": "robot",
        "some_pose": rcs.common.Pose(translation=[0.06, 0, 0.05]),
    }


def run(names: dict[str, Any], *blocks: str) -> None:
    for block in blocks:
        exec(BLOCKS[block], names)


def test_the_minimal_scene_runs_as_printed(names: dict[str, Any]):
    run(names, "one arm", "placement", "minimal")
    assert names["robot2world"] == rc.Pose()
    names["cfg"].headless = True
    with pytest.warns(UserWarning, match="camera_adds has no camera"):
        env = SimEnvCreator()(names["cfg"])
    observation, _ = env.reset(seed=0)
    assert set(observation["frames"]) == {"bird_eye", "wrist"}
    env.close()


@pytest.mark.parametrize("camera", ["fixed camera", "wrist camera"])
def test_the_cameras_of_the_minimal_scene_run_as_printed(names: dict[str, Any], camera: str):
    run(names, "minimal", camera)
    names["cfg"].camera_adds = names["camera_adds"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = rc.Scene.build(SimEnvCreator().create_model(names["cfg"]))
    assert {"bird_eye", "wrist"} <= set(scene.camera_names())


def test_the_scene_of_two_arms_runs_as_printed(names: dict[str, Any]):
    run(names, "two arms", "world objects", "root objects", "robot objects")
    fields = (
        "robot_cfgs", "robot_to_shared_base_frame", "shared_base_frame_to_root_frame",
        "root_frame_to_world", "world_frame_objects", "root_frame_objects", "robot_frame_objects",
    )  # fmt: skip
    cfg = SimEnvCreatorConfig(
        sim_cfg=SimConfig(),
        control_mode=ControlMode.CARTESIAN_TQuat,
        **{field: names[field] for field in fields},
    )
    scene = rc.Scene.build(SimEnvCreator().create_model(cfg))
    cube = scene.body_pose("cube_green_cube").translation
    assert np.allclose(cube, [0.5, 0, 0.2])
    assert "left_d405_mount_robotiq_d405_mount" in scene.body_names()


def test_code_blocks_match_the_page():
    if not PAGE.is_file():
        pytest.skip(f"{PAGE} is not here")
    # The stored page has lost its line breaks.
    theirs = re.findall(r"```python\s(.*?)```", PAGE.read_text(), re.DOTALL)
    assert ["".join(code.split()) for code in theirs] == [
        "".join(code.split()) for code in BLOCKS.values()
    ]
