"""`robocell view`: every kind of file has its picture, and what cannot be shown is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import robocell as rc
from command_line import RC7, refused, robocell_command, write_run
from graphics import require_gl
from report_dataset import mixed_dataset
from robocell._cli.episode_player import END, HOME, LEFT, RIGHT, Player
from robocell._cli.ik_answers import reachable_poses, solve_each
from robocell._cli.ik_window import Walk
from robocell._cli.robot_scene import load_robot
from robocell._cli.view import kind_of

# Of files to show, beside a run and a model.
OTHER_KINDS = ("robot", "cell", "scene")


def colours(picture: Path) -> int:
    """How many colours the middle of the window has, where the scene is."""
    with Image.open(picture) as image:
        width, height = image.size
        middle = image.convert("RGB").crop((width // 3, 0, 2 * width // 3, height))
        return len(middle.getcolors(1 << 24))


def scene_file(folder: Path) -> Path:
    spec = rc.SceneSpec(name="room", timestep=0.002, add_floor=True, add_skybox=True)
    box = rc.SceneObject(name="box", shape=rc.Shape.BOX, size=[0.1, 0.2, 0.3], rgba=[1, 0, 0, 1])
    box.mass, box.friction, box.pos = 1, [0.8, 0.02, 0.001], [0, 0, 0.3]
    spec.objects.append(box)
    path = folder / "scene.yaml"
    path.write_text(spec.to_yaml())
    return path


@pytest.mark.parametrize(
    "kind",
    ["run", "model", *(pytest.param(kind, marks=pytest.mark.proof) for kind in OTHER_KINDS)],
)
def test_shows_every_kind_of_file(kind: str, tmp_path: Path):
    require_gl()
    files = {
        "robot": lambda: RC7,
        "run": lambda: write_run(tmp_path),
        "cell": lambda: rc.models.cell_file("rc7"),
        "scene": lambda: scene_file(tmp_path),
        "model": lambda: RC7.with_name("rc7.xml"),
    }
    picture = tmp_path / "view.png"
    done = robocell_command("view", files[kind](), "--screenshot", picture)
    assert done.returncode == 0, done.stderr
    assert colours(picture) > 50


def test_names_what_cannot_be_shown(tmp_path: Path):
    (tmp_path / "robot.yaml").write_text("name: a")
    assert "Did you mean" in refused("view", tmp_path / "robto.yaml")
    (tmp_path / "notes.txt").write_text("")
    assert "is no file to show" in refused("view", tmp_path / "notes.txt")
    (tmp_path / "list.yaml").write_text("[1, 2]")
    assert "has no fields" in refused("view", tmp_path / "list.yaml")
    (tmp_path / "other.yaml").write_text("colour: red\nlength: 3\nload: 1")
    assert "no field of any specification" in refused("view", tmp_path / "other.yaml")


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        ("name: a\ntimestep: 0.002\nrobotz: []", "scene"),
        ("name: a\nobjects: []\nload: 1\nsave: 2\nfrom_yaml: 3", "scene"),
        ("name: a\nmodel: arm.xml\ngroups: {}", "robot"),
        ("name: a\ncontrol_mode: joints\nrobots: {}", "cell"),
        ("run: a\nepisodes: 3\ntask: {}", "run"),
    ],
)
def test_the_fields_that_only_one_kind_has_decide(content: str, kind: str, tmp_path: Path):
    path = tmp_path / "a.yaml"
    path.write_text(content)
    kinds = {
        "scene": rc.SceneSpec,
        "robot": rc.RobotConfig,
        "cell": rc.EnvConfig,
        "run": rc.RunConfig,
    }
    assert kind_of(path) is kinds[kind]


def poses(scene: rc.Scene, episode: rc.data.Episode) -> dict[str, np.ndarray]:
    """The present poses of everything whose pose in the world an episode records."""
    found = {}
    for name in episode.columns:
        parts = name.split("/")
        if parts[0] == "robots" and parts[2:] == ["base_pose"]:
            pose = scene.robot(parts[1]).base_in_world
        elif parts[0] == "robots" and parts[2:] == ["tcp_pose"]:
            pose = scene.robot(parts[1]).tcp_in_world
        elif parts[0] == "objects" and parts[2:] == ["pose"]:
            pose = scene.body_pose(parts[1])
        else:
            continue
        turn = np.array(pose.quaternion)
        found[name] = np.concatenate([pose.translation, turn if turn[3] >= 0 else -turn])
    assert len(found) >= 3
    return found


def test_an_episode_plays_as_it_was_recorded(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    require_gl()
    dataset = mixed_dataset(tmp_path_factory)
    episode = rc.Dataset(dataset)[rc.Dataset(dataset).ids[0]]
    player = Player(episode)
    joints = episode["robots/rc7/arm/qpos"]
    arm = player.scene.robot("rc7").arm
    for row in (0, len(joints) // 2, len(joints) - 1):
        player.show_row(row)
        assert arm.joint_pos == pytest.approx(joints[row], abs=1e-6)
        for name, shown in poses(player.scene, episode).items():
            assert shown == pytest.approx(episode[name][row], abs=1e-6), name
        assert f"row {row} of" in player.text
    player.press(HOME)
    player.playing = False
    player.press(RIGHT)
    assert player.row == 1
    player.press(LEFT)
    player.press(LEFT)
    assert player.row == 0
    player.playing = True
    for _ in range(1000):
        player.advance(0.1)
    assert player.row == len(joints) - 1
    player.press(END)
    assert player.row == len(joints) - 1
    player.show_row(2)
    player.advance(0.5, speed=0)
    assert player.row == 3, "as fast as possible: row after row"
    player.states, player.times = player.states[:1], player.times[:1]
    for key in (HOME, RIGHT, LEFT, END):
        player.press(key)
        assert player.row == 0
    picture = tmp_path / "view.png"
    done = robocell_command("view", dataset / episode.id, "--screenshot", picture)
    assert done.returncode == 0, done.stderr
    assert colours(picture) > 50
    assert "give one of its episodes" in refused("view", dataset)


def test_the_answers_of_ik_test_are_shown_as_they_were_computed():
    require_gl()
    loaded = load_robot(RC7)
    targets = reachable_poses(loaded.robot, 3, np.random.default_rng(0))
    targets[1] = rc.Pose(translation=[9, 0, 0])  # out of reach
    answers = solve_each(loaded.robot, targets, 1e-5)
    options = {"width": 128, "height": 96, "on_screen": False}
    with rc.viewer.open(loaded.robot, **options) as viewer:
        viewer.realtime_factor = 0
        walk = Walk(viewer, loaded, targets, answers, 1e-5)
        for number in (0, 1, 2, 2):
            assert walk.number == number
            assert loaded.robot.arm.joint_pos == pytest.approx(answers.joints[number], abs=0.01)
            assert ("NOT SOLVED" in viewer.text) == (number == 1)
            viewer.post("key", key=ord("N"))
            viewer.show()
            assert walk.step()
        viewer.post("key", key=ord("P"))
        viewer.show()
        walk.step()
        assert walk.number == 1
