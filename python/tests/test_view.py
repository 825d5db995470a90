"""`robocell view`: every kind of file has its picture, and what cannot be shown is named."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

import robocell as rc
from command_line import RC7, refused, robocell_command, write_run
from graphics import require_gl
from report_dataset import mixed_dataset
from robocell._cli.episode_player import END, HOME, LEFT, RIGHT, Player


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


@pytest.mark.parametrize("kind", ["robot", "run", "cell", "scene", "model"])
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
    picture = tmp_path / "view.png"
    done = robocell_command("view", dataset / episode.id, "--screenshot", picture)
    assert done.returncode == 0, done.stderr
    assert colours(picture) > 50
    assert "give one of its episodes" in refused("view", dataset)
