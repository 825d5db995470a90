"""After `scene.close()` every use of what belongs to the scene is a ClosedError that names it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import robocell as rc

# These members name the object, or end its use.
ALWAYS = {
    "Scene": {"name", "close", "closed"},
    "Robot": {"name", "prefix", "scene"},
    "MoveGroup": {"name", "kind"},
    "Controller": {"kind"},
    "MotionPlanner": {"joint_names"},
    "VideoRecorder": {"finish", "frames"},
    "Viewer": {
        *("step", "show", "close", "is_running", "scene", "title", "recording", "stop_recording"),
        *("paused", "realtime_factor", "measured_factor"),
    },
    "Env": {"close", "config"},
}
GROUP = "robot 'a' / group '{}' is closed: its scene was closed"
ROBOT = "robot 'a' is closed: its scene was closed"
SCENE = "{} is closed: its scene 'cell' was closed"


@pytest.fixture(scope="module")
def handles(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Any, str]]:
    """Every kind of handle to a scene that was closed, and how its error begins."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    scene = rc.Scene.build(spec)
    robot = scene.robot("a")
    video = tmp_path_factory.mktemp("video") / "v.mp4"
    made = {
        "scene": (scene, "scene 'cell' is closed"),
        "robot": (robot, ROBOT),
        "ad hoc robot": (
            rc.Robot.from_scene(scene, "base_link", "link7"),
            "robot 'a' is closed: its scene was closed",
        ),
        "kinematics": (robot.kinematics, ROBOT),
        "arm": (robot.arm, GROUP.format("arm")),
        "gripper": (robot.gripper, GROUP.format("gripper")),
        "base": (robot.base, GROUP.format("base")),
        "gripper controller": (robot.controller("gripper"), GROUP.format("gripper")),
        "position controller": (robot.controller(), GROUP.format("arm")),
        "motion planner": (rc.motion.MotionPlanner(robot), ROBOT),
        "stepper": (rc.control.Stepper(scene, [robot]), SCENE.format("stepper")),
        "renderer": (rc.render.Renderer(scene), SCENE.format("renderer")),
        "video recorder": (
            rc.render.VideoRecorder(scene, video, 64, 48),
            SCENE.format("video recorder"),
        ),
        "viewer": (rc.viewer.open(scene, on_screen=False), SCENE.format("viewer")),
    }
    for kind in ("cartesian_pose", "joint_impedance", "cartesian_impedance"):
        made[kind] = (robot.set_controller("arm", kind), GROUP.format("arm"))
    env = rc.Env(rc.EnvConfig(name="cell", robots={"a": config}))
    made["environment"] = (env, SCENE.format("environment 'cell'"))
    env.close()
    scene.close()
    return made


KINDS = [
    *("scene", "robot", "ad hoc robot", "kinematics", "arm", "gripper", "base", "stepper"),
    *("gripper controller", "position controller", "renderer", "video recorder", "viewer"),
    *("cartesian_pose", "joint_impedance", "cartesian_impedance", "environment"),
    "motion planner",
]


def uses(handle: Any, but: dict[str, set[str]] = ALWAYS) -> dict[str, Callable[[], Any]]:
    """Everything public that can be asked of an object, with no or any arguments."""
    found: dict[str, Callable[[], Any]] = {}
    for owner in type(handle).__mro__:
        for name, member in vars(owner).items():
            if name.startswith("_") or name in but.get(owner.__name__, ()):
                continue
            if not isinstance(member, property):
                if "(self" in member.__nb_signature__[0][0]:
                    found[name] = getattr(handle, name)
                continue
            found[name] = lambda name=name: getattr(handle, name)
            if member.fset:
                found[f"{name} = ..."] = lambda name=name: setattr(handle, name, None)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_every_use_of_a_closed_handle_raises_closed_error(
    handles: dict[str, tuple[Any, str]], kind: str
):
    handle, message = handles[kind]
    asked = uses(handle)
    assert asked
    for name, use in asked.items():
        with pytest.raises(rc.ClosedError) as caught:
            use()
        assert str(caught.value).startswith(message), name


def test_every_kind_of_handle_is_covered(handles: dict[str, tuple[Any, str]]):
    assert set(handles) == set(KINDS)


def test_a_closed_handle_keeps_its_names(handles: dict[str, tuple[Any, str]]):
    scene, robot, arm = (handles[kind][0] for kind in ("scene", "robot", "arm"))
    assert (scene.name, scene.closed, robot.name, robot.prefix) == ("cell", True, "a", "")
    assert (arm.name, arm.kind, robot.scene) == ("arm", "arm", scene)
    assert repr(scene) == "<Scene 'cell', closed>"
    assert repr(robot) == "<Robot 'a'>"
    scene.close()


def test_a_video_can_be_finished_after_its_scene_was_closed(tmp_path: Path):
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    scene = rc.Scene.build(spec)
    with rc.render.VideoRecorder(scene, tmp_path / "v.mp4", 64, 48) as video:
        video.record_frame()
        scene.close()
        assert video.frames == 1
    assert (tmp_path / "v.mp4").stat().st_size > 0


def test_a_custom_group_survives_closing():
    class Own(rc.robots.MoveGroup):
        def get_name(self) -> str:
            return "own"

    assert Own().name == "own"
