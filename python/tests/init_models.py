"""Models of robots of many kinds, made up for tests of `robocell init`."""

from __future__ import annotations

HEAD = (
    "<mujoco model='{name}'><compiler angle='radian'/>"
    "<default><geom contype='0' conaffinity='0'/><joint damping='2' armature='.05'/></default>"
    "<worldbody>{world}</worldbody>{rest}</mujoco>"
)


def model(name: str, world: str, rest: str = "") -> str:
    """An MJCF."""
    return HEAD.format(name=name, world=world, rest=rest)


def servos(joints: dict[str, float], ranges: str = "-2.6 2.6") -> str:
    """A position servo on each joint, with its gain."""
    return "".join(
        f"<position name='m_{joint}' joint='{joint}' kp='{kp}' kv='{kp / 10}' "
        f"ctrlrange='{ranges}'/>"
        for joint, kp in joints.items()
    )


SIX_GAINS = {"j1": 2000.0, "j2": 2000.0, "j3": 1500.0, "j4": 500.0, "j5": 300.0, "j6": 200.0}


def six_axis(hand: str = "", prefix: str = "", at: str = "0 0 0") -> str:
    """An arm of six hinges, 1.08 m tall when stretched out, with a hand at its end."""
    p = prefix
    links = [
        ("l1", "0 0 .12", "j1", "0 0 1", "-2.6 2.6", "0 0 .15", ".05", 3),
        ("l2", "0 0 .15", "j2", "0 1 0", "-2 2", "0 0 .35", ".04", 3),
        ("l3", "0 0 .35", "j3", "0 1 0", "-2.6 2.6", "0 0 .2", ".035", 2),
        ("l4", "0 0 .2", "j4", "0 0 1", "-2.6 2.6", "0 0 .12", ".03", 1),
        ("l5", "0 0 .12", "j5", "0 1 0", "-2 2", "0 0 .08", ".03", 0.6),
        ("l6", "0 0 .08", "j6", "0 0 1", "-2.6 2.6", "0 0 .04", ".03", 0.3),
    ]
    text = f"<body name='{p}base' pos='{at}'><geom type='cylinder' size='.06 .06' pos='0 0 .06'/>"
    for body, pos, joint, axis, limits, to, radius, mass in links:
        text += (
            f"<body name='{p}{body}' pos='{pos}'><joint name='{p}{joint}' axis='{axis}' "
            f"range='{limits}'/><geom type='capsule' fromto='0 0 0 {to}' size='{radius}' "
            f"mass='{mass}'/>"
        )
    return text + f"<site name='{p}flange' pos='0 0 .06'/>{hand}" + "</body>" * 7


def two_fingers(prefix: str = "") -> str:
    """Two fingers on slides that move apart along y, from touching to 60 mm."""
    p = prefix
    fingers = "".join(
        f"<body name='{p}{name}' pos='0 {side}.011 .05'>"
        f"<joint name='{p}{name}' type='slide' axis='0 {side}1 0' range='0 .03' damping='5' "
        "armature='.1'/>"
        f"<geom type='box' size='.01 .01 .03' pos='0 0 .03' mass='.05' contype='1' "
        "conaffinity='1'/></body>"
        for name, side in (("left_finger", ""), ("right_finger", "-"))
    )
    return (
        f"<body name='{p}hand' pos='0 0 .06'><geom type='box' size='.03 .06 .02' mass='.2'/>"
        f"{fingers}</body>"
    )


def finger_drive(prefix: str = "") -> str:
    """One servo; the second finger follows by an equality."""
    p = prefix
    return (
        f"<equality><joint joint1='{p}right_finger' joint2='{p}left_finger'/></equality>"
        f"<actuator><position name='{p}grip' joint='{p}left_finger' kp='2000' kv='50' "
        "ctrlrange='0 .03'/></actuator>"
    )


def arm_with_hand() -> str:
    """A six-axis arm with a two-finger hand that one servo drives through an equality."""
    rest = finger_drive() + f"<actuator>{servos(SIX_GAINS)}</actuator>"
    return model("six", six_axis(two_fingers()), rest)


def arm_without_hand() -> str:
    """A six-axis arm with a flange."""
    return model("bare", six_axis(), f"<actuator>{servos(SIX_GAINS)}</actuator>")


def arm_of_motors_without_inertia() -> str:
    """A six-axis arm whose servos overshoot at their force limit in the last joints."""
    drives = servos(SIX_GAINS).replace("ctrlrange", "forcerange='-50 50' ctrlrange")
    text = model("light", six_axis(), f"<actuator>{drives}</actuator>")
    return text.replace("armature='.05'", "").replace(
        "<default>", "<option integrator='implicitfast'/><default>", 1
    )


def scara() -> str:
    """Two hinges, a slide and a hinge about upright axes; a site `tool` that looks down."""
    world = (
        "<body name='column'><geom type='cylinder' size='.06 .1' pos='0 0 .1'/>"
        "<body name='inner' pos='0 0 .2'><joint name='j1' axis='0 0 1' range='-2.5 2.5'/>"
        "<geom type='capsule' fromto='0 0 0 .25 0 0' size='.04' mass='2'/>"
        "<body name='outer' pos='.25 0 0'><joint name='j2' axis='0 0 1' range='-2.5 2.5'/>"
        "<geom type='capsule' fromto='0 0 0 .2 0 0' size='.03' mass='1'/>"
        "<body name='quill' pos='.2 0 0'>"
        "<joint name='j3' type='slide' axis='0 0 1' range='-.15 0'/>"
        "<geom type='capsule' fromto='0 0 -.1 0 0 .1' size='.015' mass='.3'/>"
        "<body name='spindle' pos='0 0 -.1'><joint name='j4' axis='0 0 1' range='-3 3'/>"
        "<geom type='box' size='.02 .02 .01' mass='.1'/>"
        "<site name='tool' pos='0 0 -.02' quat='0 1 0 0'/></body></body></body></body></body>"
    )
    gains = {"j1": 1000.0, "j2": 1000.0, "j3": 3000.0, "j4": 100.0}
    return model("scara", world, f"<actuator>{servos(gains, '-2.5 2.5')}</actuator>")


def desktop_arm() -> str:
    """Five hinges and a jaw that turns against the last link, with no names on geoms."""
    world = (
        "<body name='base'><geom type='box' size='.03 .03 .02' pos='0 0 .02'/>"
        "<body name='shoulder' pos='0 0 .05'><joint name='pan' axis='0 0 1' range='-1.9 1.9'/>"
        "<geom type='box' size='.02 .02 .02' mass='.1'/>"
        "<body name='upper' pos='0 0 .03'><joint name='lift' axis='0 1 0' range='-1.7 1.7'/>"
        "<geom type='capsule' fromto='0 0 0 0 0 .11' size='.015' mass='.1'/>"
        "<body name='lower' pos='0 0 .11'><joint name='elbow' axis='0 1 0' range='-1.7 1.7'/>"
        "<geom type='capsule' fromto='0 0 0 0 0 .11' size='.015' mass='.1'/>"
        "<body name='wrist' pos='0 0 .12'><joint name='flex' axis='0 1 0' range='-1.6 1.6'/>"
        "<geom type='box' size='.02 .015 .02' mass='.05'/>"
        "<body name='jaw_fixed' pos='0 0 .03'><joint name='roll' axis='0 0 1' range='-2.7 2.7'/>"
        "<geom type='box' size='.012 .004 .04' pos='0 -.012 .05' mass='.05' contype='1' "
        "conaffinity='1'/>"
        "<body name='jaw_moving' pos='0 .012 .02'><joint name='jaw' axis='1 0 0' "
        "range='-1.5 .22' damping='.2'/>"
        "<geom type='box' size='.012 .004 .035' pos='0 .002 .035' mass='.02' contype='1' "
        "conaffinity='1'/></body></body></body></body></body></body></body>"
    )
    gains = {"pan": 60.0, "lift": 60.0, "elbow": 50.0, "flex": 30.0, "roll": 20.0}
    jaw = "<position name='m_jaw' joint='jaw' kp='10' kv='.5' ctrlrange='-1.5 .22'/>"
    return model("desk", world, f"<actuator>{servos(gains)}{jaw}</actuator>")


def mobile_arm() -> str:
    """A car with x, y and yaw joints under a six-axis arm with a hand."""
    joints = (
        "<joint name='x' type='slide' axis='1 0 0'/><joint name='y' type='slide' axis='0 1 0'/>"
        "<joint name='yaw' axis='0 0 1'/>"
    )
    car = (
        f"<body name='car'>{joints}<geom type='box' size='.25 .2 .1' pos='0 0 .1' mass='30'/>"
        f"{six_axis(two_fingers(), at='0 0 .2')}</body>"
    )
    wheels = "".join(
        f"<position name='m_{joint}' joint='{joint}' kp='2000' kv='800'/>"
        for joint in ("x", "y", "yaw")
    )
    rest = finger_drive() + f"<actuator>{servos(SIX_GAINS)}{wheels}</actuator>"
    return model("mobile", car, rest)


def torso() -> str:
    """Two six-axis arms with hands on a waist that turns."""
    arms = "".join(
        six_axis(two_fingers(f"{side}_"), f"{side}_", f"0 {y} .2")
        for side, y in (("left", ".35"), ("right", "-.35"))
    )
    world = (
        "<body name='stand'><geom type='box' size='.1 .1 .2' pos='0 0 .2'/>"
        "<body name='chest' pos='0 0 .4'><joint name='waist' axis='0 0 1' range='-1.5 1.5'/>"
        f"<geom type='box' size='.1 .3 .1' pos='0 0 .1' mass='10'/>{arms}</body></body>"
    )
    gains = {f"{side}_{joint}": kp for side in ("left", "right") for joint, kp in SIX_GAINS.items()}
    rest = "".join(finger_drive(f"{side}_") for side in ("left", "right"))
    return model(
        "torso", world, rest + f"<actuator>{servos({'waist': 3000.0, **gains})}</actuator>"
    )


def two_arms_apart() -> str:
    """Two arms that stand beside each other in the world, with a table and a cube."""
    world = "".join(
        six_axis(two_fingers(f"{side}_"), f"{side}_", f"0 {y} 0")
        for side, y in (("left", ".4"), ("right", "-.4"))
    )
    world += (
        "<body name='table' pos='.6 0 0'><geom type='box' size='.2 .4 .1'/></body>"
        "<body name='cube' pos='.6 0 .13'><freejoint/><geom type='box' size='.02 .02 .02'/></body>"
    )
    gains = {f"{side}_{joint}": kp for side in ("left", "right") for joint, kp in SIX_GAINS.items()}
    rest = "".join(finger_drive(f"{side}_") for side in ("left", "right"))
    return model("pair", world, rest + f"<actuator>{servos(gains)}</actuator>")


def hand_alone() -> str:
    """A hand without an arm, floating."""
    world = two_fingers().replace(
        "<body name='hand' pos='0 0 .06'>", "<body name='hand' pos='0 0 .5'><freejoint/>"
    )
    return model("hand", world, finger_drive())


def cup(radius: float = 0.02, length: float = 0.06, at: float = 0.06, margin: float = 0.002) -> str:
    """The body of a suction cup along z."""
    return (
        f"<body name='cup' pos='0 0 {at}'><geom name='cup' type='cylinder' "
        f"size='{radius} {length / 2}' pos='0 0 {length / 2}' mass='.1' contype='1' "
        f"conaffinity='1' margin='{margin}' gap='{margin}'/>"
        f"<site name='tip' pos='0 0 {length}'/></body>"
    )


def suck(force: float = 40) -> str:
    """The actuator of the cup."""
    return f"<adhesion name='suck' body='cup' ctrlrange='0 1' gain='{force}'/>"


def suction_arm() -> str:
    """A six-axis arm with a cup that sticks."""
    drives = f"<actuator>{servos(SIX_GAINS)}{suck()}</actuator>"
    return model("cup", six_axis(cup()), drives)


def first_joint_at_the_root() -> str:
    """An arm whose first joint moves the model's topmost body."""
    text = six_axis(two_fingers())
    begin = text.index("<body name='l1'")
    return model(
        "rootless",
        text[begin:].removesuffix("</body>"),
        finger_drive() + f"<actuator>{servos(SIX_GAINS)}</actuator>",
    )


def without_servos() -> str:
    """An arm and a hand that no actuator moves."""
    follow = "<equality><joint joint1='right_finger' joint2='left_finger'/></equality>"
    return model("bare", six_axis(two_fingers()), follow)


def parallelogram() -> str:
    """An arm whose third joint follows the second."""
    follow = "<equality><joint joint1='j3' joint2='j2' polycoef='0 -1 0 0 0'/></equality>"
    return model("par", six_axis(), f"<actuator>{servos(SIX_GAINS)}</actuator>{follow}")


URDF = """<robot name="u4">
<link name="base_link"><collision><origin xyz="0 0 .06"/><geometry><cylinder radius=".06"
length=".12"/></geometry></collision></link>
{links}
<link name="tool0"/><joint name="fix" type="fixed"><parent link="l4"/><child link="tool0"/>
<origin xyz="0 0 .06"/></joint></robot>"""


def urdf() -> str:
    """An arm of four hinges with fixed links at both ends."""
    links, parent, at = "", "base_link", 0.12
    for number, axis in enumerate(("0 0 1", "0 1 0", "0 1 0", "0 0 1"), 1):
        name = f"l{number}"
        links += (
            f'<link name="{name}"><inertial><mass value="1"/><origin xyz="0 0 .1"/>'
            '<inertia ixx=".01" iyy=".01" izz=".005" ixy="0" ixz="0" iyz="0"/></inertial>'
            '<collision><origin xyz="0 0 .1"/><geometry><cylinder radius=".03" length=".14"/>'
            f'</geometry></collision></link><joint name="j{number}" type="revolute">'
            f'<parent link="{parent}"/><child link="{name}"/><origin xyz="0 0 {at}"/>'
            f'<axis xyz="{axis}"/><limit lower="-2" upper="2" effort="60" velocity="2"/></joint>'
        )
        parent, at = name, 0.2
    return URDF.format(links=links)


def linkage_hand() -> str:
    """A hand whose fingers have a link beside each that is nearer to the middle."""
    fingers = "".join(
        f"<body name='{name}' pos='0 {side}.011 .05'>"
        f"<joint name='{name}' type='slide' axis='0 {side}1 0' range='0 .03' damping='5' "
        "armature='.1'/>"
        f"<geom type='box' size='.01 .01 .03' pos='0 0 .03' mass='.05' contype='1' "
        "conaffinity='1'/></body>"
        f"<body name='{name}_link' pos='0 {side}.02 .02'>"
        f"<joint name='{name}_link' axis='1 0 0' range='-.6 .6' damping='.5'/>"
        f"<geom type='box' size='.005 .008 .01' pos='0 0 .02' mass='.02' contype='1' "
        "conaffinity='1'/></body>"
        for name, side in (("left", ""), ("right", "-"))
    )
    world = f"<body name='hand'><geom type='box' size='.03 .06 .01' mass='.2'/>{fingers}</body>"
    rest = (
        "<equality><joint joint1='right' joint2='left'/>"
        "<joint joint1='left_link' joint2='left' polycoef='0 -4 0 0 0'/>"
        "<joint joint1='right_link' joint2='left' polycoef='0 4 0 0 0'/></equality>"
        "<actuator><position name='grip' joint='left' kp='2000' kv='50' ctrlrange='0 .03'/>"
        "</actuator>"
    )
    return model("linkage", world, rest)
