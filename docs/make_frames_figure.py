"""Draws docs/frames.png: the five kinds of frames on a rig of two arms.

python docs/make_frames_figure.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from figures import save

import robocell as rc

SIZE = (960, 600)  # width, height in pixels; drawn at twice the size
MOUNT = """<mujoco><worldbody><body name="column">
<geom type="box" size="0.09 0.16 0.17" pos="0 0 0.17" rgba="0.62 0.64 0.67 1"/>
<geom type="box" size="0.2 0.3 0.02" pos="0 0 -0.02" rgba="0.42 0.44 0.48 1"/>
</body></worldbody></mujoco>"""


def rig(folder: Path) -> rc.EnvConfig:
    """Two of the built-in robot, tilted outwards on a column that stands behind the origin."""
    mount = folder / "mount.xml"
    mount.write_text(MOUNT)
    robot = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    return rc.EnvConfig(
        robots={"left": robot, "right": robot},
        add_floor=True,
        root_frame_to_world=rc.Pose(translation=[-0.45, -0.1, 0.04], rpy=[0, 0, 0.35]),
        shared_base_frame_to_root_frame=rc.Pose(translation=[0, 0, 0.34]),
        robot_to_shared_base_frame={
            "left": rc.Pose(translation=[0, 0.17, 0], rpy=[-0.7, 0, 0]),
            "right": rc.Pose(translation=[0, -0.17, 0], rpy=[0.7, 0, 0]),
        },
        root_frame_objects={"mount": (mount, rc.Pose())},
    )


def main() -> None:
    """Draws it."""
    with tempfile.TemporaryDirectory() as folder:
        scene = rc.Scene.build(rc.envs.env_scene_spec(rig(Path(folder))))
    scene.reset()
    frames = [
        ("world", rc.Pose()),
        ("root", scene.root_frame_to_world),
        ("shared base", scene.shared_base_frame_to_world),
    ]
    for side in ("left", "right"):
        frames.append((f"base of {side}", scene.robot(side).base_in_world))
        frames.append(
            (f"attachment site of {side}", scene.site_pose(f"robot{side}_attachment_site"))
        )
    view = rc.render.OrbitCamera(
        lookat=(-0.25, -0.02, 0.36), distance=2.1, azimuth=215, elevation=-24, fovy=36
    )
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4, shadow_size=8192)
    large = renderer.render(
        view, width=2 * SIZE[0], height=2 * SIZE[1], frames=frames, frame_length=0.16
    )
    save(large["rgb"], "frames.png", SIZE[0])


if __name__ == "__main__":
    main()
