"""Workers of a running generation can be watched: the same episode, in another process."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import robocell as rc
from command_line import RC7, write_run
from robocell._cli import load, watch_worker
from robocell._cli.watch_worker import show_episode, watch, written_by_workers
from robocell.viewer import Viewer


def generated(folder: Path) -> rc.RunConfig:
    """A run with one finished episode."""
    run = rc.RunConfig.load(write_run(folder, cameras={"streams": []}, episodes_per_scene=1))
    rc.generate.prepare_dataset(run)
    [item] = rc.generate.make_plan(run)
    assert rc.generate.Runner(run).run(item).committed
    return run


def test_a_watched_episode_is_the_one_that_the_worker_makes(tmp_path: Path):
    run = generated(tmp_path)
    [item] = rc.generate.make_plan(run)
    before = sorted(path.name for path in (tmp_path / "out").rglob("*"))
    shown: list[rc.Scene] = []
    starts: list[Any] = []

    def on_start(scene: rc.Scene) -> None:
        shown.append(scene)
        starts.append(np.array(scene.data.qpos))

    assert show_episode(run, item, on_start)
    [episode] = rc.Dataset(tmp_path / "out")
    names = list(shown[-1].robot("rc7").joint_names)
    place = [int(shown[-1].model.joint(name).qposadr[0]) for name in names]
    np.testing.assert_array_equal(starts[-1][place], episode["robots/rc7/arm/qpos"][0])
    period = run.rates.policy_period()
    assert shown[-1].time() == pytest.approx(episode["time"][-1] + period, abs=1e-6)
    assert sorted(path.name for path in (tmp_path / "out").rglob("*")) == before


def test_the_window_of_a_worker_follows_its_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    generated(tmp_path)
    writes = tmp_path / "out" / f".s0000_e0003_a01.{os.getpid()}.3.partial"
    writes.mkdir()
    opened: list[Viewer] = []

    def in_memory(scene: rc.Scene, title: str) -> Viewer:
        opened.append(Viewer.open(scene, title, 160, 120, on_screen=False))
        return opened[-1]

    waited: list[float] = []

    def close(seconds: float) -> None:
        waited.append(seconds)
        if len(waited) == 3:  # the worker still writes
            opened[-1].post("close")

    monkeypatch.setattr(watch_worker, "PATIENCE_S", 0.0)
    monkeypatch.setattr(watch_worker, "Viewer", SimpleNamespace(open=in_memory))
    monkeypatch.setattr(watch_worker.time, "sleep", close)
    monkeypatch.setattr(watch_worker.os, "nice", lambda _: 0)
    watch(tmp_path / "out", 0, 0.0, [])  # ends when the user closes the window
    assert "worker 0: s0000_e0003_a01" in capsys.readouterr().out
    assert len(opened) >= 1
    assert len(waited) == 3


def test_a_worker_keeps_its_number_between_its_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    generated(tmp_path)
    one, two = os.getppid(), os.getpid()
    now = [
        {one: "s0000_e0000", two: "s0000_e0001"},
        {one: "s0000_e0000"},
        {one: "s0000_e0002", two: "s0000_e0003"},
    ]
    shown: list[str] = []

    def show(run: rc.RunConfig, item: rc.generate.PlanItem, on_start: object) -> bool:
        shown.append(item.id)
        return True

    monkeypatch.setattr(watch_worker, "written_by_workers", lambda _: now.pop(0) if now else {})
    monkeypatch.setattr(watch_worker, "show_episode", show)
    monkeypatch.setattr(watch_worker, "PATIENCE_S", 0.3)
    monkeypatch.setattr(watch_worker.os, "nice", lambda _: 0)
    watch(tmp_path / "out", 1, 0.0, [])
    assert shown == ["s0000_e0001", "s0000_e0003"]


def test_without_a_display_the_first_error_ends_it(tmp_path: Path):
    run = generated(tmp_path)
    [item] = rc.generate.make_plan(run)
    calls = []

    def on_start(scene: rc.Scene) -> None:
        calls.append(scene)
        raise rc.Error("no display")

    with pytest.raises(rc.Error, match="no display"):
        show_episode(run, item, on_start)
    assert len(calls) == 1


def test_workers_are_counted_and_dead_ones_are_not(tmp_path: Path):
    for name in (
        f".s0_e1_a02.{os.getpid()}.3.partial",
        f".s0_e0.{os.getppid()}.1.partial",
        ".s0_e2.999999999.1.partial",
        ".lock.partial",
    ):
        (tmp_path / name).mkdir()
    expected = {os.getpid(): "s0_e1_a02", os.getppid(): "s0_e0"}
    assert written_by_workers(tmp_path) == expected
    assert list(written_by_workers(tmp_path)) == sorted(expected)


@pytest.mark.parametrize(
    ("target", "more", "message"),
    [("robot", [], "is no dataset"), ("dataset", ["--web"], "shows a window")],
)
def test_what_cannot_be_watched_is_named(
    target: str, more: list[str], message: str, tmp_path: Path
):
    (tmp_path / "dataset.json").write_text("{}")
    words = ["view", str(RC7 if target == "robot" else tmp_path), "--worker", "0", *more]
    result = CliRunner().invoke(load(words), words)
    assert result.exit_code == 2
    assert message in result.output
