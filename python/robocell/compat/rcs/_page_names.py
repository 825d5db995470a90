"""Errors of robocell about a scene, with the page's names of the fields.

A configuration is checked when it is read. Errors about its models come from robocell, which uses
the field names of `rc.EnvConfig`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import robocell as rc

_ROBOT = r"\brobots\.([^\s.]+)\."
_GRIPPER = r"\bgrippers\.([^\s.]+)\."
# Robocell's place, a pattern, and the page's.
_PLACES = (
    (rf"{_ROBOT}move_groups\.arm\.", r"robot_cfgs.\1."),
    (rf"{_ROBOT}home\.arm\b", r"robot_cfgs.\1.q_home"),
    (rf"{_ROBOT}name\b", r"robot_cfgs.\1.robot_type"),
    (_ROBOT, r"robot_cfgs.\1."),
    (rf"{_GRIPPER}move_groups\.gripper\.fingers\b", r"gripper_cfgs.\1.collision_geoms_fingers"),
    (rf"{_GRIPPER}move_groups\.gripper\.actuators(\[0\])?", r"gripper_cfgs.\1.actuator"),
    (rf"{_GRIPPER}move_groups\.gripper\.", r"gripper_cfgs.\1."),
    (rf"{_GRIPPER}name\b", r"gripper_cfgs.\1.gripper_type"),
    (_GRIPPER, r"gripper_cfgs.\1."),
    (r"(robot '[^']*'(?: is not valid)?: )home\.arm:", r"\1q_home:"),
    (r"(robot '[^']*'(?: is not valid)?: )root_body:", r"\1base:"),
    (
        r"(robot '[^']*'(?: is not valid)?: )move_groups\.gripper\.ctrl:",
        r"\1min_actuator_width, max_actuator_width:",
    ),
    (
        r"(robot '[^']*'(?: is not valid)?: )move_groups\.gripper\.joint_range:",
        r"\1min_joint_width, max_joint_width:",
    ),
    (
        r"(robot '[^']*'(?: is not valid)?: )move_groups\.gripper\.fingers:",
        r"\1collision_geoms_fingers:",
    ),
    (r"(robot '[^']*'(?: is not valid)?: )move_groups\.(?:arm|gripper)\.", r"\1"),
    (r"(?<!Known )\brobots:(?= )", "robot_cfgs:"),
    (r"(?<!Known )\bgrippers:(?= )", "gripper_cfgs:"),
    (r"\bstream '([^']*)': its rate,", r"camera_cfgs.\1.frame_rate: its rate,"),
    (r"\bstream '([^']*)': (?=no (?:camera|object or body) )", r"camera_cfgs.\1.identifier: "),
    (r"\bstream '([^']*)' \(cameras\.streams\[\d+\]\)", r"camera_cfgs.\1"),
    (r"(camera_cfgs\.[^\s.:]+)\.(width|height)\b", r"\1.resolution_\2"),
    (r"(camera_cfgs\.[^\s.:]+)\.rate\b", r"\1.frame_rate"),
    (r"(camera_cfgs\.[^\s.:]+)\.(camera|follow)\b", r"\1.identifier"),
    (r"\bsim\.max_convergence_time\b", "sim_cfg.max_convergence_steps"),
    (r"\bsim\.(?=\w)", "sim_cfg."),
    (r"\bwrappers\.(?=\w)", "wrapper_cfg."),
    (r"\btask\.goal_tolerance\b", "task_cfg.goal_tolerance"),
    (r"\btask\.goal\b", "task_cfg.goal"),
)


@contextmanager
def page_names() -> Iterator[None]:
    """Raises robocell's errors with the page's names in their texts."""
    try:
        yield
    except rc.Error as error:
        text = str(error)
        for pattern, place in _PLACES:
            text = re.sub(pattern, place, text)
        if text == str(error):
            raise
        raise type(error)(text) from None
