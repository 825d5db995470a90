"""EnvConfig from Python, and the scene that it becomes."""

from __future__ import annotations

import copy
import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest

import robocell as rc

RC7 = rc.models.robot_file("rc7")
BOX = '<mujoco><worldbody><body name="box"><geom size=".02"/></body></worldbody></mujoco>'


def at(x: float, y: float, z: float) -> rc.Pose:
    return rc.Pose(translation=[x, y, z])


@pytest.fixture
def box(tmp_path: Path) -> Path:
    path = tmp_path / "box.xml"
    path.write_text(BOX)
    return path


@pytest.fixture
def duo() -> rc.EnvConfig:
    """Two of the built-in robot on a rig that stands beside the origin."""
    return rc.EnvConfig(
        name="duo",
        robots={"left": RC7, "right": rc.RobotConfig.load(RC7)},
        robot_to_shared_base_frame={"left": at(0, 0.3, 0), "right": at(0, -0.3, 0)},
        shared_base_frame_to_root_frame=at(0, 0, 0.34),
        root_frame_to_world=rc.Pose(translation=[1, 2, 0], rpy=[0.1, 0.2, 0.3]),
    )


class TestConfig:
    def test_robots_can_be_given_as_files(self, duo):
        assert duo.robots["left"] == duo.robots["right"]
        assert duo.robots["left"].name == "rc7"

    def test_objects_are_a_pair_of_file_and_pose(self, duo, box):
        duo.world_frame_objects = {"lamp": (box, at(0, 0, 1))}
        duo.robot_frame_objects = {"left": {"mount": (str(box), rc.Pose())}}
        assert duo.world_frame_objects["lamp"].offset == at(0, 0, 1)
        assert duo.robot_frame_objects["left"]["mount"].mjcf_path == str(box)
        with pytest.raises(TypeError, match=r"world_frame_objects\.lamp\.offset must be a Pose"):
            duo.world_frame_objects = {"lamp": (box, 3)}

    def test_mappings_of_mappings_are_edited_in_place(self, duo, box):
        duo.robot_frame_objects["left"] = {}
        of_left = duo.robot_frame_objects["left"]
        of_left["mount"] = rc.envs.EnvObject(mjcf_path=str(box))
        of_left["mount"].offset = at(0, 0, 2)
        assert duo.robot_frame_objects["left"]["mount"].offset == at(0, 0, 2)
        for other in (copy.deepcopy(duo), pickle.loads(pickle.dumps(duo))):
            assert other == duo
            other.robot_frame_objects["left"]["mount"].offset = at(0, 0, 3)
            assert other != duo

    def test_a_single_number_is_a_limit_for_joints(self):
        config = rc.EnvConfig(max_relative_movement=0.1)
        assert config.max_relative_movement == (0.1,)
        config.max_relative_movement = (0.1, 0.2)
        assert config.max_relative_movement == (0.1, 0.2)

    def test_a_yaml_file_is_the_same_configuration(self, duo, box):
        duo.robot_frame_objects = {"left": {"mount": (str(box), at(0, 0, 1))}}
        duo.camera_adds = {"wrist": rc.envs.CameraAdderConfig(robot_name="left", fovy=50)}
        duo.cameras = {"streams": [{"name": "wrist", "camera": "wrist"}]}
        duo.control_mode = "cartesian_tquat"
        assert rc.EnvConfig.from_yaml(duo.to_yaml()) == duo

    def test_a_pickled_configuration_finds_its_robot_files(self, tmp_path):
        folder = tmp_path / "arm"
        shutil.copytree(Path(RC7).parent, folder)
        (folder / "rc7.xml").rename(folder / "own.xml")
        robot = folder / "own.yaml"
        robot.write_text((folder / "rc7.yaml").read_text().replace("rc7.xml", "own.xml"))
        config = rc.EnvConfig(robots={"robot": robot})
        for other in (copy.copy(config), pickle.loads(pickle.dumps(config))):
            assert rc.Scene.build(rc.envs.env_scene_spec(other)).name == "env"


class TestMistakes:
    """The mistakes that are easily made, and what says which frame or name was expected."""

    def message(self, config: rc.EnvConfig) -> str:
        with pytest.raises(rc.SpecError) as error:
            rc.envs.env_scene_spec(config)
        return str(error.value)

    def test_rejects_one_object_in_two_frames(self, duo, box):
        duo.world_frame_objects = {"cube": (box, rc.Pose())}
        duo.root_frame_objects = {"cube": (box, rc.Pose())}
        assert (
            "environment 'duo' is not valid: root_frame_objects.cube: is in world_frame_objects "
            "too; keep one of them (world_frame_objects stay in the room, root_frame_objects move "
            "with the rig" in self.message(duo)
        )

    def test_the_frame_of_a_cameras_offset(self, duo):
        duo.cameras = {"streams": [{"name": "eye", "camera": "eye"}]}
        duo.camera_adds = {"eye": rc.envs.CameraAdderConfig(robot_name="lefft")}
        assert (
            "camera_adds.eye.robot_name: no robot 'lefft'. Known robots: left, right. Did you mean "
            "'left'? Unset, the camera belongs to the rig, and its offset is in the root frame"
        ) in self.message(duo)

    def test_a_camera_without_stream(self, duo):
        duo.camera_adds = {"bird_eye": rc.envs.CameraAdderConfig()}
        assert (
            "camera_adds.bird_eye: no stream takes images of this camera; add {name: bird_eye, "
            "camera: bird_eye} to cameras.streams"
        ) in self.message(duo)

    def test_suggests_the_right_dictionary_for_objects(self, duo, box):
        pair = (box, rc.Pose())
        for field in ("world_frame_objects", "root_frame_objects"):
            with pytest.raises(rc.ArgumentError) as error:
                setattr(duo, field, {"left": {"d405_mount": pair}})
            assert str(error.value) == (
                f"{field}.left is wrong: objects by name stand where one object is expected; those "
                "that follow a robot's wrist go into robot_frame_objects: {robot: {id: ...}}, all "
                "others are {id: ...} without a robot"
            )
        with pytest.raises(TypeError) as error:
            duo.robot_frame_objects = {"d405_mount": pair}
        assert str(error.value) == (
            "robot_frame_objects.d405_mount must be a mapping of names to EnvObject, got tuple"
        )

    def test_rejects_a_task_with_a_world_object(self, duo, box):
        duo.world_frame_objects = {"cube": (box, rc.Pose())}
        duo.task = {"object": "cube"}
        assert (
            "task.object: 'cube' is in world_frame_objects, which stay in the room; a task goes "
            "with the rig, and so do its objects: move it to root_frame_objects"
        ) in self.message(duo)

    def test_rejects_wrist_objects_among_world_objects(self, duo, box):
        duo.world_frame_objects = {"left": (box, rc.Pose())}
        assert (
            "world_frame_objects.left: is the name of a robot. What follows its wrist goes into "
            "robot_frame_objects: {left: {id: ...}}"
        ) in self.message(duo)


def random_pose(rng: np.random.Generator) -> rc.Pose:
    return rc.Pose(translation=rng.uniform(-1, 1, 3), rpy=rng.uniform(-1.5, 1.5, 3))


def test_robot_poses_are_the_product_of_three_transforms(duo):
    rng = np.random.default_rng(1)
    for _ in range(5):
        duo.root_frame_to_world = random_pose(rng)
        duo.shared_base_frame_to_root_frame = random_pose(rng)
        stands = {robot: random_pose(rng) for robot in duo.robots}
        duo.robot_to_shared_base_frame = stands
        scene = rc.Scene.build(rc.envs.env_scene_spec(duo))
        shared = duo.root_frame_to_world * duo.shared_base_frame_to_root_frame
        assert scene.shared_base_frame_to_world.is_close(shared, 1e-9, 1e-9)
        for robot, pose in stands.items():
            for found in (
                scene.body_pose(f"robot{robot}_base_link"),
                scene.robot(robot).base_in_world,
            ):
                assert found.is_close(shared * pose, 1e-9, 1e-9)


def test_moving_the_root_moves_only_the_rig(duo, box):
    duo.world_frame_objects = {"lamp": (box, at(1, 0, 2))}
    duo.root_frame_objects = {"mount": (box, at(0, 0, 0.2))}
    duo.robot_frame_objects = {"left": {"bracket": (box, at(0, 0.1, 0))}}
    duo.camera_adds = {
        "bird_eye": rc.envs.CameraAdderConfig(offset=at(0.3, 0, 2)),
        "wrist": rc.envs.CameraAdderConfig(offset=at(0.05, 0, 0), robot_name="right"),
    }
    duo.cameras = {"streams": [{"name": n, "camera": n} for n in duo.camera_adds]}
    before = rc.Scene.build(rc.envs.env_scene_spec(duo))
    move = rc.Pose(translation=[0.4, -0.3, 0.2], rpy=[0.5, -0.4, 2])
    duo.root_frame_to_world = move * duo.root_frame_to_world
    after = rc.Scene.build(rc.envs.env_scene_spec(duo))
    assert after.body_names() == before.body_names()
    for body in before.body_names():
        by = rc.Pose() if body in ("world", "lamp_box") else move
        assert after.body_pose(body).is_close(by * before.body_pose(body), 1e-9, 1e-9), body
    for camera in before.camera_names():
        expected = move * before.camera_pose(camera)
        assert after.camera_pose(camera).is_close(expected, 1e-9, 1e-9), camera


def test_the_workflow_one_frame_after_the_other(box):
    """One robot; objects of rig, room and wrist; cameras; the rig's offsets: a look at each."""
    config = rc.EnvConfig(name="cell", robots={"robot": RC7})
    expected = {"robotrobot_base_link": rc.Pose()}

    def look() -> rc.Scene:
        scene = rc.Scene.build(rc.envs.env_scene_spec(config))
        for body, pose in expected.items():
            assert scene.body_pose(body).is_close(pose, 1e-9, 1e-9), body
        return scene

    scene = look()
    assert scene.root_frame_to_world == scene.shared_base_frame_to_world == rc.Pose()

    config.root_frame_objects = {"mount": (box, at(0, 0, -0.1))}
    expected["mount_box"] = at(0, 0, -0.1)
    look()

    config.world_frame_objects = {"cube": (box, at(0.5, 0, 0.2))}
    expected["cube_box"] = at(0.5, 0, 0.2)
    look()

    config.robot_frame_objects = {"robot": {"bracket": (box, at(0, 0.05, 0))}}
    scene = look()
    wrist = scene.site_pose("robotrobot_attachment_site")
    expected["bracket_box"] = wrist * at(0, 0.05, 0)

    config.camera_adds = {
        "bird_eye": rc.envs.CameraAdderConfig(fovy=60.0, offset=at(0.3, 0, 2)),
        "wrist": rc.envs.CameraAdderConfig(offset=at(0.05, 0, 0), robot_name="robot"),
    }
    config.cameras = {"streams": [{"name": n, "camera": n} for n in config.camera_adds]}
    scene = look()
    assert scene.camera_pose("bird_eye").is_close(at(0.3, 0, 2), 1e-9, 1e-9)
    assert scene.camera_pose("wrist").is_close(wrist * at(0.05, 0, 0), 1e-9, 1e-9)
    assert [scene.model.camera(name).fovy for name in config.camera_adds] == [60, 60]

    config.root_frame_to_world = rc.Pose(translation=[1, 2, 3], rpy=[0, 0, 1])
    config.shared_base_frame_to_root_frame = at(0, 0, 0.3)
    config.robot_to_shared_base_frame = {"robot": rc.Pose(translation=[0, 1, 0], rpy=[0.3, 0, 0])}
    root = config.root_frame_to_world
    robot = root * at(0, 0, 0.3) * config.robot_to_shared_base_frame["robot"]
    for body in ("robotrobot_base_link", "bracket_box"):  # from where it stood: the origin
        expected[body] = robot * expected[body]
    expected["mount_box"] = root * at(0, 0, -0.1)
    scene = look()
    assert scene.camera_pose("bird_eye").is_close(root * at(0.3, 0, 2), 1e-9, 1e-9)
    assert scene.camera_pose("wrist").is_close(robot * wrist * at(0.05, 0, 0), 1e-9, 1e-9)
