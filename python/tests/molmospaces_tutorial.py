"""The project of MolmoSpaces' tutorial on custom robots: its four files and its robot.

`molmospaces_tutorial.txt` has the tutorial's code as it is printed, by file. What the page does not
print are the imports, here with robocell's package in place of the original's.
"""

from __future__ import annotations

import re
from pathlib import Path

CODE = Path(__file__).with_name("molmospaces_tutorial.txt")
PAGE = Path(__file__).resolve().parents[3] / "shared/reference/seeds/custom-robot-tutorial.txt"

VIEW_IMPORTS = """\
import mujoco
import numpy as np
from mujoco import MjData

from molmo_spaces.robots.robot_views.abstract import (
    GripperGroup,
    MJCFFrameMixin,
    MocapRobotBaseGroup,
    RobotView,
    SimplyActuatedMoveGroup,
)
from molmo_spaces.utils.mj_model_and_data_utils import body_pose


"""
ROBOT_IMPORTS = """\
from typing import TYPE_CHECKING, cast

from mujoco import MjData, MjSpec, mjtGeom

from molmo_spaces.controllers.abstract import Controller
from molmo_spaces.controllers.joint_pos import JointPosController
from molmo_spaces.controllers.joint_rel_pos import JointRelPosController
from molmo_spaces.env.sensors import TCPPoseSensor
from molmo_spaces.kinematics.mujoco_kinematics import MlSpacesKinematics
from molmo_spaces.kinematics.parallel.warp_kinematics import SimpleWarpKinematics
from molmo_spaces.robots.abstract import Robot

if TYPE_CHECKING:
    from molmo_spaces.configs.abstract_exp_config import MlSpacesExpConfig
    from xarm7_config import XArm7RobotConfig


"""
CONFIG_IMPORTS = """\
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mujoco import MjData

from molmo_spaces.configs.robot_configs import BaseRobotConfig
from molmo_spaces.robots.abstract import Robot
from molmo_spaces.robots.robot_views.abstract import RobotViewFactory
from xarm7 import XArm7Robot
from xarm7_view import XArm7RobotView


"""
DATAGEN_IMPORTS = """\
from pathlib import Path

from molmo_spaces.configs import PickTaskSamplerConfig
from molmo_spaces.configs.base_pick_config import PickBaseConfig
from molmo_spaces.configs.camera_configs import (
    AllCameraTypes,
    CameraSystemConfig,
    MjcfCameraConfig,
)
from molmo_spaces.data_generation.config_registry import register_config
from molmo_spaces.tasks.pick_task_sampler import PickTaskSampler
from xarm7_config import XArm7RobotConfig


"""
IMPORTS = {
    "xarm7_view.py": VIEW_IMPORTS,
    "xarm7_config.py": CONFIG_IMPORTS,
    "xarm7.py": ROBOT_IMPORTS,
    "xarm7_datagen.py": DATAGEN_IMPORTS,
}
# What the tutorial changes in its text: the range that it has measured, and the robot's model.
TO_MEASURE = 'raise NotImplementedError("We\'ll come back to this")'
MEASURED = "return 0.004, 0.089"
EDITS = (
    ('<body name="link_base" pos="0 0 .12"', '<body name="link_base" pos="0 0 0"'),
    ('<site name="link_tcp"', '<site name="link_tcp" xyaxes="-1 0 0 0 -1 0"'),
)
CAMERAS = {
    "link_base": '<camera name="exo_camera" pos="0.05 0.3 0.4" '
    'quat="0.353553 0.146447 -0.353553 -0.853553" fovy="71.0" />',
    "xarm_gripper_base_link": '<camera name="wrist_camera" pos="-0.07 0 0" '
    'quat="0.061628 0.704416 -0.704416 -0.061628" fovy="52.0" />',
}


def blocks() -> dict[str, str]:
    """Returns the tutorial's code by file."""
    parts = re.split(r"^### (\S+)\n", CODE.read_text(), flags=re.MULTILINE)[1:]
    return dict(zip(parts[::2], parts[1::2], strict=True))


def as_robocell(code: str) -> str:
    """Returns code with robocell's package name."""
    return re.sub(
        r"(?m)^(\s*(?:from|import) )molmo_spaces\b", r"\1robocell.compat.molmo_spaces", code
    )


def edited_model(text: str) -> str:
    """Returns the Menagerie's xArm7 as the tutorial edits it."""
    for before, after in EDITS:
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    for body, camera in CAMERAS.items():
        text, found = re.subn(rf'(<body name="{body}"[^>]*>)', rf"\1{camera}", text)
        assert found == 1, body
    return text


def write_project(folder: Path, menagerie: Path, measured: bool = True) -> Path:
    """Writes the tutorial's project into a folder, and returns the folder.

    Args:
        folder: The folder.
        menagerie: The robot's folder in the Menagerie, of which files are linked.
        measured: The finger range is the measured one, as at the tutorial's end.
    """
    for name, code in blocks().items():
        code = code.replace(TO_MEASURE, MEASURED) if measured else code
        (folder / name).write_text(as_robocell(IMPORTS[name]) + code)
    assets = folder / "assets" / "ufactory_xarm7"
    assets.mkdir(parents=True)
    (assets / "assets").symlink_to(menagerie / "assets")
    (assets / "xarm7.xml").write_text(edited_model((menagerie / "xarm7.xml").read_text()))
    return folder
