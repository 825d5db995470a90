"""Example 14: a cell, frame by frame: the order in which a new one is best described.

One robot in the origin; then what its rig stands on, what stays in the room, what its wrist
carries, and cameras; last the offsets that make a rig of two arms of it, which is acted on. What
each step says of poses is checked, and a picture drawn with the frames.
The same in C++: 14_frames.cc. Run: python examples/14_frames.py [folder for the pictures]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

RC7 = rc.models.robot_file("rc7")
VIEW = rc.render.OrbitCamera(lookat=(0.05, -0.2, 0), distance=2.6, azimuth=150, elevation=-22)
BESIDE = rc.Pose(translation=[0.085, 0, 0.014], rpy=[0, -0.26, 0])  # on the bracket, to the tool


def at(x: float, y: float, z: float) -> rc.Pose:
    """A place with the axes of its frame."""
    return rc.Pose(translation=[x, y, z])


class Steps:
    """Builds the scene after each step, checks the poses and draws it."""

    def __init__(self, config: rc.EnvConfig, folder: Path) -> None:
        self.config = config
        self.folder = folder
        self.pictures: list[np.ndarray] = []

    def next(self, title: str) -> rc.Scene:
        """The scene as the configuration is now."""
        scene = rc.Scene.build(rc.envs.env_scene_spec(self.config))
        scene.reset()
        frames = [
            ("", rc.Pose()),
            ("", scene.root_frame_to_world),
            ("", scene.shared_base_frame_to_world),
        ]
        for robot in self.config.robots:
            frames.append(("", scene.site_pose(f"robot{robot}_attachment_site")))
        renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
        drawn = renderer.render(VIEW, width=320, height=240, frames=frames, frame_length=0.2)
        self.pictures.append(drawn["rgb"])
        rc.render.write_png(self.folder / f"step_{len(self.pictures)}.png", drawn["rgb"])
        print(f"{len(self.pictures)}. {title}")
        return scene


def check(found: rc.Pose, expected: rc.Pose) -> None:
    """Stops where something does not stand where it should."""
    assert found.is_close(expected, 1e-9, 1e-9), f"{found} and not {expected}"


def check_rig(scene: rc.Scene, config: rc.EnvConfig) -> None:
    """The product of the three transforms, and what goes along with the root frame."""
    root = config.root_frame_to_world
    shared = root * config.shared_base_frame_to_root_frame
    for robot in config.robots:
        check(scene.robot(robot).base_in_world, shared * config.robot_to_shared_base_frame[robot])
    check(scene.body_pose("table_table"), root * at(0.35, 0, 0))
    check(scene.camera_pose("bird_eye"), root * at(0.4, 0, 1.6))
    check(scene.body_pose("cabinet_cabinet"), at(-0.4, -0.8, -0.7))
    check(scene.body_pose("wrist_d405"), scene.site_pose("robotleft_attachment_site") * BESIDE)


def describe(steps: Steps) -> rc.EnvConfig:
    """The six steps."""
    config = steps.config
    scene = steps.next("one robot, nothing else: all frames are the world's")
    check(scene.body_pose("robotleft_base_link"), rc.Pose())

    config.root_frame_objects = {"table": ("table", at(0.35, 0, 0))}
    scene = steps.next("what moves with the rig: a table")
    check(scene.body_pose("table_table"), at(0.35, 0, 0))

    config.world_frame_objects = {"cabinet": ("cabinet", at(-0.4, -0.8, -0.7))}
    scene = steps.next("what stays in the room: a cabinet")
    check(scene.body_pose("cabinet_cabinet"), at(-0.4, -0.8, -0.7))

    config.robot_frame_objects = {"left": {"bracket": ("robotiq_d405_mount", rc.Pose())}}
    scene = steps.next("what the wrist carries: a bracket")
    wrist = scene.site_pose("robotleft_attachment_site")
    check(scene.body_pose("bracket_robotiq_d405_mount"), wrist)

    config.camera_adds = {
        "bird_eye": rc.envs.CameraAdderConfig(offset=at(0.4, 0, 1.6), fovy=60),
        "wrist": rc.envs.CameraAdderConfig(xml_path="d405", robot_name="left", offset=BESIDE),
    }
    streams = [{"name": name, "camera": name} for name in config.camera_adds]
    config.cameras = rc.render.CameraSystemConfig(resolution=[64, 48], streams=streams)
    scene = steps.next("cameras: one above, one in its housing on the bracket")
    check(scene.camera_pose("bird_eye"), at(0.4, 0, 1.6))
    check(scene.body_pose("wrist_d405"), wrist * BESIDE)

    config.robots["right"] = rc.RobotConfig.load(RC7)
    config.root_frame_objects["mount"] = rc.envs.EnvObject(mjcf_path="fr3_duo_mount")
    config.robot_to_shared_base_frame = {
        "left": rc.Pose(translation=[0, 0.05, 0], rpy=[-0.8, 0.2, 0]),
        "right": rc.Pose(translation=[0, -0.05, 0], rpy=[0.8, 0.2, 0]),
    }
    config.shared_base_frame_to_root_frame = at(0, 0, 0.342)
    config.root_frame_to_world = rc.Pose(translation=[-0.1, 0.1, 0.1], rpy=[0, 0, 0.4])
    check_rig(steps.next("the offsets: two arms on a mount, and the rig put elsewhere"), config)
    return config


def act(config: rc.EnvConfig) -> None:
    """Both arms along one axis of the frame that they share."""
    env = rc.Env(config)
    before, _ = env.reset(seed=0)
    shared = env.scene.shared_base_frame_to_world
    for robot in config.robots:
        tquat = before[robot]["tquat"]
        seen = shared * rc.Pose(translation=tquat[:3], quaternion=tquat[3:])
        check(seen, env.scene.robot(robot).tcp_in_world)
    up = {"tquat": [0, 0, 0.04, 0, 0, 0, 1], "gripper": 1}
    after, *_, info = env.step({"left": up, "right": up})
    print(f"both arms up, in the shared base frame: {info['reason']}")
    for robot in config.robots:
        moved = after[robot]["tquat"][:3] - before[robot]["tquat"][:3]
        assert np.allclose(moved, [0, 0, 0.04], atol=6e-3), moved
        print(f"  {robot}: {moved[2]:.2f} m")
    assert set(after["frames"]) == {"bird_eye", "wrist"}


def main(folder: Path) -> None:
    """Describes the cell, acts in it, and puts the pictures side by side."""
    steps = Steps(rc.EnvConfig(name="cell", robots={"left": RC7}), folder)
    config = describe(steps)
    config.control_mode = rc.envs.ControlMode.CARTESIAN_TQUAT
    act(config)
    rows = [np.hstack(steps.pictures[:3]), np.hstack(steps.pictures[3:])]
    rc.render.write_png(folder / "picture.png", np.vstack(rows))


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
