"""The common mistakes of RCS's page, 1 to 5, and what is said about each."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import robocell as rc
import robocell.compat.rcs as rcs
from rcs_cells import built, camera, duo, fr3
from robocell.compat.rcs import OBJECT_PATHS
from robocell.compat.rcs.envs.scenes import CameraAdderConfig, SimEnvCreator
from robocell.compat.rcs.envs.tasks import PickTaskConfig
from robocell.compat.rcs.sim import SimGripperConfig, SimRobotConfig

__all__ = ["fr3"]  # a fixture


class TestMistakes:
    """The page's common mistakes, 1 to 5: with its names, which frame or name was expected."""

    CUBE = (OBJECT_PATHS["green_cube"], rcs.common.Pose())
    FRAMES = (
        "world_frame_objects stay in the room, root_frame_objects move with the rig, "
        "robot_frame_objects follow a robot's wrist"
    )

    def message(self, fr3, **more) -> str:
        cfg = duo(fr3, **more)
        with pytest.raises(rc.Error) as error:
            SimEnvCreator().create_model(cfg)
        return str(error.value)

    def test_1_world_and_root_frame(self, fr3):
        both = {
            "world_frame_objects": {"cube": self.CUBE},
            "root_frame_objects": {"cube": self.CUBE},
        }
        message = self.message(fr3, **both)
        assert "root_frame_objects.cube: is in world_frame_objects too; keep one of" in message
        assert self.FRAMES in message
        task = PickTaskConfig(robot_name="left")
        assert self.message(fr3, task_cfg=task, world_frame_objects={"PickTask": self.CUBE}) == (
            "world_frame_objects.PickTask: the object of task_cfg has this name, its prefix "
            "'PickTask_', and stands in the root frame; leave 'PickTask' out of "
            "world_frame_objects, or give task_cfg another prefix"
        )

    def test_2_the_frame_of_a_cameras_offset(self, fr3):
        streams = {"wrist": camera("wrist")}
        adds = {"wrist": CameraAdderConfig(robot_name="lfet")}
        assert (
            "camera_adds.wrist.robot_name: no robot 'lfet'. Known robots: left, right. Did you "
            "mean 'left'? Unset, the camera belongs to the rig, and its offset is in the root frame"
        ) in self.message(fr3, camera_cfgs=streams, camera_adds=adds)
        adds = {"wrist": CameraAdderConfig(attachment_site="attachment_site")}
        assert (
            "camera_adds.wrist.attachment_site: is a site of a robot, but without robot_name the "
            "offset is in the root frame; set robot_name, or leave the site out"
        ) in self.message(fr3, camera_cfgs=streams, camera_adds=adds)

    def test_3_matching_camera_names(self, fr3):
        added = {"camera_adds": {"bird_eye": CameraAdderConfig()}}
        wrist = {"wrist": camera("wrist")}
        assert self.message(fr3, **added, camera_cfgs=wrist) == (
            "camera_adds.bird_eye: no entry of camera_cfgs takes images of this camera; name it in "
            "camera_cfgs ({'bird_eye': SimCameraConfig(identifier='bird_eye')}), or leave it out. "
            "camera_cfgs has wrist"
        )
        assert self.message(fr3, **added).endswith("camera_cfgs has none")
        assert self.message(fr3, **added, camera_cfgs={"bird_eye": camera("bird")}) == (
            "camera_adds.bird_eye: camera_cfgs.bird_eye takes images of the camera 'bird', its "
            "identifier; the name of this one is expected there: identifier='bird_eye'"
        )
        added["camera_adds"]["wrist"] = CameraAdderConfig(robot_name="left")
        lines = self.message(fr3, **added).splitlines()
        assert [line.split(":")[0] for line in lines] == [
            "camera_adds.bird_eye", "camera_adds.wrist",
        ]  # fmt: skip
        duo(fr3, **added, camera_cfgs={"above": camera("bird_eye")} | wrist).to_env_config()

    def test_4_wrist_objects_among_world_objects(self, fr3):
        assert self.message(fr3, world_frame_objects={"left": {"mount": self.CUBE}}) == (
            "world_frame_objects.left is wrong: objects by name stand where one object is "
            "expected; those that follow a robot's wrist go into robot_frame_objects: "
            "{robot: {id: ...}}, all others are {id: ...} without a robot"
        )
        message = self.message(fr3, world_frame_objects={"left": self.CUBE})
        assert "world_frame_objects.left: is the name of a robot. What follows its wr" in message
        assert self.FRAMES in message
        assert self.message(fr3, robot_frame_objects={"mount": self.CUBE}) == (
            "robot_frame_objects.mount: objects follow the wrist of a robot and are expected under "
            "its name, {robot: {'mount': (model, Pose)}}. Known robots: left, right"
        )

    def test_5_prefixes_of_a_model_of_all_robots(self, tmp_path: Path):
        arms = mujoco.MjSpec()
        torso = arms.worldbody.add_body(name="torso")
        for side, y in (("left", 0.3), ("right", -0.3)):
            arm = mujoco.MjSpec.from_file(rc.models.resolve("rc7"))
            for key in arm.keys:
                arm.delete(key)
            torso.add_frame(pos=[0, y, 0]).attach_body(arm.body("base_link"), f"arm_{side}_", "")
        path = tmp_path / "arms.xml"
        path.write_text(arms.to_xml())
        own = rc.RobotConfig.load(rc.models.robot_file("rc7")).move_groups["arm"]
        robot_cfg = SimRobotConfig(
            robot_type="rc7", base="base_link", joints=list(own.joints), q_home=None,
            actuators=list(own.actuators), kinematic_model_path=rc.models.resolve("rc7"),
        )  # fmt: skip
        cfg = duo(robot_cfg, alternative_combined_robot_mjcf=path, robot_to_shared_base_frame=None)
        with pytest.raises(rc.SpecError) as error:
            built(cfg)
        text = str(error.value)
        assert "the names of robot 'left' must begin with 'robotleft_'; its bodies are " in text
        assert "arm_left_base_link" in text

    def test_a_gripper_without_a_robot(self, fr3):
        assert self.message(fr3, gripper_cfgs={"lfet": SimGripperConfig()}) == (
            "gripper_cfgs.lfet: no robot 'lfet'. Known robots: left, right"
        )


def test_unknown_registry_names_suggest_the_nearest():
    for name in ("SCENE_PATHS", "OBJECT_PATHS", "GRIPPER_PATHS", "CAMERA_PATHS"):
        registry = getattr(rcs, name)
        known = next(iter(registry))
        with pytest.raises(KeyError) as error:
            registry[known + "x"]
        assert f"{name}: no '{known}x'. It has: {known}" in str(error.value)
        assert f"Did you mean '{known}'?" in str(error.value)
        assert registry.get(known + "x") is None
        assert registry[known] == dict(registry)[known]
