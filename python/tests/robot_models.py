"""Ten kinds of robots, made up for tests of what `robocell init` writes for each."""

from __future__ import annotations

from collections.abc import Callable

import init_models
from init_models import (
    SIX_GAINS,
    finger_drive,
    model,
    servos,
    six_axis,
    two_fingers,
)


def gantry() -> str:
    """Three slides and a roll on a column, with a two-finger hand that points down."""
    hand = (
        "<body name='wrist' pos='0 0 -.1' quat='0 1 0 0'>"
        "<joint name='roll' axis='0 0 1' range='-3 3'/>"
        f"<geom type='cylinder' size='.03 .02' mass='.3'/>{two_fingers()}</body>"
    )
    world = (
        "<body name='column'><geom type='box' size='.06 .06 .3' pos='0 0 .3'/>"
        "<body name='bridge' pos='0 0 .63'><joint name='y' type='slide' axis='0 1 0' "
        "range='-.25 .25'/><geom type='box' size='.04 .3 .03' mass='4'/>"
        "<body name='boom' pos='0 0 .06'><joint name='x' type='slide' axis='1 0 0' "
        "range='0 .35'/><geom type='box' size='.2 .02 .02' pos='.1 0 0' mass='2'/>"
        "<body name='ram' pos='.33 0 0'><joint name='z' type='slide' axis='0 0 1' "
        "range='-.5 .1'/><geom type='box' size='.015 .015 .25' pos='0 0 .15' mass='1'/>"
        f"{hand}</body></body></body></body>"
    )
    gains = {"y": 20000.0, "x": 20000.0, "z": 20000.0, "roll": 200.0}
    rest = finger_drive() + f"<actuator>{servos(gains, '-3 3')}</actuator>"
    return model("gantry", world, rest)


def delta() -> str:
    """A delta-like arm: the hand stays level by joints that follow the shoulder.

    A turret on a lift carries two links that fold like scissors, elbow and wrist by equalities.
    """
    hand = two_fingers().replace("pos='0 0 .06'><geom", "pos='0 0 .04'><geom", 1)
    world = (
        "<body name='frame'><geom type='cylinder' size='.08 .05' pos='0 0 .05'/>"
        "<geom type='cylinder' size='.03 .3' pos='0 0 .35'/>"
        "<body name='slide' pos='0 0 .44'><joint name='lift' type='slide' axis='0 0 1' "
        "range='-.3 .2'/><geom type='cylinder' size='.05 .03' mass='2'/>"
        "<body name='turret'><joint name='turn' axis='0 0 1' range='-2.8 2.8'/>"
        "<geom type='cylinder' size='.06 .04' mass='2'/>"
        "<body name='upper'><joint name='shoulder' axis='0 1 0' range='-1.3 -.2'/>"
        "<geom type='capsule' fromto='0 0 0 .3 0 0' size='.025' mass='1'/>"
        "<body name='lower' pos='.3 0 0'><joint name='elbow' axis='0 1 0' range='.3 2.7'/>"
        "<geom type='capsule' fromto='0 0 0 .3 0 0' size='.02' mass='.6'/>"
        "<body name='platform' pos='.3 0 0'><joint name='level' axis='0 1 0' range='-1.4 -.1'/>"
        "<geom type='cylinder' size='.03 .01' mass='.2'/>"
        "<body name='wrist' pos='0 0 -.03' quat='0 1 0 0'>"
        "<joint name='roll' axis='0 0 1' range='-3 3'/>"
        f"<geom type='cylinder' size='.025 .02' mass='.2'/>{hand}"
        "</body></body></body></body></body></body></body>"
    )
    gains = {"lift": 20000.0, "turn": 3000.0, "shoulder": 3000.0, "roll": 200.0}
    level = (
        "<equality><joint joint1='elbow' joint2='shoulder' polycoef='0 -2 0 0 0'/>"
        "<joint joint1='level' joint2='shoulder' polycoef='0 1 0 0 0'/></equality>"
    )
    rest = level + finger_drive() + f"<actuator>{servos(gains, '-3 3')}</actuator>"
    return model("delta", world, rest)


def legged_arm() -> str:
    """A trunk on a free joint and four legs, with a six-axis arm and a hand on its back."""
    legs = "".join(
        f"<body name='{name}_hip' pos='{x} {y} 0'>"
        f"<joint name='{name}_swing' axis='0 1 0' range='-1 1' damping='5'/>"
        "<geom type='capsule' fromto='0 0 0 0 0 -.2' size='.03' mass='1'/>"
        f"<body name='{name}_shin' pos='0 0 -.2'>"
        f"<joint name='{name}_knee' axis='0 1 0' range='-1.5 1.5' damping='5'/>"
        "<geom type='capsule' fromto='0 0 0 0 0 -.2' size='.025' mass='.5'/>"
        f"<body name='{name}_foot' pos='0 0 -.2'>"
        f"<joint name='{name}_ankle' axis='0 1 0' range='-1 1' damping='5'/>"
        "<geom type='box' size='.06 .04 .02' mass='.3' contype='1' conaffinity='1'/>"
        "</body></body></body>"
        for name, x, y in (
            ("fl", ".3", ".2"), ("fr", ".3", "-.2"), ("bl", "-.3", ".2"), ("br", "-.3", "-.2"),
        )
    )  # fmt: skip
    world = (
        "<body name='trunk' pos='0 0 .42'><freejoint/>"
        f"<geom type='box' size='.4 .15 .06' mass='25'/>{legs}"
        f"{six_axis(two_fingers(), at='.2 0 .06')}</body>"
    )
    joints = {
        f"{leg}_{joint}": 2000.0
        for leg in ("fl", "fr", "bl", "br")
        for joint in ("swing", "knee", "ankle")
    }
    rest = finger_drive() + f"<actuator>{servos(SIX_GAINS)}{servos(joints, '-1 1')}</actuator>"
    return model("legs", world, rest)


def three_fingers(prefix: str = "") -> str:
    """Three fingers around a palm, each on a hinge that closes it towards the middle."""
    p = prefix
    fingers = "".join(
        f"<body name='{p}finger{index}' pos='{x} {y} .02' euler='0 0 {turn}'>"
        f"<joint name='{p}finger{index}' axis='0 -1 0' range='-.5 .6' damping='.3' "
        "armature='.005'/>"
        "<geom type='box' size='.006 .012 .04' pos='0 0 .04' mass='.05' contype='1' "
        "conaffinity='1'/></body>"
        for index, (x, y, turn) in enumerate(
            (("-.026", "0", "3.14159265"), (".022", ".025", "0"), (".022", "-.025", "0")), 1
        )
    )
    return (
        f"<body name='{p}hand' pos='0 0 .06'><geom type='cylinder' size='.05 .015' mass='.3'/>"
        f"{fingers}</body>"
    )


def three_finger_arm() -> str:
    """A six-axis arm with a three-finger hand, a servo on each finger."""
    drives = "".join(
        f"<position name='m_finger{index}' joint='finger{index}' kp='20' kv='1' "
        "ctrlrange='-.5 .6'/>"
        for index in (1, 2, 3)
    )
    rest = f"<actuator>{servos(SIX_GAINS)}{drives}</actuator>"
    return model("three", six_axis(three_fingers()), rest)


# Name, model, and the groups of kind arm and gripper that `init` finds.
TEN: dict[str, tuple[Callable[[], str], list[str], list[str]]] = {
    "scara": (init_models.scara, ["arm"], []),
    "gantry": (gantry, ["arm"], ["gripper"]),
    "delta": (delta, ["arm"], ["gripper"]),
    "suction": (init_models.suction_arm, ["arm"], ["gripper"]),
    "mobile": (init_models.mobile_arm, ["arm"], ["gripper"]),
    "torso": (
        init_models.torso,
        ["left_arm", "right_arm"],
        ["left_gripper", "right_gripper"],
    ),
    "three_fingers": (three_finger_arm, ["arm"], ["gripper"]),
    "floating": (init_models.hand_alone, [], ["gripper"]),
    "legged": (legged_arm, ["arm"], ["gripper"]),
    "desktop": (init_models.desktop_arm, ["arm"], ["gripper"]),
}


def parallel_links() -> str:
    """An arm of three hinges whose elbow a crank moves by a rod: a loop that `connect` closes."""
    return """
<mujoco model="loop"><compiler angle="radian"/><option timestep="0.002" integrator="implicitfast"/>
<default><joint damping="10" armature=".5"/><geom contype="0" conaffinity="0"/></default>
<worldbody><body name="base"><geom type="cylinder" size=".1 .1" pos="0 0 .1" mass="20"/>
<body name="column" pos="0 0 .25"><geom type="box" size=".05 .05 .05" mass="10"/>
 <body name="upper" pos="0 0 .1"><joint name="shoulder" axis="0 1 0" range="-.7 1.2"/>
  <geom type="capsule" fromto="0 0 .06 0 0 .34" size=".03" mass="4"/>
  <body name="fore" pos="0 0 .4"><joint name="elbow" axis="0 1 0" range="-.8 2.0"/>
   <geom type="capsule" fromto="0 0 .06 0 0 .34" size=".03" mass="3"/>
   <body name="flange" pos="0 0 .4"><joint name="wrist" axis="0 1 0" range="-3.1 3.1"/>
    <geom size=".03" mass=".5"/><site name="tcp" pos="0 0 .05"/></body></body></body>
 <body name="crank" pos="0 0 .1"><joint name="crank" axis="0 1 0" range="-2 3"/>
  <geom type="capsule" fromto="0 .05 0 -.1 .05 0" size=".012" mass=".5"/>
  <body name="rod" pos="-.1 0 0"><joint name="rod" axis="0 1 0" range="-3 3"/>
   <geom type="capsule" fromto="0 .05 0 0 .05 .4" size=".012" mass=".5"/></body></body>
</body></body></worldbody>
<equality><connect name='close' body1='rod' body2='fore' anchor='0 0 .4'/></equality>
<actuator><position name="a_shoulder" joint="shoulder" kp="6000" kv="600" ctrlrange="-.7 1.2"/>
<position name="a_crank" joint="crank" kp="6000" kv="600" ctrlrange="-2 3"/>
<position name="a_wrist" joint="wrist" kp="400" kv="40" ctrlrange="-3.1 3.1"/></actuator></mujoco>
"""
