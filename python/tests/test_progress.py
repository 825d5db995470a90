"""What a run shows while it goes on and at its end, as text."""

from __future__ import annotations

import io
import json
from pathlib import Path

from rich.console import Console

from robocell.generate.items import ItemResult, counts_text
from robocell.generate.progress import Bar, JsonLines, PlainLines, beginning, status
from robocell.generate.summary import Summary
from robocell.generate.totals import Totals, Unmade, duration, percent

RESULT = ItemResult(
    "s0000_e0001",
    success=True,
    attempts=4,
    accepted=2,
    refusals={"too far": 2},
    failures={"dropped": 1},
    redrawn={"no base pose is free of collisions": 6},
    rows=80,
    seconds={"sampling": 1.0, "acting": 6.0, "rendering": 2.0, "writing": 1.0},
)


def totals_after_one() -> Totals:
    totals = Totals(planned=20, already=5, workers=2)
    totals.started, totals.ended = 100.0, 110.0
    totals.add(RESULT)
    return totals


def test_what_an_interruption_ended_is_no_failure():
    totals = totals_after_one()
    before = (totals.attempts, totals.success_rate, totals.acceptance_rate)
    totals.add(ItemResult("s0000_e0002", stopped=True, undecided=1))
    assert (totals.attempts, totals.success_rate, totals.acceptance_rate) == before
    assert totals.to_json()["undecided"] == 1
    rows = Summary("demo", Path("out"), 6, totals).rows()
    assert rows["dropped"] == (
        "1 attempt under way when the run stopped; made again by the next command"
    )
    assert "dropped" not in Summary("demo", Path("out"), 6, totals_after_one()).rows()


def test_counts_are_ordered_by_number_then_name():
    assert counts_text({"b": 1, "a": 1, "c": 5}) == "c 5, a 1, b 1"
    assert counts_text({"b": 1, "a": 1, "c": 5}, limit=1) == "c 5, and 2 more"
    assert counts_text({}) == ""


def test_durations_and_shares_read_like_words():
    assert [duration(s) for s in (None, 0.4, 59, 61, 3900)] == [
        "-",
        "0 s",
        "59 s",
        "1 min 01 s",
        "1 h 05 min",
    ]
    assert [percent(s) for s in (None, 0, 0.955)] == ["-", "0 %", "96 %"]


def test_the_status_has_rate_time_left_success_and_reasons():
    totals = totals_after_one()
    assert (
        status(totals)
        == "360/h, 2 min 20 s left, success 50 %, refused: too far 2, failed: dropped 1"
    )
    assert beginning(totals) == "20 episodes (5 are there), 2 workers"


def test_plain_lines_come_seldom_and_say_what_happened():
    file = io.StringIO()
    lines = PlainLines(file, interval_s=1000)
    totals = totals_after_one()
    lines.started(totals)
    for _ in range(3):
        lines.episode(RESULT, totals)
    lines.retry("s0000_e0002", "worker 1 (pid 7) was killed by SIGSEGV", totals)
    lines.unmade(
        Unmade("s0000_e0003", "dropped 20", "robocell generate r.yaml --shard 3/20"), totals
    )
    lines.stopping("Ctrl-C", totals)
    lines.finished(totals)
    assert file.getvalue().splitlines() == [
        "20 episodes (5 are there), 2 workers",
        f"6/20 episodes, {status(totals)}",
        "s0000_e0002 is made again: worker 1 (pid 7) was killed by SIGSEGV",
        "s0000_e0003 could not be made: dropped 20",
        "  try it alone: robocell generate r.yaml --shard 3/20",
        "stopping (Ctrl-C); finished episodes are kept; interrupt again to kill",
        f"6/20 episodes, {status(totals)}",
    ]


def test_the_last_plain_line_comes_once():
    file = io.StringIO()
    lines = PlainLines(file, interval_s=0)
    totals = totals_after_one()
    totals.planned = 7
    lines.episode(RESULT, totals)
    totals.unmade.append(Unmade("s0000_e0003", "dropped 20", ""))
    lines.episode(RESULT, totals)
    lines.finished(totals)
    assert [line[:12] for line in file.getvalue().splitlines()] == ["6/7 episodes"] * 2


def test_the_bar_shows_the_same_and_keeps_lines_above_it():
    console = Console(file=io.StringIO(), force_terminal=True, width=120, color_system=None)
    bar = Bar(console)
    totals = totals_after_one()
    bar.started(totals)
    bar.unmade(Unmade("s0000_e0003", "[dropped] 20", ""), totals)
    bar.tick(totals)
    bar.finished(totals)
    shown = console.file.getvalue()
    assert "s0000_e0003 could not be made: [dropped] 20" in shown
    assert "6/20" in shown
    assert "success 50 %" in shown


def test_json_lines_are_one_object_per_event():
    file = io.StringIO()
    lines = JsonLines(file)
    totals = totals_after_one()
    lines.started(totals)
    lines.episode(RESULT, totals)
    lines.retry("a", "killed", totals)
    lines.unmade(Unmade("b", "dropped 20", "robocell generate"), totals)
    lines.warning("look")
    lines.stopping("SIGTERM", totals)
    lines.finished(totals)
    events = [json.loads(line) for line in file.getvalue().splitlines()]
    assert [event["event"] for event in events] == [
        *("started", "episode", "retry", "unmade", "warning", "stopping", "finished")
    ]
    assert ItemResult.from_json(events[1]["result"]) == RESULT
    assert events[1]["totals"]["made"] == 1
    assert events[1]["totals"]["refusals"] == {"too far": 2}
    assert events[3] == {
        "event": "unmade",
        "id": "b",
        "reason": "dropped 20",
        "reproduce": "robocell generate",
    }


def test_the_summary_counts_from_the_disk_and_leaves_out_what_did_not_happen():
    totals = totals_after_one()
    rows = Summary("demo", Path("out/demo"), on_disk=6, totals=totals).rows()
    assert rows == {
        "episodes": "6 of 20 (5 made before)",
        "success": "50 % of 2 rollouts",
        "starts accepted": "50 % of 4 sampled",
        "places accepted": "20 % of 10 tried",
        "placed again": "no base pose is free of collisions 6",
        "rate": "360 episodes/h: 1 in 10 s on 2 workers",
        "refusals": "too far 2",
        "failures": "dropped 1",
        "time": "sampling 1.0 s (10 %), acting 6.0 s (60 %), rendering 2.0 s (20 %), "
        "writing 1.0 s (10 %)",
        "dataset": str(Path("out/demo").resolve()),
    }
    nothing_to_do = Summary("demo", Path("out"), on_disk=6, totals=Totals(planned=6, already=6))
    assert list(nothing_to_do.rows()) == ["episodes", "dataset"]
    totals.unmade.append(Unmade("s0000_e0003", "dropped 20", ""))
    table = Summary("demo", Path("out/demo"), on_disk=6, totals=totals).table()
    console = Console(file=io.StringIO(), width=100)
    console.print(table)
    text = console.file.getvalue()
    assert "given up" in text
    assert "s0000_e0003" in text
