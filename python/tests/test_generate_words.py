"""What `generate` says around a run: too little space, files in the way, an early Ctrl-C."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest
import typer

from command_line import write_run
from robocell._generation.canaries import Canaries
from robocell._generation.items import Item
from robocell._generation.job import Result
from robocell._generation.supervisor import Fatal, Outcome
from robocell._generation.totals import Totals, Unmade

# The package has the command under the module's name.
cli = importlib.import_module("robocell._cli.generate")


def test_warns_about_a_small_disk_before_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cli, "free_bytes", lambda folder: 1_000_000)
    assert cli.too_little_room(1_000_000, tmp_path) == ""
    assert cli.too_little_room(3_500_000, tmp_path) == (
        f"the disk of '{tmp_path}' is too small: about 3.5 MB are needed (3500000 bytes), 1 MB are "
        "free there (1000000 bytes). Make room, or name another folder (--output)"
    )


def test_repair_is_suggested_only_if_it_helps(tmp_path: Path):
    foreign = "'e1' is an episode of another run: repair leaves it alone, move it away yourself"
    assert cli.text_of_damage(foreign, tmp_path).endswith(foreign)
    half = "'e2' is half an episode: episode.json is missing"
    told = cli.text_of_damage(f"{foreign}\n{half}", tmp_path)
    assert told.endswith(f"{half}\nTo set damaged ones aside: robocell verify --repair {tmp_path}")


def test_ctrl_c_before_workers_start_prints_no_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def interrupted(*of: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules[cli.Job.__module__], "check_in_child", interrupted)
    monkeypatch.setattr(sys, "argv", ["robocell", "generate", "run.yaml"])
    with pytest.raises(typer.Exit) as end:
        cli.generate(write_run(tmp_path))
    assert end.value.exit_code == 130
    assert capsys.readouterr().err == (
        "warning: interrupted before the first episode.\nTo restart: robocell generate run.yaml\n"
    )


@pytest.mark.parametrize(("on_disk", "kept"), [(0, ""), (1, "1 episode is"), (2, "2 episodes are")])
def test_a_failed_run_reports_how_many_episodes_are_kept(
    on_disk: int, kept: str, capsys: pytest.CaptureFixture[str]
):
    full = Fatal("io", "the disk is full")
    with pytest.raises(typer.Exit):
        cli._end(Result(Outcome(Totals(planned=6), False, full), on_disk))
    told = f"\n{kept} on the disk." if kept else ""
    assert capsys.readouterr().err == f"error: the disk is full{told}\n"


@pytest.mark.parametrize("has_seen_items", [True, False])
def test_errors_of_items_are_not_repeated_at_the_end(
    has_seen_items: bool, capsys: pytest.CaptureFixture[str]
):
    canaries = Canaries([Item("e0", 0)])
    canaries.lost(Unmade("e0", "run.yaml:3:1: no grasp", "robocell generate"), "spec")
    verdict = canaries.verdict()
    assert verdict is not None
    fatal = Fatal(verdict.kind, verdict.message, verdict.summary)
    with pytest.raises(typer.Exit) as end:
        cli._end(Result(Outcome(Totals(planned=1), False, fatal), 0), has_seen_items=has_seen_items)
    assert end.value.exit_code == 2
    assert capsys.readouterr().err == (
        "error: 1 episode could not be made, see above\n"
        if has_seen_items
        else "error: run.yaml:3:1: no grasp\nTry one alone: robocell generate\n"
    )


@pytest.mark.parametrize(("on_disk", "verb"), [(1, "is"), (2, "are")])
def test_an_interrupted_run_reports_how_many_episodes_are_kept(
    on_disk: int, verb: str, capsys: pytest.CaptureFixture[str]
):
    with pytest.raises(typer.Exit):
        cli._end(Result(Outcome(Totals(planned=6), True, None), on_disk))
    told = capsys.readouterr().err
    assert told.startswith(f"warning: interrupted: {on_disk} of 6 episodes {verb} on the disk.\n")
