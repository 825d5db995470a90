"""`robocell check` and its neighbours: what is said of a robot's file and model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell
from command_line import (
    RC7,
    refused,
    robocell_command,
    set_in,
    write_robot,
    write_run,
)
from robocell._cli import reach_map
from robocell._cli.robot_scene import load_robot


def test_check_of_a_minimal_file_lists_the_elements_of_the_model(tmp_path: Path):
    path = tmp_path / "new.yaml"
    path.write_text(f"name: new\nmodel: {RC7.parent / 'rc7.xml'}\n")
    text = refused("check", path)
    assert "robot 'new' has no arm group" in text
    assert "move_groups" in text
    assert "Its joints: joint1, joint2" in text
    assert "Its sites: " in text
    assert "Robot::FromScene" not in text


@pytest.mark.parametrize(
    ("name", "controller"), [("cart", "unicycle"), ("mobile_base", "joint_position")]
)
def test_check_takes_a_base_without_an_arm(name: str, controller: str):
    result = robocell_command("check", RC7.parents[1] / name / f"{name}.yaml")
    assert result.returncode == 0, result.stderr
    text = result.stdout
    assert "no problems found" in text
    assert controller in text
    assert "pick" in text.split("note: ")[1]
    assert "navigate" not in text


def test_a_gripper_that_cannot_be_measured_hides_no_earlier_finding(tmp_path: Path):
    (tmp_path / "arm.xml").write_text("""<mujoco><worldbody><body name="base"><body name="hand">
        <joint name="roll" axis="0 0 1"/><geom name="palm" type="box" size="40 40 130" mass="1"/>
        <body name="jaw"><joint name="jaw" axis="0 1 0" range="-60 0"/>
        <geom type="box" size="5 5 30" mass="1"/></body></body></body></worldbody>
        <actuator><position joint="roll" kp="9"/>
        <position name="grip" joint="jaw" kp="9" ctrlrange="-1 0"/></actuator></mujoco>""")
    path = tmp_path / "arm.yaml"
    path.write_text("""name: arm
model: arm.xml
move_groups:
  arm: {kind: arm, joints: [roll], leaf: {body: hand}}
  gripper: {kind: gripper, joints: jaw, actuators: grip, fingers: [{body: hand}, {body: jaw}]}
""")
    text = refused("check", path)
    assert "geom 'palm' is 284 m large, and models are in metres. Is it in millimetres?" in text
    assert "'jaw' turns about a hinge in 'hand', and the two are nearest at the hinge" in text


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (set_in("move_groups", "arm", "joints", value="joint2..joint8"), "no joint 'joint8'"),
        (set_in("move_groups", "arm", "leaf", value={"body": "base_link"}), "nothing moves"),
        (set_in("model", value="menagerie:no_robot/no.xml"), "robocell fetch no_robot"),
        (set_in("base", "size", value=[0.2, 0.2]), "base.size: expected a list of 3 numbers"),
        (set_in("home", "arm", 0, value=float("nan")), "home.arm[0]: nan is not a finite number"),
    ],
)
def test_errors_in_a_robot_file_have_their_place(
    tmp_path: Path, change: Callable[[dict[str, Any]], object], told: str
):
    assert told in refused("check", write_robot(tmp_path, change))


def test_model_errors_name_the_line_of_the_robot_file(tmp_path: Path):
    path = write_robot(tmp_path, set_in("move_groups", "arm", "leaf", value={"site": "tpc"}))
    number = 1 + next(i for i, line in enumerate(path.read_text().splitlines()) if "tpc" in line)
    text = refused("check", path)
    assert f"{path}:{number}:" in text
    assert "robot 'rc7': move_groups.arm.leaf: no site 'tpc'. Its sites:" in text
    assert "scene" not in text


def test_a_missing_mesh_error_names_robot_and_model(tmp_path: Path):
    model = tmp_path / "arm.xml"
    model.write_text(
        '<mujoco><asset><mesh name="link" file="link.stl"/></asset><worldbody><body name="b">'
        '<geom type="mesh" mesh="link"/></body></worldbody></mujoco>'
    )
    path = tmp_path / "arm.yaml"
    path.write_text("name: arm\nmodel: arm.xml\n")
    text = refused("check", path)
    assert f"{path}:2:8: robot 'arm': {model} refers to the file 'link.stl' (mesh 'link'" in text
    assert f"there is no {tmp_path}/link.stl." in text
    assert "Get the model with all its files" in text


def test_rejects_a_picture_that_is_not_a_png_at_once(tmp_path: Path):
    text = refused("check", RC7, "--picture", tmp_path / "rc7.jpg")
    assert f"pictures are PNG files: give '{tmp_path}/rc7.png'" in text
    assert not list(tmp_path.iterdir())
    assert "there is no folder" in refused(
        "check", RC7, "--picture", tmp_path / "none" / "a.png", code=3
    )
    text = refused("check", RC7, "--picture", tmp_path)
    assert f"'{tmp_path}' is a folder; give the picture a name: '{tmp_path}/picture.png'" in text


def test_lights_of_a_model_are_only_a_note(tmp_path: Path):
    lit = tmp_path / "lit.xml"
    text = (RC7.parent / "rc7.xml").read_text()
    lit.write_text(text.replace("<worldbody>", '<worldbody><light name="lamp"/>', 1))
    result = robocell_command("check", write_robot(tmp_path, set_in("model", value=str(lit))))
    assert result.returncode == 0, result.stderr
    assert "note: robot 'rc7': only body 'base_link' of " in result.stdout
    assert "light 'lamp'; the scene has its own" in result.stdout
    assert "no problems found" in result.stdout
    assert result.stderr == ""


def test_reports_a_missing_gripper_and_lists_the_groups(tmp_path: Path):
    def remove_gripper(config: dict[str, Any]) -> None:
        for field in ("move_groups", "home", "control", "home_noise"):
            config[field].pop("gripper")

    path = write_robot(tmp_path, remove_gripper)
    assert "robot 'rc7' has no gripper. Its move groups: arm (arm)" in refused(
        "gripper-range", path
    )
    warnings = robocell_command("check", path).stderr
    assert "no move group has the actuators gripper: nothing will command them" in warnings


def write_torso(folder: Path, grippers: tuple[str, ...]) -> Path:
    """A torso with an arm of two joints and a gripper on each side."""

    def arm(side: str, y: float) -> str:
        fingers = "".join(
            f'<body name="{side}_f{i}" pos="0.2 {sign * 0.03} 0"><joint name="{side}_g{i}" '
            f'type="slide" axis="0 {-sign} 0" range="0 0.02" damping="2"/>'
            f'<geom name="{side}_p{i}" type="box" size="0.03 0.005 0.01" mass="0.05"/></body>'
            for i, sign in ((1, 1), (2, -1))
        )
        return (
            f'<body name="{side}_upper" pos="0 {y} 0.5"><joint name="{side}1" axis="0 0 1" '
            'range="-2 2" damping="1"/><geom size="0.04" mass="1"/>'
            f'<body name="{side}_lower" pos="0.2 0 0"><joint name="{side}2" axis="0 1 0" '
            'range="-2 2" damping="1"/><geom size="0.03" mass="0.5"/>'
            f'<site name="{side}_tcp" pos="0.22 0 0"/>{fingers}</body></body>'
        )

    servos = "".join(
        f'<position name="{s}{n}" joint="{s}{n}" kp="{kp}" kv="{kp / 10}" ctrlrange="{ends}"/>'
        for s in "lr"
        for n, kp, ends in (
            ("1", 300, "-2 2"), ("2", 300, "-2 2"), ("_g1", 200, "0 .02"), ("_g2", 200, "0 .02"),
        )
    )  # fmt: skip
    (folder / "torso.xml").write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="torso">'
        '<geom type="box" size="0.05 0.05 0.2" pos="0 0 0.2"/>'
        f"{arm('l', 0.3)}{arm('r', -0.3)}</body></worldbody><actuator>{servos}</actuator></mujoco>"
    )
    groups = {
        f"{s}_arm": f"{{kind: arm, joints: {s}1..{s}2, leaf: {{site: {s}_tcp}}}}" for s in "lr"
    }
    for side in grippers:
        pair = f"[{side}_g1, {side}_g2]"
        groups[f"{side}_hand"] = f"{{kind: gripper, joints: {pair}, actuators: {pair}}}"
    path = folder / "torso.yaml"
    path.write_text(
        "name: torso\nmodel: torso.xml\ngravcomp: true\nmove_groups:\n"
        + "".join(f"  {name}: {group}\n" for name, group in groups.items())
    )
    return path


@pytest.mark.parametrize("grippers", [("l", "r"), ("r", "l")])
def test_notes_which_of_several_arms_and_grippers_is_used(
    tmp_path: Path, grippers: tuple[str, str]
):
    path = write_torso(tmp_path, grippers)
    result = robocell_command("check", path)
    assert result.returncode == 0, result.stderr
    arms = "l_arm with l_hand, r_arm with r_hand"
    assert f"note: move_groups has 2 of kind arm: {arms}. Environments act" in result.stdout
    robot = load_robot(path).robot
    assert (robot.arm.name, robot.gripper.name) == ("l_arm", "l_hand")
    assert (robot.gripper_of("l_arm"), robot.gripper_of("r_arm")) == ("l_hand", "r_hand")
    assert "no problems found" in result.stdout


def test_notes_an_arm_without_gripper(tmp_path: Path):
    result = robocell_command("check", write_torso(tmp_path, ("r",)))
    assert result.returncode == 0, result.stderr
    assert "2 of kind arm: l_arm without a gripper, r_arm with r_hand." in result.stdout


@pytest.mark.parametrize("controller", ["joint_velocity", "joint_torque", "joint_impedance"])
def test_actuators_that_were_added_for_a_controller_are_not_idle(tmp_path: Path, controller: str):
    def choose(config: dict[str, Any]) -> None:
        config["control"]["arm"] = controller
        config["move_groups"].pop("gripper")
        for field in ("home", "control", "home_noise"):
            config[field].pop("gripper")

    loaded = load_robot(write_robot(tmp_path, choose))
    assert loaded.scene.model.nu == 7 + 1 + 7
    told = [str(found) for found in robocell.diagnose.check_robot(loaded.robot)]
    told = [text for text in told if "no move group" in text]
    assert len(told) == 1
    assert told[0].endswith("has the actuators gripper: nothing will command them")


def test_check_warns_about_valid_but_suspicious_values(tmp_path: Path):
    def spoil(config: dict[str, Any]) -> None:
        config.update(gravcomp=False, stiffness=20.0)

    result = robocell_command("check", write_robot(tmp_path, spoil))
    assert result.returncode == 0, result.stderr
    assert "drifts by" in result.stderr
    assert "gravcomp: true" in result.stderr
    assert "no problems found" not in result.stdout


SUCTION = """<mujoco><compiler angle="radian"/><worldbody><body name="base" mocap="false">
<geom size="0.05"/><body name="l" pos="0 0 0.1"><joint name="j" axis="0 1 0" range="-2 2"
damping="2"/><geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.3"/><body name="cup"
pos="0 0 0.32"><geom name="cup" size="0.01"/><site name="tip"/></body></body></body></worldbody>
<actuator><position name="m" joint="j" kp="500" kv="50"/><adhesion name="suck" body="cup"
ctrlrange="0 1" gain="40"/></actuator></mujoco>"""


def write_suction(folder: Path) -> Path:
    (folder / "bob.xml").write_text(SUCTION)
    robot = folder / "bob.yaml"
    robot.write_text(
        "name: bob\nmodel: bob.xml\nbase: {kind: mocap}\ngravcomp: true\nmove_groups:\n"
        "  arm: {kind: arm, joints: [j], leaf: {site: tip}}\n"
        "  cup: {kind: generic, actuators: [suck]}\n"
    )
    return robot


def test_check_and_runs_report_an_undriven_group_alike(tmp_path: Path):
    robot = write_suction(tmp_path)
    checked = robocell_command("check", robot)
    assert checked.returncode == 0, checked.stderr
    undriven = "move_groups.cup: 'suck' is "
    assert undriven in checked.stderr
    assert "moves no joint, so that there is no controller for it" in checked.stderr
    assert "SetActuatorCtrl" in checked.stderr
    assert "With `kind: gripper` it is a gripper that sticks" in checked.stderr
    # A suction cup is no arm.
    assert "joint_impedance" not in checked.stderr
    assert "no problems found" not in checked.stdout
    unfit = "has no gripper group"
    assert "note: no expert can use this robot: " in checked.stdout
    assert unfit in checked.stdout
    run = write_run(tmp_path, robot=str(robot))
    assert unfit in refused("generate", run)
    loaded = load_robot(robot)
    for kind in ("pick", "pick_and_place"):
        reasons = robocell.diagnose.why_not(loaded.robot, kind)
        assert len(reasons) == 1
        assert unfit in reasons[0]
    with pytest.raises(robocell.NotFoundError, match=r"no expert 'pik'.*Did you mean 'pick'"):
        robocell.diagnose.why_not(loaded.robot, "pik")
    config = robocell.RunConfig.load(run)
    config.cameras.streams = []  # which are of rc7's cameras
    robocell.diagnose.check_run(
        config, scripted_expert=False, on_this_machine=False
    )  # is recorded without


def test_check_and_runs_reject_a_wrong_finger_distance(tmp_path: Path):
    distance = {"closed": 0.0, "open": 0.9}
    robot = write_robot(tmp_path, set_in("move_groups", "gripper", "distance", value=distance))
    text = "move_groups.gripper.distance: the fingers are 0.002 m apart when closed and 0.090 m "
    assert text in refused("check", robot)
    run = write_run(tmp_path, robot=str(robot))
    for more in ([], ["--dry-run"]):
        assert f"robot.{text}" in refused("generate", run, *more)
    assert not (tmp_path / "out").exists()


@pytest.mark.proof
def test_runs_repeat_the_warnings_of_check_and_advise_on_reach(tmp_path: Path):
    robot = write_robot(tmp_path, set_in("force_limit", value=0.01))
    warned = "pushes with all it may, 0.01 N m"
    assert warned in robocell_command("check", robot).stderr
    changes = {
        "task": {"kind": "pick", "objects": ["box"]},
        "start": {
            "base_distance": [0.3, 0.5],
            "base_height_offset": 0.4,
            "base_height_noise": [0.0, 0.0],
        },
    }
    run = write_run(tmp_path, robot=str(robot), max_attempts=1, episodes_per_scene=1, **changes)
    result = robocell_command("generate", run)
    assert result.returncode == 1, result.stdout + result.stderr
    assert warned in result.stderr
    said = " ".join((result.stdout + result.stderr).split())
    assert "a grasp from above, pregrasp and lift included, is in reach with" in said
    assert "the run says 0.4, with noise 0 ... 0, and 0.3 ... 0.5" in said


@pytest.mark.parametrize("control", ["", "control: {arm: joint_position}\n"])
def test_check_and_runs_reject_an_arm_of_motors(tmp_path: Path, control: str):
    (tmp_path / "bob.xml").write_text(
        '<mujoco><worldbody><body name="base"><geom size="0.05"/><body name="link" pos="0 0 0.1">'
        '<joint name="hip" axis="0 1 0" range="-90 90"/><geom type="capsule" size="0.02" '
        'fromto="0 0 0 0 0 0.3"/><site name="tip" pos="0 0 0.3"/></body></body></worldbody>'
        '<actuator><motor name="drive" joint="hip"/></actuator></mujoco>'
    )
    robot = tmp_path / "bob.yaml"
    robot.write_text(
        "name: bob\nmodel: bob.xml\nmove_groups:\n"
        "  arm: {kind: arm, joints: [hip], actuators: [drive], leaf: {site: tip}}\n" + control
    )
    result = robocell_command("check", robot)
    assert result.returncode == 2
    why = (
        "drive' is a motor, no position servo: write `control: {arm: joint_impedance}` at the top "
        "level of the robot file, or joint_torque there to command torques, or give the model "
        "position servos"
    )
    assert why in result.stderr
    assert "robot 'bob' / group 'arm'" in result.stderr
    for hint in ("gravcomp", "stiffness"):
        assert hint not in result.stderr
    run = write_run(tmp_path, robot=str(robot))
    assert why in refused("generate", run)
    if not control:
        assert "none" in next(line for line in result.stdout.splitlines() if "drive" in line)


def test_reach_writes_numbers_a_picture_and_a_page(tmp_path: Path):
    name = tmp_path / "map"
    result = robocell_command(
        *("reach", RC7, "--plane", "z=0.3", "--cell", 0.2, "--rotations", 8, "-o", f"{name}.npz")
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert "cells of 0.2 m" in result.stdout
    with np.load(f"{name}.npz") as found:
        assert found["fraction"].shape == (len(found["x"]), len(found["y"]), 1)
        assert found["z"] == pytest.approx(0.3)
        assert 0.5 < found["fraction"].max() <= 1
        assert ((found["manipulability"] > 0) == (found["fraction"] > 0)).all()
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    page = (tmp_path / "map.html").read_text()
    assert "heatmap" in page
    assert "https://cdn" not in page.split("<body>")[0]


def test_reach_of_a_volume_is_drawn_in_slices_and_as_a_body(tmp_path: Path):
    robot = load_robot(RC7).robot
    lower, upper = reach_map.corners(robot, None)
    q = np.random.default_rng(0).uniform(*np.array(robot.joint_limits).T, (2000, 7))
    tips = robot.kinematics.fk(q)[:, :3, 3]
    assert (lower < tips).all()
    assert (tips < upper).all()
    found = robot.kinematics.reach_map(lower, upper, cell=0.4, rotations=4)
    assert [axis for axis, _, _ in reach_map.slices(found)] == [2, 1, 0]
    reach_map.draw(tmp_path / "map.png", "rc7", found)
    reach_map.write_page(tmp_path / "map.html", "rc7", found)
    assert (tmp_path / "map.png").stat().st_size > 10_000
    assert '"type":"volume"' in (tmp_path / "map.html").read_text()


SCARA = """<mujoco><worldbody><body name="base"><geom size=".05"/>
<body pos="0 0 .3"><joint name="a" axis="0 0 1" range="-170 170"/><geom size=".02" pos=".1 0 0"/>
<body pos=".3 0 0"><joint name="b" axis="0 0 1" range="-150 150"/><geom size=".02" pos=".1 0 0"/>
<body name="quill" pos=".2 0 0"><joint name="c" type="slide" axis="0 0 1" range="-.2 0"/>
<geom size=".01"/>
<site name="tip"/></body></body></body></body></worldbody><actuator>
<position joint="a"/><position joint="b"/><position joint="c"/></actuator></mujoco>"""


SCARA_YAML = """name: scara
model: scara.xml
move_groups: {arm: {kind: arm, joints: [a, b, c], leaf: {site: tip}}}
"""


@pytest.mark.proof
def test_reach_suggests_an_axis_or_positions_for_a_short_arm(tmp_path: Path):
    (tmp_path / "scara.xml").write_text(SCARA)
    (tmp_path / "scara.yaml").write_text(SCARA_YAML)
    ask = ("reach", tmp_path / "scara.yaml", "--plane", "z=0.2", "-o", tmp_path / "map")
    result = robocell_command(*ask)
    assert result.returncode == 0, result.stderr
    assert "with 3 joints scara reaches hardly any full rotation" in result.stderr
    assert "add --axis z (where the TCP's z axis points; or x, y) or --position-only" in (
        result.stderr
    )
    assert "reached: 0.0 % of the cells" in result.stdout
    assert "none of the rotations that were tried is reached there: --position-only maps" in (
        result.stderr
    )
    assert "nothing with" not in result.stderr
    result = robocell_command(*ask, "--position-only")
    assert "hardly" not in result.stderr
    with np.load(tmp_path / "map.npz") as found:
        x, y = np.meshgrid(found["x"], found["y"], indexing="ij")
        in_ring = (np.hypot(x, y) < 0.48) & (np.hypot(x, y) > 0.2) & (x > 0)
        assert (found["fraction"][in_ring] == 1).all()
        assert found["rotations"] == 1
    result = robocell_command(*ask, "--axis", "z")
    assert "hardly" not in result.stderr
    with np.load(tmp_path / "map.npz") as found:
        assert found["fraction"].max() < 0.1  # its z axis points up, and nowhere else
    far = robocell_command(
        "reach", tmp_path / "scara.yaml", "--plane", "y=9", "--position-only", cwd=tmp_path
    )
    assert "nothing with y = 9 m is reached; scara's TCP is never beyond x from" in far.stderr
    assert "--axis and --position-only exclude each other" in refused(
        *ask, "--axis", "z", "--position-only"
    )


def test_reach_rejects_invalid_arguments(tmp_path: Path):
    assert "give one of --plane AXIS=METRES (as --plane z=0.4) and --volume" in refused(
        "reach", RC7
    )
    assert "--plane 'q=1' is not a plane: write x, y" in refused("reach", RC7, "--plane", "q=1")
    nowhere = tmp_path / "no" / "map"
    text = refused("reach", RC7, "--volume", "-o", nowhere, code=3)
    assert f"there is no folder '{nowhere.parent}'" in text


@pytest.mark.parametrize("command", ["check", "generate"])
def test_rejects_a_model_file_instead_of_yaml(command: str):
    model = RC7.with_suffix(".xml")
    text = refused(command, model)
    assert f"{model}: this is XML, a model file; a YAML file is wanted here" in text
