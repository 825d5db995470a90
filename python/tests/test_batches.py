"""Kinematics of many configurations at once: engine, single calls, shapes, outputs, errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest

import robocell as rc

GRAVITY = (1.0, -2.0, -9.0)


@pytest.fixture(scope="module")
def robot() -> rc.Robot:
    """The built-in arm on a tilted mount."""
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.gravcomp = False
    arm = rc.RobotSpec(name="a", config=config, pos=[0.3, 0, 1], euler=[20, -35, 110])
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False, robots=[arm])
    robot = rc.Scene.build(spec).robot("a")
    robot.refresh_tool_inertia()  # weighs the gripper where its fingers are
    return robot


def positions(count: int) -> np.ndarray:
    return np.random.default_rng(7).uniform(-1, 1, size=(count, 7))


def test_batches_match_the_engine(robot: rc.Robot):
    scene, k = robot.scene, robot.kinematics
    model, data = scene.model, scene.data
    at = [model.joint(name).dofadr[0] for name in robot.joint_names]
    q = positions(9)
    qd, qdd = np.random.default_rng(8).normal(size=(2, 9, 7))
    tips, masses, gravity = k.fk(q), k.mass_matrix(q), k.gravity_torques(q)
    motion = k.inverse_dynamics(q, qd, qdd)
    assert tips.shape == (9, 4, 4)
    full = np.zeros((model.nv, model.nv))
    for i in range(9):
        robot.set_joint_pos(q[i])
        assert rc.Pose(tips[i]).is_close(robot.fk_frame(), 1e-12, 1e-12)
        mujoco.mj_fullM(model, data, full)
        mass = full[np.ix_(at, at)]
        np.testing.assert_allclose(masses[i], mass, atol=1e-10)
        np.testing.assert_allclose(gravity[i], data.qfrc_bias[at], atol=1e-9)
        data.qvel[at] = qd[i]
        scene.forward()
        needed = mass @ qdd[i] + data.qfrc_bias[at]
        np.testing.assert_allclose(motion[i], needed, atol=1e-9)
        data.qvel[:] = 0


def test_jacobians_are_the_slopes_of_tips(robot: rc.Robot):
    k, q, h = robot.kinematics, positions(5), 1e-6
    jacobians = k.jacobian(q)
    assert jacobians.shape == (5, 6, 7)
    for joint in range(7):
        step = np.zeros(7)
        step[joint] = h
        slope = (k.fk(q + step) - k.fk(q - step))[:, :3, 3] / (2 * h)
        np.testing.assert_allclose(jacobians[:, :3, joint], slope, atol=1e-8)


def test_a_batch_matches_its_rows_and_one_row_broadcasts(robot: rc.Robot):
    k, chain, q = robot.kinematics, robot.chain, positions(11)
    for call in (
        *(k.fk, k.jacobian, k.mass_matrix, k.gravity_torques, chain.mass_matrix),
        *(k.manipulability, chain.manipulability, lambda q: k.coriolis_torques(q, np.cos(q))),
    ):
        whole = call(q)
        for i in range(11):
            assert np.array_equal(call(q[i : i + 1])[0], whole[i])
    assert np.array_equal(k.jacobian(q[3]), k.jacobian(q)[3])
    assert np.array_equal(k.fk(q[3], out=np.empty((4, 4))), k.fk(q)[3])
    assert k.fk(q[3]).is_close(rc.Pose(k.fk(q)[3]), 1e-14, 1e-14)
    still = [0] * 7
    everywhere = np.broadcast_to(np.array(still), (11, 7))
    one = k.inverse_dynamics(q, still, q[0], GRAVITY)
    many = k.inverse_dynamics(q, everywhere, np.tile(q[0], (11, 1)), np.tile(GRAVITY, (11, 1)))
    assert np.array_equal(one, many)
    np.testing.assert_allclose(chain.gravity_torques(q, GRAVITY), k.gravity_torques(q, GRAVITY))
    assert k.gravity_torques(q[0], np.tile(GRAVITY, (3, 1))).shape == (3, 7)
    assert k.mass_matrix(np.zeros((0, 7))).shape == (0, 7, 7)
    assert k.manipulability(np.zeros((0, 7))).shape == (0,)
    volumes = [k.manipulability(row) for row in q]
    assert all(isinstance(volume, float) for volume in volumes)
    np.testing.assert_allclose(k.manipulability(q), volumes, rtol=1e-9)
    np.testing.assert_allclose(
        k.coriolis_torques(q, np.cos(q)), k.inverse_dynamics(q, np.cos(q), still, [0, 0, 0])
    )


def test_accepts_any_sequence_of_numbers(robot: rc.Robot):
    k, q = robot.kinematics, positions(4)
    expected = k.gravity_torques(q)
    for form in (q.tolist(), list(q), tuple(map(tuple, q)), np.asfortranarray(q), q[::-1][::-1]):
        assert np.array_equal(k.gravity_torques(form), expected)
    whole = np.round(q).astype(int)
    assert np.array_equal(k.gravity_torques(whole), k.gravity_torques(whole.astype(float)))


def test_results_are_written_into_the_given_arrays(robot: rc.Robot):
    k, q = robot.kinematics, positions(6)
    zeros = np.zeros((6, 7))
    calls: list[tuple[Callable[..., Any], tuple[np.ndarray, ...], tuple[int, ...]]] = [
        (k.fk, (q,), (4, 4)),
        (k.jacobian, (q,), (6, 7)),
        (k.mass_matrix, (q,), (7, 7)),
        (k.gravity_torques, (q,), (7,)),
        (k.inverse_dynamics, (q, zeros, zeros), (7,)),
        (k.coriolis_torques, (q, np.cos(q)), (7,)),
        (k.manipulability, (q,), ()),
    ]
    for call, arguments, shape in calls:
        out = np.full((6, *shape), np.nan)
        assert call(*arguments, out=out) is out
        assert np.array_equal(out, call(*arguments))
        one = np.empty(shape)
        assert call(*(argument[2] for argument in arguments), out=one) is one
        assert np.array_equal(one, out[2])
    part = np.zeros((10, 7))
    k.gravity_torques(q, out=part[2:8])
    assert np.array_equal(part[2:8], k.gravity_torques(q))
    assert not part[:2].any()
    assert not part[8:].any()


def test_jacobians_include_the_poses_of_forward_kinematics(robot: rc.Robot):
    for k in (robot.kinematics, robot.chain):
        q = positions(6)
        tips, out = np.full((6, 4, 4), np.nan), np.empty((6, 6, 7))
        assert k.jacobian(q, out=out, tips=tips) is out
        assert np.array_equal(out, k.jacobian(q))
        assert np.array_equal(tips, k.fk(q))
        one = np.empty((4, 4))
        assert np.array_equal(k.jacobian(q[2], tips=one), out[2])
        assert np.array_equal(one, tips[2])


READ_ONLY = np.zeros((6, 7))
SHARED = np.zeros(56)
READ_ONLY.flags.writeable = False
EXPECTED_OUT = "out must be a writable, C-contiguous float64 array of shape (6, 7), got "


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda k, q: k.fk(q[:, :6]),
            ValueError,
            "q must be numbers of shape (7,), or (B, 7) for a batch, has shape (6, 6)",
        ),
        (
            lambda k, q: k.mass_matrix(q[None]),
            ValueError,
            "q must be numbers of shape (7,), or (B, 7) for a batch, has shape (1, 6, 7)",
        ),
        (
            lambda k, q: k.jacobian(q + 1j),
            TypeError,
            "q must be numbers of shape (7,), or (B, 7) for a batch, got complex128",
        ),
        (lambda k, q: k.jacobian([[1, 2], [3]]), TypeError, "q must be numbers of shape (7,), or"),
        (lambda k, q: k.jacobian(3.0), ValueError, "q must be numbers of shape (7,), or (B, 7) "),
        (lambda k, q: k.fk(["a"] * 7), TypeError, "q[0] must be a number, got "),
        (
            lambda k, q: k.inverse_dynamics(q, q[:5], q),
            ValueError,
            "qd is for 5 configurations, but q for 6",
        ),
        (
            lambda k, q: k.coriolis_torques(q, q[:, :2]),
            ValueError,
            "qd must be numbers of shape (7,), or (B, 7) for a batch, has shape (6, 2)",
        ),
        (
            lambda k, q: k.manipulability(q, out=np.zeros((6, 1))),
            ValueError,
            "out must have shape (6,), has (6, 1)",
        ),
        (
            lambda k, q: k.gravity_torques(q, [0, 0]),
            ValueError,
            "gravity must be numbers of shape (3,), or (B, 3) for a batch, has shape (2,)",
        ),
        (
            lambda k, q: k.gravity_torques(q, [0, 0, float("nan")]),
            ValueError,
            "gravity[2] must be finite, is nan",
        ),
        (
            lambda k, q: k.gravity_torques(q[:2], [[0, 0, 0], [0, float("inf"), 0]]),
            ValueError,
            "gravity[1][1] must be finite, is inf",
        ),
        (
            lambda k, q: k.mass_matrix(np.where(q == q[4, 2], np.inf, q)),
            ValueError,
            "q[4]: joint 'joint3' is inf; joint values must be finite",
        ),
        (
            lambda k, q: k.gravity_torques(q, out=np.zeros((6, 7), np.float32)),
            ValueError,
            EXPECTED_OUT + "float32 of shape (6, 7) that is not",
        ),
        (
            lambda k, q: k.gravity_torques(q, out=np.zeros((7, 6)).T),
            ValueError,
            EXPECTED_OUT + "float64 of shape (6, 7) that is not",
        ),
        (
            lambda k, q: k.gravity_torques(q, out=READ_ONLY),
            ValueError,
            EXPECTED_OUT + "float64 of shape (6, 7) that is not",
        ),
        (
            lambda k, q: k.gravity_torques(q, out=np.zeros((5, 7))),
            ValueError,
            "out must have shape (6, 7), has (5, 7)",
        ),
        (lambda k, q: k.gravity_torques(q, out=[0.0] * 7), TypeError, "out must be a writable, "),
        (
            lambda k, q: k.gravity_torques(q, out=q),
            ValueError,
            "out shares memory with q; give it its own",
        ),
        (
            lambda k, q: k.jacobian(q, tips=np.zeros((6, 3, 4))),
            ValueError,
            "tips must have shape (6, 4, 4), has (6, 3, 4)",
        ),
        (
            lambda k, q: k.jacobian(q, tips=np.zeros((6, 4, 4), np.float32)),
            ValueError,
            "tips must be a writable, C-contiguous float64 array of shape (6, 4, 4), got float32",
        ),
        (
            lambda k, q: k.jacobian(q[0], SHARED[:42].reshape(6, 7), SHARED[40:56].reshape(4, 4)),
            ValueError,
            "out shares memory with tips; give it its own",
        ),
    ],
)
def test_errors_name_the_wrong_row_and_value(
    robot: rc.Robot,
    call: Callable[[rc.kinematics.Kinematics, np.ndarray], Any],
    error: type[Exception],
    message: str,
):
    with pytest.raises(error) as caught:
        call(robot.kinematics, positions(6))
    assert message in str(caught.value)
