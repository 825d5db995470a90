"""The built-in arm with hands of other kinds, for tests: files of robots."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import yaml

import robocell as rc
from init_models import cup, suck


def _body(root: ET.Element, name: str) -> ET.Element:
    found = root.find(f".//body[@name='{name}']")
    assert found is not None
    return found


def _without(root: ET.Element, *tags: str) -> None:
    for tag in tags:
        for child in root.findall(tag):
            root.remove(child)


def _write(folder: Path, name: str, root: ET.Element, gripper: dict, rest: list[float]) -> Path:
    source = Path(rc.models.robot_file("rc7"))
    folder.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(root).write(folder / f"{name}.xml")
    config = yaml.safe_load(source.read_text(encoding="utf-8"))
    config |= {"name": name, "model": f"{name}.xml", "edits": [], "cameras": []}
    config["move_groups"]["gripper"] = {"kind": "gripper", "leaf": {"site": "tcp"}} | gripper
    config["home"]["gripper"] = rest
    config["home_noise"]["gripper"] = [0] * len(rest)
    file = folder / f"{name}.yaml"
    file.write_text(yaml.safe_dump(config), encoding="utf-8")
    return file


def one_moving_finger(folder: Path) -> Path:
    """The right finger is fixed; the left one moves to it."""
    root = ET.parse(Path(rc.models.robot_file("rc7")).with_suffix(".xml")).getroot()
    right = _body(root, "right_finger")
    _without(right, "joint")
    _without(root, "equality", "keyframe")
    tendon = root.find("./tendon/fixed")
    assert tendon is not None
    tendon.remove(tendon.findall("joint")[1])
    tendon.findall("joint")[0].set("coef", "1")
    fingers = {
        "joints": ["left_finger_joint"],
        "actuators": ["gripper"],
        "fingers": ["left_finger_pad", "right_finger_pad"],
        "ctrl": {"open": 100, "closed": 0},
    }
    return _write(folder, "one_finger", root, fingers, [0.044])


def suction_cup(folder: Path, force: float = 60) -> Path:
    """A cup of 15 mm radius in the place of the fingers."""
    root = ET.parse(Path(rc.models.robot_file("rc7")).with_suffix(".xml")).getroot()
    hand = _body(root, "hand")
    for name in ("left_finger", "right_finger"):
        hand.remove(_body(root, name))
    _without(root, "equality", "keyframe", "tendon")
    contact = root.find("contact")
    assert contact is not None
    for exclude in contact.findall("exclude"):
        if exclude.get("body1") == "left_finger":
            contact.remove(exclude)
    hand.append(ET.fromstring(cup(radius=0.015, length=0.071, at=0.069, margin=0)))
    actuators = root.find("actuator")
    assert actuators is not None
    _without(actuators, "general")
    actuators.append(ET.fromstring(suck(force)))
    return _write(folder, "cup", root, {"actuators": ["suck"]}, [])
