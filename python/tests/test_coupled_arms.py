"""Arms in which joints follow others, or servos pull tendons: from their file to environments."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

import robocell as rc
import robot_models
from command_line import refused, robocell_command

BEGIN = (
    '<mujoco><compiler angle="radian"/><option integrator="implicitfast"/><default>'
    '<geom contype="0" conaffinity="0"/><joint damping="3" armature=".06"/></default><worldbody>'
    '<body name="base"><geom type="cylinder" size=".06 .05" mass="3"/>'
)


def link(joint: str, at: str, axis: str, limits: str, to: str, kind: str = "hinge") -> str:
    """A body on a joint of the same name."""
    return (
        f'<body name="l_{joint}" pos="{at}"><joint name="{joint}" type="{kind}" axis="{axis}" '
        f'range="{limits}"/><geom type="capsule" fromto="0 0 0 {to}" size=".02" mass=".5"/>'
    )


def servo(joint: str, stiffness: float) -> str:
    return f'<position name="m_{joint}" joint="{joint}" kp="{stiffness}" kv="{stiffness / 10}"/>'


WRIST = (
    link("j4", ".1 0 .2", "1 0 0", "-2.8 2.8", ".1 0 0")
    + link("j5", ".1 0 0", "0 1 0", "-1.9 1.9", ".07 0 0")
    + link("j6", ".07 0 0", "1 0 0", "-3 3", ".04 0 0")
    + '<site name="tcp" pos=".05 0 0"/>'
)
SHOULDER = link("j1", "0 0 .1", "0 0 1", "-2.8 2.8", "0 0 .12") + link(
    "j2", "0 0 .12", "0 1 0", "-1.5 1.7", "0 0 .3"
)
PARALLELOGRAM = (
    BEGIN
    + SHOULDER
    + link("j3", "0 0 .3", "0 1 0", "-1.7 1.5", ".05 0 0")
    + link("elbow", ".05 0 0", "0 1 0", "-2.5 2.5", ".1 0 .2")
    + WRIST
    + "</body>" * 8
    + "</worldbody><actuator>"
    + "".join(servo(joint, 1500) for joint in ("j1", "j2", "j3", "elbow"))
    + "".join(servo(f"j{i}", 300) for i in range(4, 7))
    + '</actuator><equality><joint joint1="j3" joint2="j2" polycoef="0 -1 0 0 0"/></equality>'
    "</mujoco>"
)
DIFFERENTIAL = (
    BEGIN
    + SHOULDER
    + link("j3", "0 0 .3", "0 1 0", "-2.5 2.5", ".1 0 .2")
    + WRIST
    + "</body>" * 7
    + '</worldbody><tendon><fixed name="sum"><joint joint="j5" coef="1"/>'
    '<joint joint="j6" coef=".5"/></fixed><fixed name="difference"><joint joint="j5" coef="1"/>'
    '<joint joint="j6" coef="-.5"/></fixed></tendon><actuator>'
    + "".join(servo(f"j{i}", 1500) for i in range(1, 5))
    + '<position name="m_sum" tendon="sum" kp="300" kv="30"/>'
    '<position name="m_difference" tendon="difference" kp="300" kv="30"/></actuator></mujoco>'
)
TELESCOPE = (
    BEGIN
    + link("lift", "0 0 .3", "0 0 1", "0 .9", "0 0 .1", "slide")
    + link("turn", "0 0 0", "0 0 1", "-2.8 2.8", "0 0 .05")
    + link("s1", "0 0 .05", "1 0 0", "0 .13", ".2 0 0", "slide")
    + link("s2", ".1 0 0", "1 0 0", "0 .13", ".2 0 0", "slide")
    + link("s3", ".1 0 0", "1 0 0", "0 .13", ".2 0 0", "slide")
    + link("j4", ".2 0 0", "0 0 1", "-2 2", ".05 0 0")
    + link("j5", ".05 0 0", "0 1 0", "-1.9 1.9", ".05 0 0")
    + link("j6", ".05 0 0", "1 0 0", "-3 3", ".04 0 0")
    + '<site name="tcp" pos=".05 0 0"/>'
    + "</body>" * 9
    + '</worldbody><tendon><fixed name="extend"><joint joint="s1" coef="1"/><joint joint="s2" '
    'coef="1"/><joint joint="s3" coef="1"/></fixed></tendon><equality><joint joint1="s2" '
    'joint2="s1"/><joint joint1="s3" joint2="s2"/></equality><actuator>'
    + servo("lift", 8000)
    + servo("turn", 1000)
    + '<position name="m_extend" tendon="extend" kp="1000" kv="100"/>'
    + "".join(servo(f"j{i}", 200) for i in range(4, 7))
    + "</actuator></mujoco>"
)
ROBOTS = {
    "parallelogram": (
        PARALLELOGRAM,
        "[j1, j2, j3, elbow, j4, j5, j6]",
        [0.1, 0.3, 0.4, 0, 0.5, 0.1],
    ),
    "differential": (DIFFERENTIAL, "j1..j6", [0.1, 0.4, -0.3, 0, 0.5, 0.2]),
    "telescope": (TELESCOPE, "[lift, turn, s1, j4, j5, j6]", [0.4, 0.2, 0.06, 0.3, 0.4, 0.1]),
}


def robot_file(folder: Path, name: str) -> Path:
    text, joints, home = ROBOTS[name]
    (folder / f"{name}.xml").write_text(text)
    path = folder / f"{name}.yaml"
    follower = "home: {arm: [0.1, 0.3, -0.3, 0.4, 0, 0.5, 0.1]}" if name == "parallelogram" else ""
    path.write_text(
        f"name: {name}\nmodel: {name}.xml\nroot_body: base\nmove_groups:\n"
        f"  arm: {{kind: arm, joints: {joints}, leaf: {{site: tcp}}}}\n"
        f"{follower or f'home: {{arm: {home}}}'}\ngravcomp: true\n"
    )
    return path


def build(folder: Path, name: str) -> rc.Robot:
    spec = rc.SceneSpec(name="arms", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(str(robot_file(folder, name)))
    spec.robots.append(rc.RobotSpec(name=name, config=config))
    robot = rc.Scene.build(spec).robot(name)
    robot.scene.reset()
    return robot


@pytest.mark.parametrize("name", ROBOTS)
def test_check_finds_no_problems(tmp_path: Path, name: str):
    checked = robocell_command("check", robot_file(tmp_path, name))
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert checked.stdout.splitlines()[-1] == "no problems found", checked.stdout


def test_a_chain_names_its_followers(tmp_path: Path):
    chain = build(tmp_path, "telescope").chain
    assert chain.joint_names == ["lift", "turn", "s1", "j4", "j5", "j6"]
    assert chain.followers == {"s2": "s1", "s3": "s1"}
    assert chain.link_joint_names == ["lift", "turn", "s1", "s2", "s3", "j4", "j5", "j6"]
    expanded = chain.expand([0.4, 0.2, 0.06, 0.3, 0.4, 0.1])
    assert np.allclose(expanded, [0.4, 0.2, 0.06, 0.06, 0.06, 0.3, 0.4, 0.1])
    with pytest.raises(rc.ArgumentError, match="expected 6 joint values, got 2"):
        chain.expand([0, 1])


@pytest.mark.parametrize("name", ROBOTS)
def test_solutions_of_inverse_kinematics_are_reached(tmp_path: Path, name: str):
    robot = build(tmp_path, name)
    goal = np.array(ROBOTS[name][2]) + 0.05
    target = robot.chain.fk(goal)
    found = robot.ik(target)
    assert found.success
    robot.jnt_pos_cmd = found.q
    for _ in range(2000):
        robot.update()
        robot.step()
    assert np.linalg.norm(robot.fk_frame().translation - target.translation) < 2e-3
    tcp = robot.base_in_world.inverse() * robot.tcp_in_world
    assert np.linalg.norm(tcp.translation - target.translation) < 2e-3


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("mode", ["cartesian_tquat", "joints"])
def test_environments_move_them(tmp_path: Path, name: str, mode: str):
    home = ROBOTS[name][2]
    env = rc.Env(rc.EnvConfig(robots={"r": str(robot_file(tmp_path, name))}, control_mode=mode))
    observation, _ = env.reset(seed=1)
    assert len(observation["r"]["joints"]) == len(home)
    before = np.array(env.scene.robot("r").fk_frame().translation)
    for _ in range(5):
        action = {"tquat": [0, 0, -0.01, 0, 0, 0, 1]} if mode != "joints" else None
        action = action or {"joints": [0.02] * len(home)}
        *_, info = env.step({"r": action})
        assert info["reason"] == "arrived", info
    moved = env.scene.robot("r").fk_frame().translation - before
    if mode == "joints":
        assert np.linalg.norm(moved) > 0.01
    else:
        assert np.allclose(moved, [0, 0, -0.05], atol=3e-3)


class TestLoops:
    """An arm beside a crank and a rod that `connect` ties to it."""

    def scene(self, folder: Path, **fields: object) -> rc.Scene:
        text = robot_models.parallel_links().replace(
            '<position name="a_crank" joint="crank"', '<position name="a" joint="elbow"'
        )
        (folder / "arm.xml").write_text(text)
        robot = {
            "name": "arm",
            "model": "arm.xml",
            "move_groups": {
                "arm": {
                    "kind": "arm",
                    "joints": ["shoulder", "elbow", "wrist"],
                    "leaf": {"site": "tcp"},
                }
            },
            **fields,
        }
        config = rc.RobotConfig.from_yaml(yaml.safe_dump(robot), directory=str(folder))
        spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
        spec.robots.append(rc.RobotSpec(name="arm", config=config))
        return rc.Scene.build(spec)

    @staticmethod
    def gap(scene: rc.Scene) -> float:
        """How far the engine's constraint is open, m."""
        data = mujoco.MjData(scene.model)
        data.qpos[:] = scene.data.qpos
        mujoco.mj_forward(scene.model, data)
        rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        assert rows.sum() == 3
        return float(np.abs(data.efc_pos[rows]).max())

    def test_home_and_its_noise_leave_them_closed(self, tmp_path: Path):
        home = [0.3, 0.6, 0.2]
        scene = self.scene(tmp_path, home={"arm": home}, home_noise={"arm": [0.2]})
        seen = []
        for seed in range(10):
            scene.reset(seed=seed)
            assert self.gap(scene) < 1e-8
            seen.append(scene.robot("arm").jnt_pos_msr)
        assert np.ptp(seen, axis=0).min() > 0.1
        assert np.abs(np.array(seen) - home).max() <= 0.2 + 1e-12

    def test_a_home_that_a_loop_does_not_allow_is_a_warning(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ):
        rod = '<joint name="rod" axis="0 1 0" range="{}"/>'
        text = robot_models.parallel_links()
        assert rod.format("-3 3") in text
        narrow = text.replace(rod.format("-3 3"), rod.format("-.1 .1"))
        monkeypatch.setattr(robot_models, "parallel_links", lambda: narrow)
        for elbow, count in ((0.05, 0), (0.6, 1)):
            scene = self.scene(tmp_path, home={"arm": [0.3, elbow, 0.2]})
            found = [each for each in scene.warnings if "part of the loop that 'close'" in each]
            assert len(found) == count, scene.warnings
            if count:
                assert "home: 'shoulder' is part of" in found[0]
                assert "choose a home that the loop allows" in found[0]

    def test_a_joint_that_only_a_loop_moves_is_explained(self, tmp_path: Path):
        (tmp_path / "arm.xml").write_text(robot_models.parallel_links())
        (tmp_path / "arm.yaml").write_text(
            "name: arm\nmodel: arm.xml\nmove_groups:\n"
            "  arm: {kind: arm, joints: [shoulder, elbow, wrist], leaf: {site: tcp}}\n"
        )
        said = refused("check", tmp_path / "arm.yaml")
        assert "elbow. 'elbow' is part of the loop that 'close' closes, a connect of " in said
        assert '<joint joint1="elbow" joint2="LEADER"/>' in said
