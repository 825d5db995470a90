"""Scenes on pages: what is drawn is what the engine has, and pages act on it."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell as rc
from command_line import RC7
from robocell._channel import MisbehavedError
from robocell._cli.robot_scene import load_robot
from robocell._web.frame_hub import FrameHub
from robocell._web.live_scene import CHECKS, LiveScene, move_joint
from robocell._web.packed import unpacked
from robocell._web.scene_geometry import TYPES, body_poses, geometry_of


@pytest.fixture
def scene() -> rc.Scene:
    return load_robot(RC7).scene


def rotated(quaternion: list[float], points: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, np.array([w, x, y, z], float))
    return points @ matrix.reshape(3, 3).T


def test_shapes_stand_where_the_engine_has_them(scene: rc.Scene):
    rng = np.random.default_rng(0)
    scene.robot("rc7").set_joint_pos(rng.uniform(-0.5, 0.5, 7))
    header, array = unpacked(geometry_of(scene))
    model, data, poses = scene.model, scene.data, array(header["poses"])
    drawn = [i for i in range(model.ngeom) if int(model.geom_type[i]) in TYPES]
    assert len(drawn) == len(header["geoms"]) == model.ngeom
    for i, geom in zip(drawn, header["geoms"], strict=True):
        pose = poses[geom["body"]]
        place = pose[:3] + rotated(pose[3:], np.array(geom["pos"]))
        np.testing.assert_allclose(place, data.geom_xpos[i], atol=1e-5)
        corner = rotated(pose[3:], rotated(geom["quat"], np.eye(3)))
        np.testing.assert_allclose(corner.T, data.geom_xmat[i].reshape(3, 3), atol=1e-5)


def test_frames_are_where_the_scene_has_them(scene: rc.Scene):
    header, array = unpacked(geometry_of(scene))
    poses = array(header["poses"])
    frames = {frame["name"]: frame for frame in header["frames"]}
    for name, expected in (
        ("rc7 TCP", scene.robot("rc7").tcp_in_world),
        ("wrist_camera", scene.camera_pose("wrist_camera")),
    ):
        frame = frames[name]
        pose = poses[frame["body"]]
        place = pose[:3] + rotated(pose[3:], np.array(frame["pos"]))
        np.testing.assert_allclose(place, expected.translation, atol=1e-5)
        axes = rotated(pose[3:], rotated(frame["quat"], np.eye(3))).T
        np.testing.assert_allclose(axes, expected.rotation, atol=1e-5)


MESHES = """<mujoco>
  <asset>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
    <texture name="stripes" type="2d" builtin="checker" width="2048" height="8" rgb1="1 0 0"/>
    <texture name="cube" type="cube" builtin="flat" rgb1="0 1 0" width="4" height="24"/>
    <material name="striped" texture="stripes"/>
    <material name="boxed" texture="cube"/>
    <hfield name="hills" nrow="2" ncol="3" size="3 2 1 0.1" elevation="0 0.5 1 0 0.25 0.75"/>
  </asset>
  <worldbody>
    <geom type="hfield" hfield="hills"/>
    <geom type="box" size="1 1 1" material="striped" pos="0 0 5"/>
    <geom type="sphere" size="1" material="boxed" pos="0 0 9"/>
    <body pos="1 2 3"><freejoint/><geom type="mesh" mesh="wedge"/></body>
  </worldbody>
</mujoco>"""


def test_meshes_height_fields_and_textures_are_those_of_the_model(tmp_path: Path):
    (tmp_path / "parts.xml").write_text(MESHES)
    scene = rc.Scene.build(rc.SceneSpec(name="parts", base=str(tmp_path / "parts.xml")))
    header, array = unpacked(geometry_of(scene))
    [mesh] = header["meshes"].values()
    vertices, faces = array(mesh["vertices"]), array(mesh["faces"]).reshape(-1, 3)
    model = scene.model
    expected = model.mesh_vert[model.mesh_face]  # (faces, 3, 3)
    np.testing.assert_allclose(vertices[faces], expected, atol=1e-6)
    normals = array(mesh["normals"])[faces]
    np.testing.assert_allclose(normals, model.mesh_normal[model.mesh_facenormal], atol=1e-6)
    [field] = header["hfields"].values()
    grid = array(field["vertices"]).reshape(2, 3, 3)
    np.testing.assert_allclose(grid[:, :, 0], [[-3, 0, 3]] * 2)
    np.testing.assert_allclose(grid[:, :, 2].ravel(), model.hfield_data, atol=1e-6)
    a, b, c = grid.reshape(-1, 3)[array(field["faces"]).reshape(-1, 3)].swapaxes(0, 1)
    assert np.all(np.cross(b - a, c - a)[:, 2] > 0), "faces look up"
    [texture] = header["textures"].values()
    assert array(texture["pixels"]).shape == (4, 1024, 4)
    sphere = next(geom for geom in header["geoms"] if geom["type"] == "sphere")
    np.testing.assert_allclose(sphere["rgba"], [0, 1, 0, 1], atol=0.1)


def test_pages_pause_step_reset_and_move_joints(scene: rc.Scene):
    live = LiveScene(scene, "robot")
    page = live.visit()
    send = page.answer
    send({"op": "pause", "on": True})
    thread = threading.Thread(target=live.run)
    thread.start()

    def frame() -> dict:
        for _ in range(3):  # the last one was drawn after the commands were taken
            data = send({"op": "next"})
        return unpacked(data)[0]

    try:
        before = frame()
        assert before["paused"]
        send({"op": "step"})
        assert frame()["time"] == pytest.approx(before["time"] + scene.timestep())
        send({"op": "joint", "name": "joint1", "value": 0.4})
        send({"op": "opening", "name": "rc7", "value": 0.5})
        frame()
        header, array = unpacked(send({"op": "next"}))
        assert array(header["joints"])[0] == pytest.approx(0.4)
        send({"op": "joint", "name": "joint", "value": 0.4})
        assert "joint1" in frame()["message"]
        send({"op": "reset"})
        send({"op": "pause", "on": False})
        assert frame()["time"] < 1
        later = frame()
        assert later["time"] > 0
        assert later["message"] == ""
    finally:
        live.stop()
        thread.join(10)
        page.end()
    np.testing.assert_allclose(body_poses(scene)[:, :3], scene.data.xpos, atol=1e-6)


def test_a_joint_stays_within_its_limits(scene: rc.Scene):
    robot = scene.robot("rc7")
    move_joint(scene, "joint2", 99.0)
    assert robot.arm.joint_pos[1] == pytest.approx(robot.joint_limits[1][1])
    with pytest.raises(rc.NotFoundError, match="joint2"):
        move_joint(scene, "joint22", 0.0)


@pytest.mark.parametrize("operation", CHECKS)
def test_commands_with_wrong_parts_are_refused(operation: str):
    for parts in ({}, {"on": 1, "value": "x", "name": 3}, {"value": True, "on": "yes", "name": []}):
        message = json.loads(json.dumps({"op": operation, **parts}))
        if operation in ("step", "reset"):
            assert CHECKS[operation](message) == {}
        else:
            with pytest.raises(MisbehavedError):
                CHECKS[operation](message)


def test_a_scene_stands_still_without_pages(scene: rc.Scene):
    live = LiveScene(scene, "robot")
    thread = threading.Thread(target=live.run)
    thread.start()
    live.stop()
    thread.join(10)
    assert scene.time() == 0


def test_a_page_that_is_early_waits_for_the_shapes():
    hub = FrameHub()
    later = threading.Timer(0.05, hub.publish_geometry, [b"shapes"])
    later.start()
    reply = hub.geometry()
    assert reply is not None
    assert reply.content == b"shapes"
    later.join()
