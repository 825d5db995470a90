"""Pose from Python; its laws are tested in C++."""

import copy
import pickle

import numpy as np
import pytest

import robocell as rc
from robocell import _pykdl

RNG = np.random.default_rng(1)


def random_pose() -> rc.Pose:
    q = RNG.normal(size=4)
    return rc.Pose(translation=RNG.normal(size=3), quaternion=q / np.linalg.norm(q))


def test_the_default_is_the_identity():
    assert rc.Pose() == rc.Pose(translation=[0, 0, 0], quaternion=[0, 0, 0, 1])
    np.testing.assert_array_equal(rc.Pose().matrix, np.eye(4))


@pytest.mark.parametrize("sequence", [list, tuple, np.array, np.float32])
def test_accepts_any_sequence_of_numbers(sequence):
    pose = rc.Pose(translation=sequence([1, 2, 3]), quaternion=sequence([0, 0, 0, 1]))
    np.testing.assert_array_equal(pose.translation, [1, 2, 3])


def test_strided_arrays_are_read_right():
    numbers = np.arange(12.0).reshape(3, 4)
    np.testing.assert_array_equal(rc.Pose(translation=numbers[:, 1]).translation, [1, 5, 9])


def test_all_representations_describe_the_same_pose():
    for _ in range(50):
        pose = random_pose()
        for other in (
            rc.Pose(pose.matrix),
            rc.Pose(np.asfortranarray(pose.matrix)),
            rc.Pose(pose),
            rc.Pose(translation=pose.translation, rotation=pose.rotation),
            rc.Pose(translation=pose.translation, rpy=pose.rpy),
            rc.Pose(translation=pose.translation, rotvec=pose.rotvec),
            rc.Pose(translation=pose.xyzrpy[:3], rpy=pose.xyzrpy[3:]),
        ):
            assert pose.is_close(other, 1e-9, 1e-12)
        np.testing.assert_array_equal(np.roll(pose.quaternion, 1), pose.quaternion_wxyz)


def test_products_and_inverse_agree_with_matrices():
    a, b = random_pose(), random_pose()
    np.testing.assert_allclose((a * b).matrix, a.matrix @ b.matrix, atol=1e-14)
    assert a @ b == a * b
    np.testing.assert_allclose(a.inverse().matrix, np.linalg.inv(a.matrix), atol=1e-14)
    np.testing.assert_allclose(a.transform([1, 2, 3]), (a.matrix @ [1, 2, 3, 1])[:3], atol=1e-14)


def test_interpolation_and_limits():
    a = rc.Pose(translation=[1, 0, 0], rpy=[0, 0, 1])
    assert rc.Pose().interpolate(a, 0.5).is_close(rc.Pose(translation=[0.5, 0, 0], rpy=[0, 0, 0.5]))
    assert np.linalg.norm(a.limit_translation(0.2).translation) == pytest.approx(0.2)
    assert a.limit_rotation(0.3).angle == pytest.approx(0.3)


def test_arrays_are_copies():
    pose = rc.Pose()
    pose.translation[0] = 1
    pose.matrix[0, 3] = 1
    assert pose == rc.Pose()
    with pytest.raises(AttributeError):
        pose.translation = [1, 2, 3]


def test_copies_and_pickles_are_exact():
    for _ in range(20):
        pose = random_pose()
        for other in (copy.copy(pose), copy.deepcopy(pose), pickle.loads(pickle.dumps(pose))):
            assert other == pose
            assert hash(other) == hash(pose)
    assert all(isinstance(number, float) for number in pose.__getstate__())


def test_repr_round_trips():
    pose = random_pose()
    assert eval(repr(pose), {"Pose": rc.Pose}) == pose
    assert pose != "pose"


def test_errors_explain_invalid_poses():
    with pytest.raises(rc.ArgumentError, match=r"quaternion"):
        rc.Pose(quaternion=[1, 1, 0, 0])
    with pytest.raises(rc.ArgumentError, match="translation must be 3 numbers, got 2"):
        rc.Pose(translation=[1, 2])
    with pytest.raises(TypeError, match=r"translation\[1\] must be a number, got str"):
        rc.Pose(translation=[1, "a", 3])
    with pytest.raises(TypeError, match="translation must be a list of numbers, got int"):
        rc.Pose(translation=1)
    with pytest.raises(rc.ArgumentError, match="matrix must be a 4x4 matrix, got 3 rows"):
        rc.Pose(np.eye(3))
    with pytest.raises(rc.ArgumentError, match="only one of quaternion, rpy"):
        rc.Pose(quaternion=[0, 0, 0, 1], rpy=[0, 0, 0])
    with pytest.raises(rc.ArgumentError, match="a matrix is the whole pose"):
        rc.Pose(np.eye(4), translation=[0, 0, 0])
    with pytest.raises(rc.ArgumentError):
        rc.Pose(translation=[np.nan, 0, 0])


def test_kdl_frames_round_trip():
    kdl = pytest.importorskip("PyKDL")
    for _ in range(20):
        pose = random_pose()
        frame = pose.to_kdl()
        assert isinstance(frame, kdl.Frame)
        for i in range(3):
            assert [frame.M[i, j] for j in range(3)] == pytest.approx(pose.rotation[i])
        assert rc.Pose(frame).is_close(pose, 1e-12, 1e-15)
        assert rc.Pose.from_kdl(frame) == rc.Pose(frame)


def test_without_pykdl_the_install_line_is_given(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "PyKDL", None)
    with pytest.raises(ImportError) as error:
        rc.Pose().to_kdl()
    assert str(error.value).endswith(_pykdl.remedy())


def test_minimum_jerk_is_a_motion_from_rest_to_rest():
    assert rc.control.minimum_jerk(-1, 2).position == 0
    assert rc.control.minimum_jerk(2, 2).position == 1
    assert rc.control.minimum_jerk(0, 0).position == 1
    h = 1e-4
    for time in np.linspace(0.1, 1.9, 19):
        before, now, after = (rc.control.minimum_jerk(time + d, 2) for d in (-h, 0, h))
        assert now.velocity == pytest.approx((after.position - before.position) / (2 * h), abs=1e-6)
        assert now.acceleration == pytest.approx(
            (after.velocity - before.velocity) / (2 * h), abs=1e-5
        )
    with pytest.raises(rc.ArgumentError, match="the duration of a motion must be >= 0 s, not -1"):
        rc.control.minimum_jerk(0, -1)


def test_durations_keep_the_limits_exactly():
    duration = rc.control.minimum_jerk_duration(0.3, 0.2, np.inf)
    fastest = max(
        rc.control.minimum_jerk(t, duration).velocity for t in np.linspace(0, duration, 1001)
    )
    assert 0.3 * fastest == pytest.approx(0.2, rel=1e-5)
    start, goal = [0, 0.5], np.array([0.3, -0.5])
    assert rc.control.joint_move_duration(
        start, goal, [1, 1], [np.inf] * 2
    ) == rc.control.minimum_jerk_duration(1, 1, np.inf)
    turn = rc.Pose(rotvec=[0, 0, 0.5]) * rc.Pose(translation=[0, 0.1, 0])
    assert rc.control.pose_move_duration(rc.Pose(), turn, angular_velocity=0.5) == pytest.approx(
        1.875
    )
    assert rc.control.pose_move_duration(rc.Pose(), turn, linear_velocity=0.1) == pytest.approx(
        1.875
    )
    with pytest.raises(rc.ArgumentError, match="max_velocity has 2 numbers, but the start has 1"):
        rc.control.joint_move_duration([0], [1], [1, 2], [1])
