"""What is said of the process that looks a run through, however it ends."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import pytest

import robocell
from command_line import refused, write_run
from robocell._generation.check import Found, check_in_child
from robocell._generation.protocol import Failure
from robocell._generation.run_source import RunSource


def ends(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    """Lets a shell script be the process."""
    program = folder / "python"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))


@pytest.mark.parametrize("signal", ["SEGV", "ABRT", "BUS", "FPE", "ILL"])
def test_reports_a_crash_as_caused_by_a_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, signal: str
):
    ends(tmp_path, monkeypatch, f"ulimit -c 0; kill -{signal} $$")
    (crash,) = check_in_child(RunSource("run.yaml"), []).warnings
    assert crash == (
        f"the process that looked through the run was killed by SIG{signal}: one of its models "
        "crashes the engine. Episodes that need it will be listed"
    )


@pytest.mark.parametrize(
    ("script", "said"),
    [
        (
            "kill -KILL $$",
            "was killed by SIGKILL (out of memory?). Nothing was written; give the same command "
            "again when more memory is free",
        ),
        (
            "kill -TERM $$",
            "was killed by SIGTERM. Nothing was written; give the same command again",
        ),
        ("echo broken >&2; exit 7", "ended with exit code 7. Nothing was written; give"),
    ],
)
def test_any_other_exit_stops_the_run(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    script: str,
    said: str,
):
    ends(tmp_path, monkeypatch, script)
    with pytest.raises(robocell.IoError) as raised:
        check_in_child(RunSource("run.yaml"), [])
    assert f"the process that looked through the run {said}" in str(raised.value)
    assert "model" not in str(raised.value)
    assert ("broken" in capsys.readouterr().err) == ("broken" in script)


@pytest.mark.parametrize("error", [robocell.SpecError, robocell.IoError, robocell.Error])
def test_an_exception_of_the_child_is_raised_after_library_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
):
    told = tmp_path / "told"
    told.write_text(json.dumps({"failed": Failure.of(error("run.yaml:3:1: 'x'")).to_json()}))
    ends(tmp_path, monkeypatch, f"echo chatter; cat '{told}'; exit 1")
    with pytest.raises(error) as raised:
        check_in_child(RunSource("run.yaml"), [])
    assert type(raised.value) is error
    assert str(raised.value) == "run.yaml:3:1: 'x'"


def test_scene_warnings_are_reported_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    ends(tmp_path, monkeypatch, """echo chatter; echo '{"warnings": ["a", "b"]}'""")
    assert check_in_child(RunSource("run.yaml"), []) == Found(["a", "b"])
    ends(tmp_path, monkeypatch, "true")
    assert check_in_child(RunSource("run.yaml"), []) == Found([])


def test_the_ffmpeg_version_is_passed_to_later_processes(tmp_path: Path):
    run = str(write_run(tmp_path))
    ((name, answer),) = check_in_child(RunSource(run), []).environment.items()
    assert name == "ROBOCELL_FFMPEG_ANSWER"
    assert answer.partition("\t")[2].startswith("ffmpeg version ")
    assert check_in_child(RunSource(run), ["cameras.streams=[]"]).environment == {}, (
        "it is not asked for nothing"
    )


@pytest.mark.parametrize("below", ["", "deeper/dataset"])
@pytest.mark.parametrize("option", ["--workers=1", "--dry-run"])
def test_rejects_a_file_as_the_output_folder(tmp_path: Path, option: str, below: str):
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    text = refused("generate", write_run(tmp_path), "--output", file / below, option, code=3)
    assert f"output '{file / below}': '{file}' is a file, and a dataset is a folder" in text
    assert "Name another one (--output), or move the file away" in text
    assert file.read_text() == "mine"


def test_a_model_that_stalls_the_engine_is_stopped_after_the_timeout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    ends(tmp_path, monkeypatch, "exec sleep 60")
    began = time.monotonic()
    (slow,) = check_in_child(RunSource("run.yaml"), [], 0.3).warnings
    assert slow == "the run could not be looked through within 0.3 s: a model takes too long"
    assert time.monotonic() - began < 20
