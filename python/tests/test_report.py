"""The report of a run: a file beside the episodes, and the table that is made from the disk."""

from __future__ import annotations

import json
import os
import shutil
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import robocell
from command_line import refused, robocell_command, write_run
from robocell._generation import report as reports
from robocell._generation.check import Found
from robocell._generation.items import ItemRecord
from robocell._generation.job import Job
from robocell._generation.observer import Observer
from robocell._generation.report import Command, DamagedReportError, RunReport
from robocell._generation.summary import Summary
from robocell._generation.totals import (
    Again,
    Death,
    Totals,
    Unmade,
)

IDS = ["s0000_e0000", "s0000_e0001"]


def made(name: str) -> ItemRecord:
    return ItemRecord(
        name,
        success=True,
        attempts=3,
        accepted=2,
        refusals={"too far": 1},
        failures={"dropped": 1},
        redrawn={"no free place": 4},
        rows=70,
        seconds={"acting": 0.5},
        robot="rc7",
        object_kind="mug",
        kinds={"mug": 3},
        rollouts={"mug": 2},
    )


def command(*names: str, planned: int, seconds: float) -> Command:
    totals = Totals(planned=planned, workers=2, started=0.0)
    for name in names:
        totals.add(made(name))
    totals.ended = seconds
    totals.deaths.append(Death(1, 77, names[0], "was killed by SIGKILL (out of memory?)", 1.5))
    totals.again.append(Again(names[0], "worker 1 (pid 77) was killed by SIGKILL"))
    totals.unmade.append(Unmade("z", "dropped 20", "robocell generate r.yaml --shard 3/20"))
    return Command("2026-01-01T00:00:00+00:00", "2026-01-01T00:00:09+00:00", "here", "", "", totals)


def a_report(*commands: tuple[str, ...]) -> RunReport:
    report = RunReport("demo", "hash", (0, 1), {"mujoco": "4.0.0"})
    for names in commands:
        told = [made(name) for name in names]
        report.add(command(*names, planned=5, seconds=10.0), told, ["a", "b", "c", "d", "z"])
    return report


def test_a_report_round_trips(tmp_path: Path):
    written = a_report(("b",), ("c", "a"))
    reports.save(tmp_path / "report.json", written)
    read = reports.load(tmp_path / "report.json")
    assert read.to_json() == written.to_json()
    assert read.totals.record() == written.totals.record()
    assert list(read.episodes) == ["a", "b", "c"], "in the plan's order"
    assert read.commands[0].totals.deaths == written.commands[0].totals.deaths
    assert [path.name for path in tmp_path.iterdir()] == ["report.json"]


def test_retrying_an_item_adds_no_item():
    whole_run = a_report(("a", "b", "c", "d"))
    again = RunReport("demo", "hash", (4, 5), {})
    again.add(command("z", planned=1, seconds=2.0), [replace(made("z"), success=False)], ["z"])
    totals = reports.whole([whole_run, again])
    assert totals.planned == 5
    assert [unmade.id for unmade in totals.unmade] == ["z"]
    assert (totals.elapsed_s, totals.workers, totals.attempts) == (12.0, 2, 15)
    again.add(command("z", planned=1, seconds=2.0), [made("z")], ["z"])
    assert reports.whole([whole_run, again]).unmade == [], "it is made now"


def test_a_report_without_commands_counts_nothing():
    nothing = RunReport("demo", "hash", (0, 1), {})
    assert len(nothing.places) == 0
    assert (reports.whole([nothing]).planned, reports.whole([nothing]).elapsed_s) == (0, 0.0)
    assert reports.whole([nothing, a_report(("a",))]).made == 1


def test_reports_more_episodes_than_the_last_command_requested():
    totals = a_report(("a",)).totals
    assert Summary("r", Path(), 4, totals).rows()["episodes"] == "4 of 5"
    assert Summary("r", Path(), 7, totals).rows()["episodes"] == (
        "7 (the last command requested 5)"
    )


def test_names_the_shards_that_have_no_report():
    first, last = (RunReport("demo", "hash", (index, 3), {}) for index in (0, 2))
    for shard, name in ((first, "a"), (last, "c")):
        shard.add(command(name, planned=5, seconds=1.0), [made(name)], [name])
    assert reports.unreported_shards([first, last]) == ["1/3"]
    totals = reports.whole([first, last])
    rows = Summary("r", Path(), 12, totals, {}, 2, ["1/3"]).rows()
    assert rows["episodes"] == "12 on the disk (no report of shard 1/3; the others requested 10)"
    middle = RunReport("demo", "hash", (1, 3), {})
    assert reports.unreported_shards([first, middle, last]) == ["1/3"], "it has no command yet"
    middle.add(command("b", planned=5, seconds=1.0), [made("b")], ["b"])
    every = [first, middle, last]
    assert reports.unreported_shards(every) == []
    complete = Summary("r", Path(), 15, reports.whole(every), {}, 3)
    assert complete.rows()["episodes"] == "15 of 15"
    more = Summary("r", Path(), 18, reports.whole(every), {}, 3)
    assert more.rows()["episodes"] == "18 (the last commands of the shards requested 15)"
    assert reports.unreported_shards([a_report(("a",)), last]) == [], "the whole run has reported"


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"format": "robocell-report"}', "\0"])
def test_rejects_a_damaged_report_and_names_its_path(tmp_path: Path, text: str):
    path = tmp_path / "report.json"
    path.write_text(text)
    with pytest.raises(DamagedReportError, match=r"report\.json' is damaged: "):
        reports.load(path)


def test_every_cut_and_every_flipped_bit_of_a_report_is_found(tmp_path: Path):
    path = tmp_path / "report.json"
    reports.save(path, a_report(("a",)))
    whole = path.read_bytes().rstrip()
    for length in range(0, len(whole), max(1, len(whole) // 100)):
        flipped = whole[:length] + bytes([whole[length] ^ 1 << length % 8]) + whole[length + 1 :]
        for damaged in (whole[:length], flipped + b"\n"):
            path.write_bytes(damaged)
            with pytest.raises(DamagedReportError, match=r"report\.json' is damaged: "):
                reports.load(path)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One episode by a first command, another by a second."""
    folder = tmp_path_factory.mktemp("report")
    run = write_run(folder)
    for options in (("--episodes", 1), ()):
        result = robocell_command("generate", run, "--progress", "jsonl", *options)
        assert result.returncode == 0, result.stderr
    return folder / "out"


def as_json(*arguments: object) -> dict[str, Any]:
    result = robocell_command("report", "--json", *arguments)
    assert result.returncode == 0, result.stderr
    content: dict[str, Any] = json.loads(result.stdout)
    return content


def test_a_run_leaves_its_report_and_going_on_adds_to_it(dataset: Path):
    report = reports.load(dataset / "report.json")
    assert report.run == "tiny"
    assert [command.end for command in report.commands] == ["complete", "complete"]
    first, second = (command.totals for command in report.commands)
    assert (first.planned, first.made, second.already, second.made) == (1, 1, 1, 1)
    assert list(report.episodes) == IDS
    assert all(entry.success and entry.attempts > 0 for entry in report.episodes.values())
    assert report.versions["mujoco"] == "4.0.0"
    assert {"robocell", "python"} <= report.versions.keys()
    for name, entry in report.episodes.items():
        assert entry.rows == len(robocell.Dataset(dataset)[name])


def test_a_command_without_work_is_not_listed(dataset: Path):
    before = (dataset / "report.json").read_bytes()
    run = dataset.parent / "run.yaml"
    assert robocell_command("generate", run).returncode == 0
    assert (dataset / "report.json").read_bytes() == before


def test_a_report_does_not_affect_verification(dataset: Path):
    verified = robocell.data.verify(dataset)
    assert (verified.ok, verified.good, verified.others) == (
        True,
        IDS,
        [".lock", ".lock-writers", ".logs"],
    )


def test_the_table_is_counted_on_the_disk(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    text = robocell_command("report", copy, "--episodes").stdout
    assert not [line for line in text.splitlines() if line != line.rstrip()]
    rows = sum(len(episode) for episode in robocell.Dataset(copy))
    assert "2 of 2" in text
    assert f"2 episodes, {rows} rows, {rows} frames, " in text
    assert "2 complete" in text
    assert "mujoco 4.0.0" in text
    assert text.count("success  ") >= 2, "a line for each episode"
    content = as_json(copy)
    stored = sum(file.stat().st_size for file in copy.glob("s*/*"))
    assert sum(episode["bytes"] for episode in content["on_disk"]) == stored
    shutil.rmtree(copy / IDS[1])
    assert "1 of 2" in robocell_command("report", copy).stdout


def test_without_a_report_episodes_are_counted_on_disk(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    (copy / "report.json").unlink()
    result = robocell_command("report", copy)
    assert result.returncode == 0
    assert "no report.json, so only the contents of the disk are reported" in result.stderr
    assert "a Runner writes none" in result.stderr
    assert "2 episodes, " in result.stdout
    assert " of 2" not in result.stdout, "nobody knows how many were planned"
    assert "100 % (2 episodes)" in result.stdout


def test_the_report_command_rejects_missing_and_damaged_input(dataset: Path, tmp_path: Path):
    (tmp_path / "empty" / ".quarantine").mkdir(parents=True)
    said = refused("report", tmp_path / "empty")
    assert "holds no episodes and no report: give the `robocell generate` command" in said
    assert "no dataset" in refused("report", tmp_path / "none")
    copy = shutil.copytree(dataset, tmp_path / "copy")
    (copy / "report.json").write_text("{")
    result = robocell_command("report", copy)
    assert result.returncode == 3
    assert "report.json' is damaged: " in result.stderr
    assert "The next `robocell generate` writes a new one" in result.stderr
    assert "no report.json" not in result.stderr
    assert "2 episodes, " in result.stdout, "the intact ones are counted all the same"
    for name in IDS:
        shutil.rmtree(copy / name)
    assert "report.json' is damaged: " in refused("report", copy, code=3)


def test_a_damaged_report_does_not_hide_the_others(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    (copy / "report-0-of-2.json").write_text("{")
    result = robocell_command("report", "--json", copy)
    assert result.returncode == 3
    assert "report-0-of-2.json' is damaged: " in result.stderr
    content = json.loads(result.stdout)
    assert [report["run"] for report in content["reports"]] == ["tiny"]
    assert content["totals"]["counts"]["made"] == 2


def test_copied_episodes_are_reported_and_not_counted(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    shutil.copytree(copy / IDS[0], copy / "best")
    other = replace(reports.load(copy / "report.json"), run="other", identity="0" * 64)
    reports.save(copy / "report-0-of-2.json", other)
    result = robocell_command("report", "--json", copy)
    assert result.returncode == 0, result.stderr
    content = json.loads(result.stdout)
    assert [episode["id"] for episode in content["on_disk"]] == IDS
    assert [report["run"] for report in content["reports"]] == ["tiny"]
    said = f"'{copy / 'best'}' holds episode '{IDS[0]}': it was copied or renamed, and does not"
    assert said in result.stderr
    assert "report-0-of-2.json' is of another run ('other'), and nothing in it" in result.stderr
    assert content["misnamed"] == robocell.Dataset(copy).misnamed == {"best": IDS[0]}


def test_a_damaged_report_does_not_stop_a_run(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "out")
    (copy / "report.json").write_text("{")
    shutil.rmtree(copy / IDS[1])
    result = robocell_command("generate", write_run(tmp_path))
    assert result.returncode == 0, result.stderr
    kept = copy / ".quarantine" / "report.json"
    assert f"'{copy / 'report.json'}' is damaged: " in result.stderr
    assert f"It is kept as '{kept}'; the new one begins with this command" in result.stderr
    assert kept.read_text() == "{"
    assert list(reports.load(copy / "report.json").episodes) == [IDS[1]]
    text = robocell_command("report", copy).stdout
    assert "1 episode, made by commands that were killed" in text


@pytest.mark.proof  # runs that go on are below
def test_shards_have_separate_reports_and_one_table(tmp_path: Path):
    run = write_run(tmp_path, cameras={"streams": []})
    for shard in ("0/2", "1/2"):
        assert robocell_command("generate", run, "--shard", shard).returncode == 0
    out = tmp_path / "out"
    names = sorted(path.name for path in out.glob("report*"))
    assert names == ["report-0-of-2.json", "report-1-of-2.json"]
    content = as_json(out)
    assert [list(r["shard"]) for r in content["reports"]] == [[0, 2], [1, 2]]
    assert content["totals"]["counts"]["planned"] == 2
    assert content["totals"]["counts"]["made"] == 2
    assert "2 of 2" in robocell_command("report", out).stdout


def test_a_failed_run_records_the_failure_in_its_report(tmp_path: Path):
    run = write_run(tmp_path, cameras={"streams": []}, max_attempts=1)
    result = robocell_command("generate", run, "--set", "task.lift_height=1", "--episodes", 1)
    assert result.returncode == 1, result.stderr
    (told,) = reports.load(tmp_path / "out" / "report.json").commands
    assert told.end == "incomplete"
    (unmade,) = told.totals.unmade
    assert unmade.id == IDS[0]
    kind = reports.load(tmp_path / "out" / "report.json").episodes[IDS[0]].object_kind
    assert kind in robocell.tasks.object_kinds()
    assert unmade.reason.startswith(f"robot 'rc7', object '{kind}': no success in ")
    assert unmade.reproduce.startswith("robocell generate ")
    assert "given up" in robocell_command("report", tmp_path / "out").stdout
    lines = robocell_command("report", tmp_path / "out", "--episodes").stdout.splitlines()
    words = next(line.split() for line in lines if line.split()[:1] == [IDS[0]])
    assert words[:5] == [IDS[0], "rc7", kind, "given", "up"]


def test_a_signal_after_the_last_worker_keeps_the_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    job = Job(write_run(tmp_path), [f"output={tmp_path / 'out'}"])
    job.items = []  # no worker at all
    write = Job._report

    def signalled(*arguments: Any) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        write(*arguments)

    monkeypatch.setattr(Job, "_look_through", lambda self, longest_s: Found([]))
    monkeypatch.setattr(Job, "_report", signalled)
    # A test run in the background may have it ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert not job.do(Observer()).outcome.interrupted
    finally:
        signal.signal(signal.SIGINT, before)
    (command,) = reports.load(tmp_path / "out/report.json").commands
    assert command.end == "complete"
