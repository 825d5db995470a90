"""steps.h5 of generated episodes as plain h5py sees it: what is in there, and that it is true.

The files are written in C++ (src/robocell/data). They are read here with h5py alone; the engine is
the oracle for poses.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import h5py
import mujoco
import numpy as np
import plain_replay
import pytest
from generated_run import GeneratedRun, read_json
from numpy.typing import NDArray
from recorded_scene import ROBOT_PREFIX, RecordedScene

ROBOT = "robots/xarm7"
ARM = [f"joint{i}" for i in range(1, 8)]
FINGERS = [f"{side}_driver_joint" for side in ("left", "right")]
POSE = ["x", "y", "z", "qx", "qy", "qz", "qw"]
DISPLACEMENT = ["x", "y", "z", "rx", "ry", "rz"]
BASE = "base of xarm7"

# Column -> (shape of a row, units, frame, names); None: the attribute does not apply.
COLUMNS = {
    "time": ((), "s", None, None),
    f"{ROBOT}/arm/qpos": ((7,), "rad", None, ARM),
    f"{ROBOT}/arm/qvel": ((7,), "rad/s", None, ARM),
    f"{ROBOT}/arm/target": ((7,), "rad", None, ARM),
    f"{ROBOT}/gripper/qpos": ((2,), "rad", None, FINGERS),
    f"{ROBOT}/gripper/qvel": ((2,), "rad/s", None, FINGERS),
    f"{ROBOT}/gripper/target": ((1,), "1", None, ["opening"]),
    f"{ROBOT}/base_pose": ((7,), "m, 1", "world", POSE),
    f"{ROBOT}/tcp_pose": ((7,), "m, 1", "world", POSE),
    f"{ROBOT}/tcp_pose_in_base": ((7,), "m, 1", BASE, POSE),
    f"{ROBOT}/opening": ((), "1", None, None),
    f"{ROBOT}/action/arm": ((7,), "rad", None, ARM),
    f"{ROBOT}/action/arm_relative": ((7,), "rad", None, ARM),
    f"{ROBOT}/action/gripper": ((1,), "1", None, ["opening"]),
    f"{ROBOT}/action/gripper_relative": ((1,), "1", None, ["opening"]),
    f"{ROBOT}/action/tcp_pose": ((7,), "m, 1", BASE, POSE),
    f"{ROBOT}/action/tcp_displacement": ((6,), "m, rad", BASE, DISPLACEMENT),
    "objects/target/pose": ((7,), "m, 1", "world", POSE),
    "cameras/wrist/extrinsics": ((4, 4), "m, 1", "world -> camera, OpenCV axes", None),
    "cameras/exo/extrinsics": ((4, 4), "m, 1", "world -> camera, OpenCV axes", None),
    "phase": ((), None, None, None),
    "reward": ((), "1", None, None),
    "success": ((), None, None, None),
    "terminated": ((), None, None, None),
    "truncated": ((), None, None, None),
    "ik_failed": ((), None, None, None),
    "engine_warnings": ((), None, None, None),
}

Array = NDArray[np.float64]


def arrays(steps: h5py.File) -> dict[str, h5py.Dataset]:
    """Every array of a file by its path."""
    found: dict[str, h5py.Dataset] = {}
    steps.visititems(
        lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None
    )
    return found


@pytest.fixture(scope="module")
def every_steps(xarm7_run: GeneratedRun) -> dict[Path, h5py.File]:
    """All episodes' files, open."""
    return {episode: h5py.File(episode / "steps.h5") for episode in xarm7_run.episodes()}


@pytest.fixture(scope="module")
def scene(xarm7_run: GeneratedRun, tmp_path_factory: pytest.TempPathFactory) -> RecordedScene:
    """One episode, rebuilt."""
    return RecordedScene(xarm7_run.episodes()[0], tmp_path_factory.mktemp("scene"))


@pytest.mark.proof
def test_every_array_is_as_long_as_its_table(every_steps: dict[Path, h5py.File]):
    for episode, steps in every_steps.items():
        tables = read_json(episode)["tables"]
        assert steps.attrs["rows"] == tables["steps"]["rows"] == len(steps["time"])
        assert steps["control"].attrs["rows"] == tables["control"]["rows"]
        constants = set()
        for name, array in arrays(steps).items():
            if "table" in array.attrs:
                assert len(array) == tables[array.attrs["table"]]["rows"], f"{episode}: {name}"
            else:
                constants.add(name)
        assert constants == {
            "initial_state",
            "cameras/wrist/intrinsics",
            "cameras/exo/intrinsics",
        }


def test_columns_have_the_promised_shapes_units_frames_and_names(
    every_steps: dict[Path, h5py.File],
):
    for steps in every_steps.values():
        for name, (shape, units, frame, names) in COLUMNS.items():
            column = steps[name]
            assert column.shape[1:] == shape, name
            assert column.attrs.get("units") == units, name
            assert column.attrs.get("frame") == frame, name
            own = column.attrs.get("names")
            assert (None if own is None else list(own)) == names, name
        for name in ("success", "terminated", "truncated", "ik_failed"):
            assert steps[name].dtype == bool, "booleans arrive as booleans"


def test_numbers_are_finite_and_quaternions_are_unit(every_steps: dict[Path, h5py.File]):
    for steps in every_steps.values():
        for name, array in arrays(steps).items():
            values = array[:]
            assert np.all(np.isfinite(values)), name
            if list(array.attrs.get("names", [])) == POSE:
                norms = np.linalg.norm(values[:, 3:], axis=1)
                np.testing.assert_allclose(norms, 1, atol=1e-9, err_msg=name)


def test_time_stamps_are_multiples_of_the_periods(every_steps: dict[Path, h5py.File]):
    for episode, steps in every_steps.items():
        rates = read_json(episode)["metadata"]["rates"]
        periods = {"time": "policy_ms", "control/time": "control_ms"}
        for name, period in periods.items():
            expected = np.arange(len(steps[name])) * rates[period] / 1000
            np.testing.assert_allclose(steps[name][:], expected, rtol=0, atol=1e-9, err_msg=name)
        ticks = round(rates["policy_ms"] / rates["control_ms"])
        assert len(steps["control/time"]) == ticks * len(steps["time"])
        for camera in ("wrist", "exo"):
            attrs = steps[f"cameras/{camera}"].attrs
            assert attrs["fps_den"] / attrs["fps_num"] == rates["policy_ms"] / 1000


def test_a_row_is_the_state_before_its_action(scene: RecordedScene):
    steps, arm = scene.steps, f"{ROBOT}/arm"
    model, data = plain_replay.load(scene.binary)
    ticks = len(steps["control/ctrl"]) // len(steps["time"])
    servos = [model.actuator(f"{ROBOT_PREFIX}act{i}").id for i in range(1, 8)]
    mujoco.mj_setState(model, data, steps["initial_state"][:], plain_replay.FULL_STATE)
    assert plain_replay.joint_error(model, data, steps, 0) == 0
    assert plain_replay.object_error(model, data, steps, 0) <= 1e-12
    # From row i on, the engine gets action i: its servos get these positions.
    acting = steps["control/ctrl"][:].reshape(-1, ticks, model.nu)[:, :, servos]
    actions = steps[f"{ROBOT}/action/arm"][:]
    np.testing.assert_array_equal(acting, np.repeat(actions[:, None], ticks, axis=1))
    assert np.abs(np.diff(actions, axis=0)).max() > 0.01, "actions differ"
    assert np.abs(np.diff(steps[f"{arm}/qpos"][:], axis=0)).max() > 0.01


def test_targets_interpolate_between_actions(every_steps: dict[Path, h5py.File]):
    for steps in every_steps.values():
        for group in ("arm", "gripper"):
            target = steps[f"{ROBOT}/{group}/target"][:]
            action = steps[f"{ROBOT}/action/{group}"][:]
            relative = steps[f"{ROBOT}/action/{group}_relative"][:]
            np.testing.assert_array_equal(target[1:], action[:-1])
            np.testing.assert_allclose(relative, action - target, atol=1e-15)
        grip = steps[f"{ROBOT}/action/gripper"][:, 0]
        assert (grip[0], grip[-1]) == (1, 0), "it goes there open and ends closed"


def matrix(pose: Array) -> Array:
    """4x4 of a row of a pose column."""
    rotation, result = np.zeros(9), np.eye(4)
    mujoco.mju_quat2Mat(rotation, np.roll(pose[3:], 1))
    result[:3, :3], result[:3, 3] = rotation.reshape(3, 3), pose[:3]
    return result


def poses_of_engine(scene: RecordedScene) -> Iterator[tuple[int, mujoco.MjModel, mujoco.MjData]]:
    """The engine at every row, its poses computed from the joints of that very row."""
    model, data = plain_replay.load(scene.binary)
    for row, state in enumerate(scene.states()[:-1]):
        mujoco.mj_setState(model, data, state, plain_replay.FULL_STATE)
        mujoco.mj_kinematics(model, data)
        yield row, model, data


def engine_pose(position: Array, rotation: Array) -> Array:
    """4x4 of an element of the engine's data."""
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = rotation.reshape(3, 3), position
    return result


def test_pose_columns_match_the_joints_of_their_row(scene: RecordedScene):
    steps = scene.steps
    for row, _, data in poses_of_engine(scene):
        tcp, base = data.site(f"{ROBOT_PREFIX}link_tcp"), data.body(f"{ROBOT_PREFIX}link_base")
        X_WT, X_WB = engine_pose(tcp.xpos, tcp.xmat), engine_pose(base.xpos, base.xmat)
        target = data.body("target")
        X_WO = engine_pose(target.xpos, target.xmat)
        close = {"rtol": 0, "atol": 1e-9, "err_msg": f"row {row}"}
        np.testing.assert_allclose(matrix(steps[f"{ROBOT}/tcp_pose"][row]), X_WT, **close)
        np.testing.assert_allclose(matrix(steps[f"{ROBOT}/base_pose"][row]), X_WB, **close)
        np.testing.assert_allclose(matrix(steps["objects/target/pose"][row]), X_WO, **close)
        X_BT = np.linalg.inv(X_WB) @ X_WT
        np.testing.assert_allclose(matrix(steps[f"{ROBOT}/tcp_pose_in_base"][row]), X_BT, **close)


def test_the_tcp_action_matches_the_commanded_joints(scene: RecordedScene):
    steps = scene.steps
    action, twist = (
        steps[f"{ROBOT}/action/tcp_pose"][:],
        steps[f"{ROBOT}/action/tcp_displacement"][:],
    )
    present = steps[f"{ROBOT}/tcp_pose_in_base"][:]
    commanded = steps[f"{ROBOT}/action/arm"][:]
    for row, model, data in poses_of_engine(scene):
        data.qpos[[model.joint(ROBOT_PREFIX + name).qposadr[0] for name in ARM]] = commanded[row]
        mujoco.mj_kinematics(model, data)
        tcp, base = data.site(f"{ROBOT_PREFIX}link_tcp"), data.body(f"{ROBOT_PREFIX}link_base")
        X_BT = np.linalg.inv(engine_pose(base.xpos, base.xmat)) @ engine_pose(tcp.xpos, tcp.xmat)
        np.testing.assert_allclose(matrix(action[row]), X_BT, rtol=0, atol=1e-9)
        turn = matrix(action[row])[:3, :3] @ matrix(present[row])[:3, :3].T
        quaternion, vector = np.zeros(4), np.zeros(3)
        mujoco.mju_mat2Quat(quaternion, turn.flatten())
        mujoco.mju_quat2Vel(vector, quaternion, 1)
        np.testing.assert_allclose(twist[row, :3], action[row, :3] - present[row, :3], atol=1e-12)
        np.testing.assert_allclose(twist[row, 3:], vector, rtol=0, atol=1e-7)


def test_reward_success_and_end_match_the_physics(every_steps: dict[Path, h5py.File]):
    for episode, steps in every_steps.items():
        risen = steps["objects/target/pose"][:, 2] - steps["objects/target/pose"][0, 2]
        reward, success = steps["reward"][:], steps["success"][:]
        # The outcome of action i is the state of row i + 1.
        tcp = steps[f"{ROBOT}/tcp_pose"][:, :3]
        away = np.linalg.norm(tcp - steps["objects/target/pose"][:, :3], axis=1)
        progress = 0.5 * (1 - np.tanh(5 * away)) + 0.5 * np.clip(risen / 0.05, 0, 1)
        expected = np.where(success[:-1], 1, progress[1:])
        np.testing.assert_allclose(reward[:-1], expected, rtol=0, atol=1e-9)
        assert np.all(risen[1:][success[:-1]] >= 0.05), episode.name
        assert success[-1], episode.name
        assert not success[0], episode.name
        assert np.flatnonzero(steps["terminated"][:]).tolist() == [len(risen) - 1]
        assert not steps["truncated"][:].any()
        assert not steps["engine_warnings"][:].any()
        assert not steps["ik_failed"][:].any()


def test_phases_are_named_and_ordered(every_steps: dict[Path, h5py.File]):
    for steps in every_steps.values():
        names = list(steps["phase"].attrs["values"])
        assert names == ["open", "pregrasp", "grasp", "close", "lift", "done"]
        seen = [names[number] for number in dict.fromkeys(steps["phase"][:].tolist())]
        assert seen == names, "in this order; a retry goes back"
        opening = steps[f"{ROBOT}/opening"][:]
        assert opening.min() >= -0.05
        assert opening.max() <= 1.05
        closed = steps["phase"][:] == names.index("lift")
        assert opening[closed].max() < opening[0] - 0.05, "it holds something smaller than its span"
