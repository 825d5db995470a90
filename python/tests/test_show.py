"""`robocell.show`: a scene or an episode as a page in one file."""

from __future__ import annotations

import base64
import html
import re
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from command_line import RC7
from report_dataset import mixed_dataset
from robocell._cli.robot_scene import load_robot
from robocell._web.packed import unpacked
from robocell._web.scene_geometry import body_poses, geometry_of


def embedded(page: str) -> dict[str, bytes]:
    found = re.findall(r'<script type="text/plain" data-name="([^"]+)">([^<]*)</script>', page)
    return {name: base64.b64decode(text) for name, text in found}


def test_a_scene_is_a_page_that_asks_for_nothing(tmp_path: Path):
    robot = load_robot(RC7).robot
    shown = rc.show(robot)
    data = embedded(shown.html)
    assert data == {"geometry": geometry_of(robot.scene)}
    assert 'data-kind="still"' in shown.html
    assert " src=" not in re.sub(r"<script>.*?</script>", "", shown.html, flags=re.DOTALL)
    assert "default-src 'none'" in shown.html
    shown.save(str(tmp_path / "scene.html"))
    assert (tmp_path / "scene.html").read_text() == shown.html
    frame = shown._repr_html_()
    assert frame.startswith('<iframe sandbox="allow-scripts"')
    assert html.unescape(re.search(r'srcdoc="([^"]*)"', frame)[1]) == shown.html  # type: ignore[index]


def test_an_episode_plays_the_recorded_poses(tmp_path_factory: pytest.TempPathFactory):
    episode = rc.Dataset(mixed_dataset(tmp_path_factory))[0]
    data = embedded(rc.show(episode).html)
    header, array = unpacked(data["episode"])
    poses = array(header["poses"])
    assert len(poses) == len(episode) == len(array(header["times"]))
    shapes, _ = unpacked(data["geometry"])
    target = shapes["bodies"].index("target")
    np.testing.assert_allclose(
        poses[:, target], episode["objects/target/pose"], atol=2e-3
    )  # the engine's poses are those of the step before
    columns = {column["name"]: array(column["values"]) for column in header["columns"]}
    np.testing.assert_allclose(
        columns["robots/rc7/arm/qpos"], episode["robots/rc7/arm/qpos"], atol=1e-6
    )
    assert header["phases"][0]["first"] == 0
    assert data["video-wrist"][4:8] == b"ftyp"
    scene = rc.Scene.build(rc.data.recorded_scene(episode))
    assert body_poses(scene).shape == poses[0].shape


def test_other_things_are_refused():
    with pytest.raises(rc.ArgumentError, match="got int"):
        rc.show(3)
