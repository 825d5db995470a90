"""Edits that `robocell check` advises are copied into the robot file as they stand, and help."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import robocell as rc
from robocell.diagnose import Severity, check_robot

ARM = """<mujoco><compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size=".02" pos="0 0 -.5"/><body name="upper"><joint name="hip" axis="0 1 0" range="-2 2"
{hip}/>
<geom type="capsule" size=".02" fromto=".02 0 0 .28 0 0" mass="1"/>
<body name="fore" pos=".3 0 0"><joint name="knee" axis="0 1 0" range="-2 2" {knee}/>
<geom type="capsule" size=".02" fromto=".02 0 0 .18 0 0" mass="{mass}"/>
<site name="tip" pos=".2 0 0"/></body></body></body></worldbody>
<actuator><position name="servo1" joint="hip" {servo1}/><position name="servo2" joint="knee"
{servo2}/>
</actuator></mujoco>"""
GOOD = {
    "hip": "",
    "knee": "",
    "mass": ".5",
    "servo1": "kp='2000' kv='100'",
    "servo2": "kp='1000' kv='50'",
}
# Each fault of the arm has its changed values and a part of the finding.
FAULTS = {
    "too soft": ({"servo1": "kp='40' kv='4'"}, "servo's stiffness is 40"),
    "undamped": ({"servo1": "kp='500'"}, "nothing damps it"),
    "viscous": ({"knee": "damping='1e12'"}, "its damping of 1e+12 is too large"),
    "heavy": ({"knee": "armature='1e9'"}, "its armature of 1e+09 is too large"),
    "sluggish": ({"servo2": "kp='1000' kv='1e7'"}, "the kv of its servo 'servo2'"),
    "sticky": (
        {"knee": "frictionloss='20'", "servo2": "kp='1000' kv='1500'"},
        "frictionloss of 20 is more than its servo",
    ),
    "oscillating": (
        {"mass": ".02", "servo2": "kp='5000' kv='50' forcerange='-2 2'"},
        "joint 'knee' oscillates",
    ),
}
# Those that show when gravity acts.
WEIGH = ("too soft", "oscillating")
EDITS = re.compile(r"edits: \[((?:\{[^}]*\}(?:, )?)+)\]")


def robot_of(folder: Path, text: str, edits: str = "", *, floats: bool = True) -> rc.Robot:
    """Loads the robot beside another one, so that its elements have a prefix in the scene."""
    (folder / "arm.xml").write_text(text)
    file = folder / "arm.yaml"
    file.write_text(
        f"name: arm\nmodel: arm.xml\ngravcomp: {'true' if floats else 'false'}\n{edits}"
        "move_groups:\n  arm: {kind: arm, joints: [hip, knee], leaf: {site: tip}}\n"
    )
    spec = rc.SceneSpec(name="check", timestep=0.002, add_floor=False, add_skybox=False)
    config = rc.RobotConfig.load(file)
    spec.robots.append(rc.RobotSpec(name="left", prefix="left_", config=config))
    return rc.Robot.of(rc.Scene.build(spec), "left")


def texts(robot: rc.Robot) -> Iterator[str]:
    """Yields warnings and, as they name edits too, notes."""
    for finding in check_robot(robot):
        if finding.severity is Severity.WARNING:
            yield finding.text
    yield from robot.scene.warnings


@pytest.mark.parametrize("fault", FAULTS)
def test_an_advised_edit_loads_and_helps(tmp_path: Path, fault: str):
    values, said = FAULTS[fault]
    text = ARM.format(**{**GOOD, **values})
    edits: list[str] = []
    for _ in range(3):  # an edit may show what else is wrong
        fields = f"edits: [{', '.join(edits)}]\n"
        found = list(texts(robot_of(tmp_path, text, fields, floats=fault not in WEIGH)))
        about = [each for each in found if said in each]
        if not edits:
            assert about, found
        if not about:
            break
        assert "left_" not in "".join(about)
        (listed,) = EDITS.findall(about[0])[:1]
        edits += [each for each in re.findall(r"\{[^}]*\}", listed) if each not in edits]
    assert not about, (edits, about)


def test_a_sound_arm_needs_none(tmp_path: Path):
    assert list(texts(robot_of(tmp_path, ARM.format(**GOOD)))) == []
