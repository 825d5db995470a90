"""System identification finds what a motion was simulated with."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import robocell as rc
from command_line import robocell_command
from robocell.data import ColumnSpec, EpisodeWriter
from robocell.identify import ArmTrajectory, Identified, Parameter, excitation, identify


def random_arm(rng: np.random.Generator, joints: int, folder: Path) -> rc.Robot:
    """An arm of random links, joints and servos, alone in its scene."""
    body, ends, servos, last = "", "", "", 0.2
    for i in range(joints):
        length, radius = rng.uniform(0.15, 0.35), rng.uniform(0.03, 0.05)
        # About the link itself, or upright alone, inertia says nothing of a joint's forces.
        axis = np.eye(3)[rng.integers(2) if i or joints == 1 else 2]
        gain = 300 * 0.6**i * rng.uniform(0.7, 1.4)
        damping = 0.15 * gain * rng.uniform(0.3, 1)
        body += (
            f"<body name='link{i}' pos='0 0 {last:.4f}'>"
            f"<joint name='joint{i}' axis='{axis[0]} {axis[1]} {axis[2]}' range='-2 2' "
            f"limited='true' damping='{damping:.4f}' armature='{0.02 * 0.7**i:.5f}' "
            f"frictionloss='{0.004 * gain:.4f}'/>"
            f"<geom type='capsule' fromto='0 0 0 0 0 {length:.4f}' size='{radius:.4f}' "
            "density='700' contype='0' conaffinity='0'/>"
        )
        last = length
        ends += "</body>"
        servos += f"<position name='servo{i}' joint='joint{i}' kp='{gain:.3f}' ctrlrange='-2 2'/>"
    body += f"<site name='tcp' pos='0 0 {last:.4f}'/>"
    model = folder / "arm.xml"
    model.write_text(
        "<mujoco><compiler angle='radian'/>"
        f"<worldbody><body name='base'>{body}{ends}</body></worldbody>"
        f"<actuator>{servos}</actuator></mujoco>"
    )
    config = rc.RobotConfig(
        name="arm",
        model=str(model),
        root_body="base",
        home={"arm": [0.3] * joints},
        move_groups={
            "arm": {
                "kind": "arm",
                "joints": [f"joint{i}" for i in range(joints)],
                "actuators": [f"servo{i}" for i in range(joints)],
                "leaf": {"site": "tcp"},
            }
        },
    )
    spec = rc.SceneSpec(name="alone", timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="arm", config=config))
    return rc.Scene.build(spec).robot("arm")


def change(robot: rc.Robot, rng: np.random.Generator) -> dict[str, Any]:
    """Gives the model other values, and returns them."""
    model = robot.scene.model
    n = robot.n_joints
    model.dof_damping.reshape(model.nv, -1)[:, 0] *= rng.uniform(0.5, 1.8, n)
    model.dof_frictionloss[:] *= rng.uniform(0.5, 1.8, n)
    model.dof_armature[:] *= rng.uniform(0.5, 2.5, n)
    scale = rng.uniform(0.7, 1.4, n)
    servos = [model.actuator(name).id for name in robot.arm.actuator_names]
    model.actuator_gainprm[servos, 0] *= scale
    model.actuator_biasprm[servos, 1] *= scale
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return {
        "damping": model.dof_damping.reshape(model.nv, -1)[:, 0].copy(),
        "frictionloss": model.dof_frictionloss.copy(),
        "armature": model.dof_armature.copy(),
        "gain": model.actuator_gainprm[servos, 0].copy(),
        "delay": [float(rng.uniform(0.004, 0.03))],
    }


def recorded(
    robot: rc.Robot, delay: float, noise: float, rng: np.random.Generator, seconds: float
) -> ArmTrajectory:
    """Commands the arm through its own controller, step by step, and measures it with noise."""
    time, command = excitation(robot, seconds, 250, seed=int(rng.integers(1000)))
    robot.scene.reset()
    measured = np.empty_like(command)
    row, timestep = 0, robot.scene.timestep()
    for step in range(round(time[-1] / timestep) + 2):
        now = step * timestep
        while row < len(time) and time[row] <= now + 1e-9:
            measured[row] = robot.arm.joint_pos
            row += 1
        for joint in range(robot.n_joints):
            robot.jnt_pos_cmd[joint] = np.interp(now - delay, time, command[:, joint])
        robot.update()
        robot.step()
    return ArmTrajectory.of(time, command, measured + noise * rng.standard_normal(command.shape))


def recovers(seed: int, joints: int, folder: Path, seconds: float) -> None:
    """Values of a changed arm are found within 5 % by the unchanged one."""
    rng = np.random.default_rng(seed)
    robot = random_arm(rng, joints, folder)
    true = change(robot, rng)
    trajectory = recorded(robot, true["delay"][0], 1e-5, rng, seconds)
    unchanged = random_arm(np.random.default_rng(seed), joints, folder)
    found = identify(unchanged, trajectory)
    assert found.rms < 2e-5 < found.rms_before
    for parameter in found.parameters:
        index = found.joints.index(parameter.joint) if parameter.joint else 0
        wanted = true[parameter.name][index]
        assert parameter.value == pytest.approx(wanted, rel=0.05), parameter
        assert parameter.is_shown


def test_known_values_are_found_within_five_percent(tmp_path: Path):
    recovers(3, 1, tmp_path, seconds=1.6)


@pytest.mark.proof
@pytest.mark.parametrize("seed", range(6))
def test_known_values_of_random_arms_are_found_within_five_percent(seed: int, tmp_path: Path):
    recovers(seed, 2 + seed % 4, tmp_path, seconds=5.0)


def episode_of(robot: rc.Robot, delay: int, folder: Path) -> Path:
    """Records an episode whose commands hold for 20 steps and arrive `delay` steps late."""
    time, command = excitation(robot, 2, 25, seed=1)
    robot.scene.reset()
    place = "robots/arm"
    columns = {
        name: ColumnSpec(shape=robot.n_joints, units="rad")
        for name in (f"{place}/arm/qpos", f"{place}/arm/target", f"{place}/action/arm")
    }
    with EpisodeWriter(folder, "wave", {"time": ColumnSpec(units="s"), **columns}) as episode:
        for i, action in enumerate(command):
            before = command[max(0, i - 1)]
            rows = (robot.arm.joint_pos, before, action)
            episode.add_row({"time": time[i]} | dict(zip(columns, rows, strict=True)))
            for step in range(20 * i, 20 * i + 20):
                robot.jnt_pos_cmd[:] = command[max(0, (step - delay) // 20)]
                robot.update()
                robot.step()
        episode.commit(success=True)
    return folder / "wave"


def test_an_episode_whose_commands_hold_is_fitted(tmp_path: Path):
    robot = random_arm(np.random.default_rng(4), 1, tmp_path)
    model = robot.scene.model
    model.dof_damping.reshape(model.nv, -1)[:, 0] *= 1.5
    damping = float(model.dof_damping.flat[0])
    trajectory = ArmTrajectory.load(episode_of(robot, 4, tmp_path / "data"), robot)
    assert trajectory.holds
    trajectory.save(tmp_path / "wave.npz")
    assert ArmTrajectory.load(tmp_path / "wave.npz").holds
    unchanged = random_arm(np.random.default_rng(4), 1, tmp_path)
    found = identify(unchanged, trajectory, ["damping", "delay"])
    assert found.rms < 1e-4 < found.rms_before
    assert found.value("delay") == pytest.approx(4 * 0.002, rel=0.05)
    assert found.value("damping", "joint0") == pytest.approx(damping, rel=0.05)


def test_edits_give_the_model_what_is_known(tmp_path: Path):
    robot = random_arm(np.random.default_rng(2), 1, tmp_path)
    values = (("damping", 1.5, 0.1), ("frictionloss", 0.0, 1e-3), ("gain", 222.0, 1.0))
    parameters = [Parameter(name, "joint0", "", 3.0, value, error) for name, value, error in values]
    parameters.append(Parameter("armature", "joint0", "", 0.1, 0.7, np.inf))
    rows = np.zeros((1, 1))
    found = Identified(parameters, 1, 1, rows[0], rows, rows, ["joint0"])
    file = tmp_path / "arm.yaml"
    file.write_text(robot.scene.copy_spec().robots[0].config.to_yaml() + found.edits())
    spec = rc.SceneSpec(name="alone", timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="arm", config=rc.RobotConfig.load(file)))
    model, before = rc.Scene.build(spec).model, robot.scene.model
    assert model.dof_damping.flat[0] == 1.5
    assert model.dof_frictionloss[0] == 0
    assert model.actuator_gainprm[0, 0] == 222
    assert model.dof_armature[0] == before.dof_armature[0], "the motion does not show it"
    found.save(tmp_path / "fit.json")
    saved = json.loads((tmp_path / "fit.json").read_text(), parse_constant=pytest.fail)
    assert saved["parameters"][-1]["error"] is None
    unknown = Identified(parameters[-1:], 1, 1, rows[0], rows, rows, ["joint0"])
    assert not unknown.edits()


def test_a_value_that_the_motion_does_not_show_has_no_confidence(tmp_path: Path):
    rng = np.random.default_rng(5)
    robot = random_arm(rng, 2, tmp_path)
    time, command = excitation(robot, 0.5)
    still = np.tile(command[:1], (len(time), 1))
    found = identify(robot, ArmTrajectory.of(time, still, still + 1e-4), ["delay"])
    assert not found.parameters[0].is_shown


def test_the_command_prints_values_and_edits_and_writes_a_page(tmp_path: Path):
    robot = random_arm(np.random.default_rng(2), 1, tmp_path)
    robot_file = tmp_path / "arm.yaml"
    robot_file.write_text(robot.scene.copy_spec().robots[0].config.to_yaml())
    trajectory = recorded(robot, 0.008, 1e-5, np.random.default_rng(2), 0.8)
    trajectory.save(tmp_path / "wave.npz")
    result = robocell_command(
        "identify", robot_file, tmp_path / "wave.npz", "--fit", "delay", "--fit", "damping",
        "--output", tmp_path / "fit",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert "delay" in result.stdout
    assert '- {joint: "joint0", damping: ' in result.stdout
    assert json.loads((tmp_path / "fit.json").read_text())["rms"] < 2e-5
    page = (tmp_path / "fit.html").read_text()
    assert "Residuals" in page
    assert "<td>delay<td><td>0<td>0.008<td>" in page


def test_trajectories_that_do_not_fit_are_refused_with_the_reason(tmp_path: Path):
    robot = random_arm(np.random.default_rng(1), 2, tmp_path)
    time = np.linspace(0, 1, 50)
    rows = np.zeros((50, 2))
    for arrays, words in (
        ((time[::-1], rows, rows), "`time` must increase"),
        ((time[:5], rows[:5], rows[:5]), "at least 20"),
        ((time, rows[:, :1], rows), "`command` has the shape"),
        ((time, rows, 5.0), "`command` has the shape"),
        ((time, rows * np.nan, rows), "`command` has values that are not finite"),
    ):
        with pytest.raises(rc.ArgumentError, match=words):
            ArmTrajectory.of(*arrays)
    with pytest.raises(rc.ArgumentError, match="has 3 joints; the arm of robot 'arm' has 2"):
        identify(robot, ArmTrajectory.of(time, np.zeros((50, 3)), np.zeros((50, 3))))
    with pytest.raises(rc.ArgumentError, match="Did you mean 'damping'"):
        identify(robot, ArmTrajectory.of(time, rows, rows), ["dampng"])
    file = tmp_path / "wave.npz"
    ArmTrajectory.of(time, rows, rows).save(file)
    assert np.array_equal(ArmTrajectory.load(file).time, time)
    np.savez(file, time=time)
    with pytest.raises(rc.ArgumentError, match="no array `command`; it has time"):
        ArmTrajectory.load(file)
    array = tmp_path / "wave.npy"
    np.save(array, time)
    for content in (b"no archive", b"", b"PK\x03\x04 cut off", array.read_bytes()):
        file.write_bytes(content)
        with pytest.raises(rc.ArgumentError, match=r"no \.npz file"):
            ArmTrajectory.load(file)
    with pytest.raises(rc.ArgumentError, match="fewer than 20 commands"):
        excitation(robot, 0)
    with pytest.raises(rc.IoError, match="nowhere"):
        ArmTrajectory.load(tmp_path / "nowhere.npz")
