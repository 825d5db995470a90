"""Messages about frequent mistakes name the element, its place, alternatives and next step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from command_line import RC7, refused

RUN = f"""run: tiny
robot: {RC7}
output: out
task: {{kind: pick}}
start: {{base_distance: [0.3, 0.55], base_height_offset: -0.25}}
scenes: {{source: tabletop}}
episodes_per_scene: 1
cameras:
  resolution: [64, 48]
  streams:
    - {{name: wrist, camera: wrist_camera}}
"""
MESHES = """<mujoco>
<asset><mesh name="link" file="lnik.stl"/></asset>
<worldbody><body name="b"><geom type="mesh" mesh="link"/></body></worldbody>
</mujoco>
"""


def robot_text(folder: Path) -> str:
    """The built-in robot's file, as if it lay in a folder of its own."""
    return RC7.read_text().replace("model: rc7.xml", f"model: {RC7.with_suffix('.xml')}")


def mesh_robot_text(folder: Path) -> str:
    """A robot whose model wants a mesh that nearly is there."""
    (folder / "arm.xml").write_text(MESHES)
    (folder / "link.stl").write_text("")
    return "name: arm\nmodel: arm.xml\n"


def run_text(folder: Path) -> str:
    """A run file."""
    return RUN.replace("output: out", f"output: {folder / 'out'}")


@dataclass(frozen=True)
class Case:
    """A file with one mistake.

    Attributes:
        command: What is asked to work on it.
        content: What is in the file, which is made in a folder.
        mistake: In the place of what; both are in one line.
        before: What stands before the place that is told.
        thing: What is wrong, as it is told behind the place.
        alternatives: What there is.
        next_step: What to do.
        code: The exit code.
    """

    command: str
    content: Callable[[Path], str]
    mistake: tuple[str, str]
    before: str
    thing: str
    alternatives: str
    next_step: str
    code: int = 2


CASES = {
    "unknown joint": Case(
        "check",
        robot_text,
        ("joints: joint1..joint7", "joints: joint2..joint8"),
        "arm:     {kind: arm, joints: ",
        "robot 'rc7': no joint 'joint8'",
        "Its joints: joint1, joint2, joint3, joint4, joint5, joint6, joint7, left_finger_joint, "
        "right_finger_joint",
        "Did you mean 'joint7'?",
    ),
    "missing mesh": Case(
        "check",
        mesh_robot_text,
        ("", ""),
        "model: ",
        "robot 'arm': {folder}/arm.xml refers to the file 'lnik.stl' (mesh 'link', line 2), but "
        "there is no {folder}/lnik.stl",
        "Did you mean 'link.stl'?",
        "Get the model with all its files, or correct `file`, `meshdir` or `texturedir` in it",
    ),
    "unreachable TCP": Case(
        "check",
        robot_text,
        ("servo1..servo7, leaf: {site: tcp}", "servo1..servo7, leaf: {body: base_link}"),
        "servo1..servo7, leaf: ",
        "robot 'rc7': move_groups.arm.leaf: there is no joint between 'base_link' and the arm's "
        "leaf, so nothing moves",
        "Sites there: attachment_site, tcp. Bodies there: link7, hand",
        "name as `leaf` what the last joint, 'joint7', carries, for example {site: tcp}",
    ),
    "base size of two numbers": Case(
        "check",
        robot_text,
        ("size: [0.22, 0.22, 0.25]", "size: [0.22, 0.25]"),
        "mocap, size: ",
        "base.size: expected a list of 3 numbers, found a list of 2",
        "Length, width and height of a box under the robot, metres",
        "expected a list of 3 numbers",
    ),
    "camera that does not exist": Case(
        "generate",
        run_text,
        ("camera: wrist_camera", "camera: wirst_camera"),
        "wrist, camera: ",
        "stream 'wrist' (cameras.streams[0]).camera: stream 'wrist': no camera 'wirst_camera'",
        "exo_camera, wrist_camera",
        "Did you mean 'wrist_camera'?",
    ),
    "NaN in home": Case(
        "check",
        robot_text,
        ("arm: [0, -0.15", "arm: [0, .nan"),
        "arm: [0, ",
        "home.arm[1]: nan is not a finite number",
        "a number",
        "write a number in its place",
    ),
    "odd video size": Case(
        "generate",
        run_text,
        ("[64, 48]", "[65, 48]"),
        "    - ",
        "stream 'wrist' (cameras.streams[0]): size 65x48 cannot be encoded as video, which needs "
        "even numbers",
        "the nearest size is 66x48",
        "correct the stream's width and height, or `cameras.resolution`",
    ),
    "unwritable output": Case(
        "generate",
        lambda folder: RUN,
        ("output: out", "output: /proc/none/out"),
        "output: ",
        "output '/proc/none/out': cannot write into '/proc': no folder can be made there",
        "Name another one (--output)",
        "or make that folder writable",
        code=3,
    ),
}


def place_behind(text: str, before: str) -> str:
    """LINE:COLUMN of what stands behind a part of a text that is there once."""
    assert text.count(before) == 1
    lines = text[: text.index(before) + len(before)].split("\n")
    return f"{len(lines)}:{len(lines[-1]) + 1}"


@pytest.mark.parametrize("name", CASES)
def test_errors_name_element_place_alternatives_and_next_step(name: str, tmp_path: Path):
    case = CASES[name]
    right = case.content(tmp_path)
    assert right.count(case.mistake[0]) == 1 or not case.mistake[0]
    text = right.replace(*case.mistake) if case.mistake[0] else right
    path = tmp_path / "file.yaml"
    path.write_text(text)
    before = sorted(tmp_path.rglob("*"))
    told = refused(case.command, path, code=case.code)
    thing = case.thing.format(folder=tmp_path)
    assert f"{path}:{place_behind(text, case.before)}: {thing}" in told
    assert case.alternatives in told
    assert case.next_step in told
    assert sorted(tmp_path.rglob("*")) == before, "nothing is made"


def test_a_missing_dataset_at_the_root_lists_the_folders_of_the_root():
    told = refused("verify", "/no-such-dataset-of-robocell")
    assert "no dataset '/no-such-dataset-of-robocell'. Datasets in /: none." in told
