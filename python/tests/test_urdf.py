"""URDFs as robots, against the numbers of the file itself: poses, masses, limits, mimic joints."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

import robocell
from command_line import refused, robocell_command

MASS = (
    '<inertial><origin xyz="{com}" rpy="{rpy}"/><mass value="{mass}"/>'
    '<inertia ixx="0.02" ixy="0.001" ixz="0.002" iyy="0.03" iyz="0.003" izz="0.04"/></inertial>'
)


# --- The oracle: what the XML says, without MuJoCo ---


def numbers(element: ElementTree.Element | None, name: str, default: str) -> np.ndarray:
    text = default if element is None else element.get(name, default)
    return np.array([float(each) for each in text.split()])


def rotation(rpy: np.ndarray) -> np.ndarray:
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def origin(element: ElementTree.Element) -> np.ndarray:
    pose = np.eye(4)
    at = element.find("origin")
    pose[:3, :3] = rotation(numbers(at, "rpy", "0 0 0"))
    pose[:3, 3] = numbers(at, "xyz", "0 0 0")
    return pose


def motion(joint: ElementTree.Element, q: float) -> np.ndarray:
    pose = np.eye(4)
    axis = numbers(joint.find("axis"), "xyz", "1 0 0")
    axis /= np.linalg.norm(axis)
    if joint.get("type") == "prismatic":
        pose[:3, 3] = axis * q
    elif joint.get("type") != "fixed":
        x, y, z = axis
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        pose[:3, :3] = np.eye(3) + np.sin(q) * cross + (1 - np.cos(q)) * cross @ cross
    return pose


def link_poses(robot: ElementTree.Element, q: dict[str, float]) -> dict[str, np.ndarray]:
    """Poses of all links in the frame of the root link."""
    joints = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}

    def pose(link: str) -> np.ndarray:
        if link not in joints:
            return np.eye(4)
        joint = joints[link]
        above = pose(joint.find("parent").get("link"))
        return above @ origin(joint) @ motion(joint, q.get(joint.get("name"), 0.0))

    return {link.get("name"): pose(link.get("name")) for link in robot.findall("link")}


def follow(robot: ElementTree.Element, q: dict[str, float]) -> dict[str, float]:
    """Positions with those of mimic joints; leaders come first in these files."""
    q = dict(q)
    for joint in robot.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            slope, offset = float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
            q[joint.get("name")] = slope * q[mimic.get("joint")] + offset
    return q


# --- Robots of our own ---


def link(name: str, inside: str = "") -> str:
    return f'<link name="{name}">{inside}</link>'


def mass(value: float, com: str = "0 0 0", rpy: str = "0 0 0") -> str:
    return MASS.format(mass=value, com=com, rpy=rpy)


def joint(name: str, kind: str, parent: str, child: str, inside: str = "") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{inside}</joint>"
    )


def place(xyz: str, rpy: str = "0 0 0", axis: str = "0 0 1", limits: str = "-2 2 50 3") -> str:
    lower, upper, effort, velocity = limits.split()
    return (
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/><limit lower="{lower}" '
        f'upper="{upper}" effort="{effort}" velocity="{velocity}"/>'
    )


def scara() -> str:
    return (
        link("base_link", mass(5))
        + link("l1", mass(2, "0.1 0 0"))
        + link("l2", mass(1.5, "0.1 0 0"))
        + link("quill", mass(0.5))
        + link("spindle", mass(0.3))
        + link("flange")
        + joint("j1", "revolute", "base_link", "l1", place("0 0 0.3"))
        + joint("j2", "revolute", "l1", "l2", place("0.25 0 0"))
        + joint("j3", "prismatic", "l2", "quill", place("0.2 0 0", limits="-0.15 0 100 1"))
        + joint("j4", "continuous", "quill", "spindle", place("0 0 0", limits="0 0 10 6"))
        + joint("tool", "fixed", "spindle", "flange", place("0 0 -0.05", "3.14159265 0 0"))
    )


def six_axis_with_gripper() -> str:
    text, parent, at = link("base_link", mass(4)), "base_link", 0.12
    for number, axis in enumerate(("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1"), 1):
        own = mass(3.0 / number, f"0 0 {at / 2}", "0.1 -0.2 0.3")
        text += link(f"l{number}", own)
        text += joint(f"j{number}", "revolute", parent, f"l{number}", place(f"0 0 {at}", axis=axis))
        parent, at = f"l{number}", 0.2
    box = '<collision><geometry><box size="0.02 0.01 0.05"/></geometry></collision>'
    text += link("palm", mass(0.4)) + joint("wrist", "fixed", "l6", "palm", place("0 0 0.05"))
    text += link("left", mass(0.1) + box) + link("right", mass(0.1) + box)
    text += joint(
        "finger", "prismatic", "palm", "left", place("0 0.02 0.05", "0 0 0", "0 1 0", "0 0.04 30 1")
    )
    text += joint(
        "other",
        "prismatic",
        "palm",
        "right",
        place("0 -0.02 0.05", "0 0 3.14159265", "0 1 0", "0 0.05 30 1")
        + '<mimic joint="finger" multiplier="1.25" offset="0.001"/>',
    )
    return text


def mobile_base() -> str:
    return (
        link("base_footprint")
        + link("base_link", mass(20))
        + link("laser", mass(0.2))
        + link("camera")
        + link("camera_optical")
        + link("left_wheel", mass(1))
        + link("right_wheel", mass(1))
        + joint("foot", "fixed", "base_footprint", "base_link", place("0 0 0.1"))
        + joint("laser_mount", "fixed", "base_link", "laser", place("0.2 0 0.1", "0 0 1.5"))
        + joint("camera_mount", "fixed", "base_link", "camera", place("0.25 0 0.3", "0 0.3 0"))
        + joint("optical", "fixed", "camera", "camera_optical", place("0 0 0", "-1.57 0 -1.57"))
        + joint("left", "continuous", "base_link", "left_wheel", place("0 0.2 0", axis="0 1 0"))
        + joint("right", "continuous", "base_link", "right_wheel", place("0 -0.2 0", axis="0 1 0"))
    )


def on_the_world() -> str:
    text = scara().replace("base_link", "stand")
    return link("world") + text + joint("bolts", "fixed", "world", "stand", place("1 2 0.5"))


def random_tree(seed: int) -> str:
    rng = np.random.default_rng(seed)

    def some(count: int, scale: float) -> str:
        return " ".join(repr(float(x)) for x in rng.uniform(-scale, scale, count))

    text, movers = link("root", mass(1)), []
    names = ["root"]
    for number in range(int(rng.integers(5, 14))):
        name, kind = f"x{number}", rng.choice(["revolute", "continuous", "prismatic", "fixed"])
        inside = place(some(3, 0.5), some(3, 3.0), some(3, 1.0))
        if kind != "fixed":
            if movers and rng.random() < 0.3:
                slope, offset = rng.uniform(-2, 2, 2)
                inside += (
                    f'<mimic joint="{rng.choice(movers)}" multiplier="{slope}" offset="{offset}"/>'
                )
            else:
                movers.append(f"j{number}")
        text += link(name, mass(float(rng.uniform(0.1, 3)), some(3, 0.1), some(3, 3.0)))
        text += joint(f"j{number}", str(kind), str(rng.choice(names)), name, inside)
        names.append(name)
    return text


ROBOTS = {
    "scara": scara(),
    "gripper": six_axis_with_gripper(),
    "mobile": mobile_base(),
    "world": on_the_world(),
    **{f"random{seed}": random_tree(seed) for seed in range(20)},
}


def write(folder: Path, inside: str, name: str = "robot.urdf") -> Path:
    file = folder / name
    file.write_text(f'<robot name="robot">\n{inside}\n</robot>\n')
    return file


def scene_of(file: Path) -> robocell.Scene:
    spec = robocell.SceneSpec(name="one", timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(robocell.RobotSpec(name="robot", path=str(file)))
    return robocell.Scene.build(spec)


def pose_in(data: mujoco.MjData, name: str) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = data.body(name).xmat.reshape(3, 3)
    pose[:3, 3] = data.body(name).xpos
    return pose


class TestAgainstTheFile:
    @pytest.mark.parametrize("name", ROBOTS)
    def test_links_are_where_the_origins_and_axes_say(self, tmp_path: Path, name: str):
        file = write(tmp_path, ROBOTS[name])
        robot = ElementTree.parse(file).getroot()
        scene = scene_of(file)
        model, data = scene.model, mujoco.MjData(scene.model)
        rng = np.random.default_rng(0)
        for _ in range(5):
            moving = [j for j in robot.findall("joint") if j.get("type") != "fixed"]
            q = follow(robot, {j.get("name"): float(rng.uniform(-1, 1)) for j in moving})
            for each, value in q.items():
                data.joint(each).qpos[0] = value
            mujoco.mj_kinematics(model, data)
            expected = link_poses(robot, q)
            links = [each for each in expected if each != "world"]
            first = links[0]
            for each in links:
                relative = np.linalg.inv(expected[first]) @ expected[each]
                found = np.linalg.inv(pose_in(data, first)) @ pose_in(data, each)
                np.testing.assert_allclose(found, relative, atol=1e-9, err_msg=each)

    @pytest.mark.parametrize("name", ROBOTS)
    def test_masses_and_inertias_are_those_of_the_file(self, tmp_path: Path, name: str):
        file = write(tmp_path, ROBOTS[name])
        model = scene_of(file).model
        for each in ElementTree.parse(file).getroot().findall("link"):
            inertial = each.find("inertial")
            if each.get("name") == "world":
                continue
            body = model.body(each.get("name")).id
            if inertial is None:
                assert model.body_mass[body] == 0
                continue
            assert model.body_mass[body] == float(inertial.find("mass").get("value"))
            at, values = origin(inertial), inertial.find("inertia")
            xx, xy, xz, yy, yz, zz = (
                float(values.get(k)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            )
            given = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            expected = at[:3, :3] @ given @ at[:3, :3].T
            axes = np.zeros(9)
            mujoco.mju_quat2Mat(axes, model.body_iquat[body])
            axes = axes.reshape(3, 3)
            found = axes @ np.diag(model.body_inertia[body]) @ axes.T
            np.testing.assert_allclose(found, expected, atol=1e-9)
            np.testing.assert_allclose(model.body_ipos[body], at[:3, 3], atol=1e-12)

    @pytest.mark.parametrize("name", ROBOTS)
    def test_limits_efforts_and_mimic_joints_are_those_of_the_file(self, tmp_path: Path, name: str):
        file = write(tmp_path, ROBOTS[name])
        model = scene_of(file).model
        followers = 0
        for each in ElementTree.parse(file).getroot().findall("joint"):
            if each.get("type") == "fixed":
                continue
            index, limit = model.joint(each.get("name")).id, each.find("limit")
            limited = each.get("type") != "continuous"
            assert bool(model.jnt_limited[index]) == limited
            if limited:
                assert list(model.jnt_range[index]) == [
                    float(limit.get("lower")),
                    float(limit.get("upper")),
                ]
            effort = float(limit.get("effort"))
            assert list(model.jnt_actfrcrange[index]) == [-effort, effort]
            mimic = each.find("mimic")
            if mimic is None:
                actuator = model.actuator(each.get("name"))
                assert list(actuator.forcerange) == [-effort, effort]
                continue
            followers += 1
            (equality,) = [i for i in range(model.neq) if model.eq_obj1id[i] == index]
            assert model.eq_obj2id[equality] == model.joint(mimic.get("joint")).id
            offset, slope = float(mimic.get("offset", 0)), float(mimic.get("multiplier", 1))
            assert list(model.eq_data[equality][:5]) == [offset, slope, 0, 0, 0]
        assert model.neq == followers


class TestAsARobot:
    def test_a_mimic_finger_follows(self, tmp_path: Path):
        scene = scene_of(write(tmp_path, six_axis_with_gripper()))
        data = scene.data
        data.ctrl[scene.model.actuator("finger").id] = 0.03
        for _ in range(1000):
            mujoco.mj_step(scene.model, data)
        leader, other = data.joint("finger").qpos[0], data.joint("other").qpos[0]
        assert leader == pytest.approx(0.03, abs=2e-3)
        assert other == pytest.approx(1.25 * leader + 0.001, abs=1e-3)

    def test_init_writes_a_robot_file_that_names_the_urdf(self, tmp_path: Path):
        file = write(tmp_path, six_axis_with_gripper())
        result = robocell_command("init", file, "-o", tmp_path / "out.yaml")
        assert result.returncode == 0, result.stdout + result.stderr
        written = yaml.safe_load((tmp_path / "out.yaml").read_text())
        assert written["model"] == "robot.urdf"
        assert written["move_groups"]["arm"]["joints"] == "j1..j6"
        kinds = {group["kind"] for group in written["move_groups"].values()}
        assert "gripper" in kinds

    def test_convert_writes_the_same_robot(self, tmp_path: Path):
        file = write(tmp_path, six_axis_with_gripper())
        (tmp_path / "mjcf").mkdir()
        out = tmp_path / "mjcf" / "robot.xml"
        result = robocell_command("convert", file, "-o", out)
        assert result.returncode == 0, result.stderr
        assert "position servos were made for j1, j2, j3, j4, j5, j6, finger" in result.stdout
        text, model = mujoco.MjModel.from_xml_path(str(out)), scene_of(file).model
        assert (text.nactuator, text.neq) == (7, 1)
        for name in ("base_link", "palm", "right"):
            assert text.body(name).mass == pytest.approx(model.body(name).mass)
        assert robocell_command("convert", file, "-o", out).returncode == 2, "it exists"
        assert robocell_command("convert", file, "-o", out, "--force").returncode == 0


TETRAHEDRON = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.mark.parametrize("dynamics", ['damping="12"', 'friction="4"'])
def test_servos_move_joints_that_resist(tmp_path: Path, dynamics: str):
    text = six_axis_with_gripper()
    begin = text.index('<joint name="j6"')
    end = text.index("</joint>", begin)
    scene = scene_of(write(tmp_path, f"{text[:end]}<dynamics {dynamics}/>{text[end:]}"))
    at = int(scene.model.joint("j6").qposadr[0])
    servo = next(i for i in range(scene.model.nactuator) if "j6" in scene.model.actuator(i).name)
    scene.reset()
    start = float(scene.data.qpos[at])
    held = np.array(scene.data.ctrl)
    held[servo] = start + 0.1
    for _ in range(500):
        scene.data.ctrl[:] = held
        scene.step()
    assert scene.data.qpos[at] - start == pytest.approx(0.1, abs=0.012)


class TestFiles:
    def with_mesh(self, folder: Path) -> Path:
        mesh = (
            '<visual><geometry><mesh filename="package://arm_d/meshes/a.obj"/></geometry></visual>'
        )
        (folder / "far" / "meshes").mkdir(parents=True)
        (folder / "far" / "meshes" / "a.obj").write_text(TETRAHEDRON)
        return write(folder, six_axis_with_gripper().replace("</link>", f"{mesh}</link>", 1))

    def test_packages_are_given_on_the_command_line(self, tmp_path: Path):
        file, out = self.with_mesh(tmp_path), tmp_path / "out.xml"
        error = refused("convert", file, "-o", out)
        assert f"{file}:2: link 'base_link': its mesh: no package 'arm_d'" in error
        given = f"arm_d={tmp_path / 'far'}"
        result = robocell_command("convert", file, "-o", out, "--package", given)
        assert result.returncode == 0, result.stderr
        assert mujoco.MjModel.from_xml_path(str(out)).nmesh == 1
        assert 'file="far/meshes/a.obj"' in out.read_text()

    def test_packages_are_given_in_a_variable(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ):
        file = self.with_mesh(tmp_path)
        with pytest.raises(robocell.SpecError, match="export ROBOCELL_PACKAGES=arm_d=FOLDER"):
            scene_of(file)
        monkeypatch.setenv("ROBOCELL_PACKAGES", f"arm_d={tmp_path / 'far'}")
        assert scene_of(file).model.nmesh == 1

    def test_packages_of_another_repository_of_the_workspace_are_found(self, tmp_path: Path):
        own = tmp_path / "ws/src/cell/arm_description"
        other = tmp_path / "ws/src/tools/arm_d"
        for package in (own / "urdf", other / "meshes"):
            package.mkdir(parents=True)
        for package in (own, other):
            name = f"<package><name>{package.name}</name></package>"
            (package / "package.xml").write_text(name)
        (other / "meshes" / "a.obj").write_text(TETRAHEDRON)
        mesh = (
            '<visual><geometry><mesh filename="package://arm_d/meshes/a.obj"/></geometry></visual>'
        )
        text = six_axis_with_gripper().replace("</link>", f"{mesh}</link>", 1)
        assert scene_of(write(own / "urdf", text)).model.nmesh == 1

    def test_the_files_beside_a_copy_go_before_packages_elsewhere(self, tmp_path: Path):
        copy, other = tmp_path / "arm", tmp_path / "old/arm_d"
        for folder, text in ((copy, TETRAHEDRON), (other, "no mesh")):
            (folder / "meshes").mkdir(parents=True)
            (folder / "meshes" / "a.obj").write_text(text)
        (copy / "urdf").mkdir()
        (other / "package.xml").write_text("<package><name>arm_d</name></package>")
        mesh = (
            '<visual><geometry><mesh filename="package://arm_d/meshes/a.obj"/></geometry></visual>'
        )
        text = six_axis_with_gripper().replace("</link>", f"{mesh}</link>", 1)
        assert scene_of(write(copy / "urdf", text)).model.nmesh == 1

    def test_a_urdf_is_an_object(self, tmp_path: Path):
        ball = "<collision><geometry><sphere radius='0.05'/></geometry></collision>" + mass(0.1)
        file = write(tmp_path, link("ball", ball))
        spec = robocell.SceneSpec(name="one", timestep=0.002, add_floor=True, add_skybox=False)
        spec.objects.append(robocell.SceneObject(name="ball", mjcf_path=str(file), fixed=False))
        model = robocell.Scene.build(spec).model
        assert model.nactuator == 0
        assert model.nv == 6

    def test_a_xacro_file_says_how_to_make_a_urdf(self, tmp_path: Path):
        file = tmp_path / "arm.urdf.xacro"
        file.write_text('<robot xmlns:xacro="http://x">\n<xacro:arm prefix="a"/></robot>')
        error = refused("init", file, "-o", tmp_path / "out.yaml")
        assert f"{file}:2: <xacro:arm> belongs to xacro" in error
        assert f"xacro {file} > {os.fspath(tmp_path / 'arm.urdf')}" in error
