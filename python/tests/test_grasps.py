"""Grasps from Python: sets, files, libraries, reach and proof."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc


@pytest.fixture(scope="module")
def scene() -> rc.Scene:
    """A box in reach of the built-in arm."""
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    box = rc.SceneObject(name="box", shape=rc.Shape.BOX, size=[0.02, 0.03, 0.05])
    box.pos, box.mass = [0.42, 0.1, 0.05], 0.1
    box.rgba, box.friction = [0.5, 0.5, 0.5, 1], [1, 0.05, 0.001]
    spec.objects.append(box)
    built = rc.Scene.build(spec)
    built.reset()
    return built


@pytest.fixture
def box(scene: rc.Scene) -> rc.tasks.GraspSet:
    return rc.tasks.grasps(scene.robot("rc7"), "box", samples=300, most=30, stored=False)


def test_a_set_is_an_array_of_poses(scene: rc.Scene, box: rc.tasks.GraspSet) -> None:
    assert 5 < len(box) <= 30
    poses = np.asarray(box)
    assert poses.shape == (len(box), 4, 4)
    np.testing.assert_array_equal(poses[3], box[3].tcp_in_body.matrix)
    np.testing.assert_array_equal(box.widths, [grasp.width for grasp in box])
    assert box.kinds == [grasp.kind for grasp in box]
    body = scene.body_pose(box.body).matrix
    np.testing.assert_allclose(box.in_world(scene), body @ poses, atol=1e-12)
    assert (np.diff(box.scores) <= 0).all()
    assert [grasp.width for grasp in box.select([2, 0])] == [box[2].width, box[0].width]
    with pytest.raises(IndexError, match="grasp 99 of"):
        box[99]
    for grasp in box:
        back = grasp.tcp_in_body.translation - grasp.before.translation
        np.testing.assert_allclose(back, grasp.approach_length * grasp.approach, atol=1e-9)


def test_widths_are_those_of_the_box(box: rc.tasks.GraspSet) -> None:
    faces = np.array([0.04, 0.06])
    for grasp in box:
        # A leaning pad touches an edge first.
        assert np.abs(faces - grasp.width).min() < 0.004


def test_some_are_reachable_and_are_goals_of_a_plan(
    scene: rc.Scene, box: rc.tasks.GraspSet
) -> None:
    robot = scene.robot("rc7")
    found = box.reachable(robot, most=2, lift=0.05)
    assert found
    assert [each.cost for each in found] == sorted(each.cost for each in found)
    first = found[0]
    assert first.way.shape[1] == robot.n_joints
    assert robot.fk_frame(first.way[-1]).is_close(
        robot.base_in_world.inverse() * first.tcp_in_world, 1e-3, 1e-3
    )
    assert robot.plan(box.goals(scene, most=20)).success


def test_a_library_in_numpy_s_format_is_read(
    scene: rc.Scene, box: rc.tasks.GraspSet, tmp_path: Path
) -> None:
    folder = tmp_path / "box" / "rc7"
    folder.mkdir(parents=True)
    poses = np.asarray(box)[:4]
    for save in (np.savez, np.savez_compressed):
        for dtype in (np.float64, np.float32):
            save(folder / "grasps.npz", transforms=np.asfortranarray(poses.astype(dtype)))
            rc.tasks.register_grasp_library("mine", tmp_path)
            assert "mine" in rc.tasks.grasp_libraries()
            read = rc.tasks.grasps(scene.robot("rc7"), "box")
            np.testing.assert_allclose(read.tcp_in_body, poses, atol=1e-6)
            assert (read.openings > 0.08).all()  # the hand opens fully
            rc.tasks.unregister_grasp_library("mine")


def test_numpy_reads_what_is_saved(scene: rc.Scene, box: rc.tasks.GraspSet, tmp_path: Path) -> None:
    box.save(tmp_path / "grasps.npz")
    with np.load(tmp_path / "grasps.npz") as file:
        np.testing.assert_array_equal(file["transforms"], box.tcp_in_body)
        np.testing.assert_array_equal(file["scores"], box.scores)
        assert list(file["kinds"]) == box.kinds
    again = rc.tasks.load_grasps(tmp_path / "grasps.npz", scene.robot("rc7"), "box")
    np.testing.assert_allclose(again.tcp_in_body, box.tcp_in_body, atol=1e-12)
    assert again.kinds == box.kinds


def test_loaded_grasps_are_as_good_as_generated_ones(
    scene: rc.Scene, box: rc.tasks.GraspSet, tmp_path: Path
) -> None:
    """Poses alone are enough: the rest follows from the robot and the object."""
    robot = scene.robot("rc7")
    np.savez(tmp_path / "poses.npz", transforms=box.tcp_in_body)
    loaded = rc.tasks.load_grasps(tmp_path / "poses.npz", robot, "box")
    assert (loaded.robot, loaded.body) == (box.robot, box.body)
    np.testing.assert_allclose(loaded.in_world(scene), box.in_world(scene), atol=1e-12)
    assert (loaded.openings > 0.05).all()
    for one, other in zip(loaded, box, strict=True):
        np.testing.assert_allclose(one.approach, other.approach, atol=1e-6)
    assert loaded.reachable(robot, most=1)
    assert len(loaded.goals(scene, most=3)) == 3
    assert len(loaded.select([0]).prove(robot)) == 1


def test_errors_name_what_is_wrong(scene: rc.Scene, tmp_path: Path) -> None:
    robot = scene.robot("rc7")
    with pytest.raises(rc.NotFoundError, match="Did you mean 'box'"):
        rc.tasks.grasps(robot, "bok")
    with pytest.raises(rc.NotFoundError, match="Did you mean 'side'"):
        rc.tasks.grasps(robot, "box", kinds="sied")
    rc.tasks.grasps(robot, "box", samples=50, most=5, stored=False)
    with pytest.raises(rc.NotFoundError, match="typo"):  # remembered grasps do not hide it
        rc.tasks.grasps(robot, "box", geoms="typo", samples=50, most=5, stored=False)
    with pytest.raises(rc.ArgumentError, match="samples must be from 1 to"):
        rc.tasks.grasps(robot, "box", samples=2**31 - 1)
    with pytest.raises(rc.NotFoundError, match="is not a folder"):
        rc.tasks.register_grasp_library("mine", tmp_path / "nothing")
    np.savez(tmp_path / "bad.npz", transforms=np.zeros((2, 4, 4)))
    with pytest.raises(rc.IoError, match=r"bad.npz: transforms\[0\] is not a rigid transform"):
        rc.tasks.load_grasps(tmp_path / "bad.npz", robot, "box")
    np.savez(tmp_path / "objects.npz", transforms=np.array([None, {}], dtype=object))
    with pytest.raises(rc.IoError, match="Python objects"):
        rc.tasks.load_grasps(tmp_path / "objects.npz", robot, "box")


def test_shaking_proves_a_grasp(scene: rc.Scene, box: rc.tasks.GraspSet) -> None:
    proofs = box.select([0, 1, 2]).prove(scene.robot("rc7"))
    assert sum(proof.held for proof in proofs) >= 2, [proof.failure for proof in proofs]
