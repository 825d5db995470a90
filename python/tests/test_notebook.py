"""Scenes, robots, episodes and datasets show themselves in notebooks."""

from __future__ import annotations

import base64
import re
from pathlib import Path

import pytest

import robocell as rc
from robocell import _notebook


@pytest.fixture
def scene() -> rc.Scene:
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="left <b>", config=config))
    cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, pos=[0.4, 0, 0.02])
    cube.rgba, cube.mass, cube.friction = [1, 0, 0, 1], 0.1, [1, 0.02, 0.001]
    spec.objects.append(cube)
    built = rc.Scene.build(spec)
    built.reset()
    return built


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> rc.Dataset:
    run = rc.RunConfig.load(Path(__file__).resolve().parents[2] / "examples" / "demo.yaml")
    run.output, run.episodes = str(tmp_path_factory.mktemp("out") / "picks"), 1
    run.cameras.resolution = [64, 48]
    rc.generate.prepare_dataset(run)
    rc.generate.Runner(run).run(rc.generate.make_plan(run)[0])
    return rc.Dataset(run.output)


def shown(value: object) -> str:
    return value._repr_html_()  # type: ignore[attr-defined,no-any-return]


def cells(page: str) -> dict[str, str]:
    return dict(re.findall(r"<th[^>]*>(.*?)</th><td[^>]*>(.*?)</td>", page))


def pictures(page: str) -> list[bytes]:
    found = re.findall(r"src='data:image/png;base64,([^']+)'", page)
    return [base64.b64decode(text) for text in found]


def test_a_scene_shows_a_picture_and_its_parts(scene: rc.Scene):
    page = shown(scene)
    assert [data[:8] for data in pictures(page)] == [b"\x89PNG\r\n\x1a\n"]
    assert cells(page)["objects"] == "cube"
    assert cells(page)["time"] == "0.000 s, in steps of 0.002 s"
    assert "wrist_camera" in cells(page)["cameras"]


def test_names_are_escaped(scene: rc.Scene):
    assert cells(shown(scene))["robots"] == "left &lt;b&gt;"


def test_showing_a_scene_changes_nothing(scene: rc.Scene):
    before = scene.state()
    shown(scene)
    shown(scene.robot("left <b>"))
    assert (scene.state() == before).all()


def test_a_robot_shows_its_joints_and_where_its_tcp_is(scene: rc.Scene):
    robot = scene.robot("left <b>")
    page = cells(shown(robot))
    assert page["mode"] == "position"
    assert page["joint2"] == f"{robot.arm.joint_pos[1]:.3f}"
    tcp = robot.base_in_world.inverse() * robot.tcp_in_world
    assert page["TCP in base, x y z"] == " ".join(f"{x:.3f}" for x in tcp.translation) + " m"


def test_a_chain_robot_is_shown(scene: rc.Scene):
    bare = rc.Robot.from_scene(scene, "base_link", "link7")
    assert "joint7" in cells(shown(bare))


HAND = """<mujoco model="hand"><worldbody><body name="palm">
<geom type="box" size="0.03 0.06 0.02" mass="0.5"/>
<body name="left" pos="0 0.04 -0.06">
<joint name="left" type="slide" axis="0 -1 0" range="0 0.04" damping="5"/>
<geom name="left_pad" type="box" size="0.012 0.005 0.05" mass="0.05"/></body>
<body name="right" pos="0 -0.04 -0.06">
<joint name="right" type="slide" axis="0 1 0" range="0 0.04" damping="5"/>
<geom name="right_pad" type="box" size="0.012 0.005 0.05" mass="0.05"/></body>
</body></worldbody><actuator>
<position name="left" joint="left" kp="800" ctrlrange="0 0.04"/>
<position name="right" joint="right" kp="800" ctrlrange="0 0.04"/></actuator></mujoco>"""


@pytest.mark.parametrize("beside_an_arm", [False, True])
def test_a_hand_without_an_arm_shows_itself(tmp_path: Path, beside_an_arm: bool):
    (tmp_path / "hand.xml").write_text(HAND)
    (tmp_path / "hand.yaml").write_text(
        "name: hand\nmodel: hand.xml\nmove_groups:\n  gripper: {kind: gripper, "
        "joints: [left, right], actuators: [left, right], fingers: [left_pad, right_pad], "
        "ctrl: {open: 0, closed: 0.04}}\n"
    )
    config = rc.RobotConfig.load(str(tmp_path / "hand.yaml"))
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True)
    spec.robots.append(rc.RobotSpec(name="hand", config=config, pos=[0.5, 0.5, 0.2]))
    if beside_an_arm:
        arm = rc.RobotConfig.load(rc.models.robot_file("rc7"))
        spec.robots.append(rc.RobotSpec(name="arm", config=arm, prefix="arm_"))
    scene = rc.Scene.build(spec)
    page = shown(scene.robot("hand"))
    assert len(pictures(page)) == 1
    assert list(cells(page)) == ["groups", "gripper"]
    assert len(pictures(shown(scene))) == 1
    if beside_an_arm:
        assert "arm_joint7" in cells(shown(scene.robot("arm")))


def test_a_scene_without_robots_shows_itself():
    spec = rc.SceneSpec(name="room", timestep=0.002, add_floor=True, add_skybox=True)
    page = shown(rc.Scene.build(spec))
    assert cells(page)["robots"] == "none"
    assert len(pictures(page)) == 1


def test_closed_scenes_are_shown_as_closed(scene: rc.Scene):
    robot = scene.robot("left <b>")
    scene.close()
    assert "closed" in shown(scene)
    assert "closed" in shown(robot)


def test_without_a_renderer_the_table_is_shown(scene: rc.Scene, monkeypatch):
    def none(*_: object) -> None:
        raise rc.Error("no OpenGL")

    monkeypatch.setattr(_notebook, "drawn", none)
    page = shown(scene)
    assert pictures(page) == []
    assert cells(page)["objects"] == "cube"


def test_an_episode_shows_an_image_of_each_stream(dataset: rc.Dataset):
    page = shown(dataset[0])
    assert len(pictures(page)) == len(dataset[0].cameras) == 2
    assert cells(page)["result"] == "success"
    assert cells(page)["rows"] == str(dataset[0].rows())


def test_a_dataset_lists_its_episodes(dataset: rc.Dataset):
    page = cells(shown(dataset))
    assert page["episodes"] == "1"
    assert page["s0000_e0000"].startswith(f"{dataset[0].rows()} rows, success, pick up")


def test_long_lists_are_cut():
    assert _notebook.listed(str(i) for i in range(14)).endswith("11 and 2 more")
