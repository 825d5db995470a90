"""`robocell view --web`: every kind of target has its page, and what cannot be shown is named."""

from __future__ import annotations

import http.client
import signal
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

import robocell as rc
from command_line import RC7, environment_with, refused, write_run
from report_dataset import mixed_dataset
from robocell._cli.view import load
from robocell._web.dataset_page import DatasetPages
from robocell._web.packed import unpacked


def get(url: str, path: str = "") -> bytes:
    parts = urlsplit(url)
    connection = http.client.HTTPConnection(parts.netloc, timeout=60)
    connection.request("GET", f"/{path}?{parts.query}")
    answer = connection.getresponse()
    assert answer.status == 200, answer.read()
    return answer.read()


@pytest.mark.proof
@pytest.mark.parametrize("kind", ["robot", "run", "dataset", "episode"])
def test_every_kind_of_target_has_its_page(
    kind: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    targets = {
        "robot": lambda: RC7,
        "run": lambda: write_run(tmp_path),
        "dataset": lambda: mixed_dataset(tmp_path_factory),
        "episode": lambda: next(mixed_dataset(tmp_path_factory).glob("s*")),
    }
    command = [sys.executable, "-m", "robocell", "view", str(targets[kind]()), "--web"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment_with({}))
    try:
        assert process.stdout is not None
        url = process.stdout.readline().removeprefix("page: ").strip()
        shows = {"robot": "live", "run": "live"}.get(kind, kind)
        assert f'data-kind="{shows}"' in get(url).decode()
        data = get(url, "list" if kind == "dataset" else "geometry")
        if kind != "dataset":
            assert len(unpacked(data)[0]["geoms"]) > 5
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 0
    finally:
        process.kill()


def test_a_dataset_has_a_list_and_its_episodes(tmp_path_factory: pytest.TempPathFactory):
    folder = mixed_dataset(tmp_path_factory)
    pages = DatasetPages(folder)
    first, second = rc.Dataset(folder).ids[:2]
    assert pages.page({}) == ("dataset", f"Dataset {folder.name}")
    assert pages.page({"episode": "none"}) is None
    assert pages.page({"episode": "../out"}) is None
    assert pages.get("video", {"episode": first, "camera": "../../run"}) is None
    assert pages.get("secrets", {"episode": first}) is None
    alone = DatasetPages(folder, first)
    shown = alone.page({"episode": second})
    assert shown is not None
    assert shown[1].startswith(first)
    assert alone.get("list", {}) is None


def test_a_reset_goes_to_the_start_of_the_run(tmp_path: Path):
    shown = load(write_run(tmp_path, cameras={"streams": []}), 1)
    start = shown.scene.state()
    for _ in range(50):
        for robot in shown.scene.robots:
            robot.jnt_pos_cmd[0] += 0.01
            robot.update()
        shown.scene.step()
    assert np.abs(shown.scene.state() - start).max() > 0.01
    shown.restart()
    np.testing.assert_allclose(shown.scene.state(), start, atol=1e-9)
    robot = shown.scene.robots[0]
    np.testing.assert_allclose(robot.jnt_pos_cmd, robot.arm.joint_pos)


def test_what_cannot_be_shown_is_named(tmp_path: Path):
    assert "folder without episodes" in refused("view", tmp_path, "--web")
    assert "leave out --web" in refused("view", RC7, "--web", "--screenshot", tmp_path / "a.png")
    assert "65535" in refused("view", RC7, "--web", "--port", "70000")
    (tmp_path / "notes.txt").write_text("")
    assert "is no file to show" in refused("view", tmp_path / "notes.txt", "--web")
