"""What a run shows while it goes on and at its end, as text."""

from __future__ import annotations

import io
import json

from rich.console import Console

from robocell._generation.items import ItemRecord
from robocell._generation.observer import CANNOT_GO_ON
from robocell._generation.progress import Bar, JsonLines, PlainLines, beginning, status
from robocell._generation.totals import Unmade
from test_totals import RESULT, totals_after_one


def test_the_status_has_rate_time_left_success_and_reasons():
    totals = totals_after_one()
    assert (
        status(totals)
        == "360/h, 2 min 20 s left, success 50 %, refused: too far 2, failed: dropped 1"
    )
    assert beginning(totals) == "20 episodes (5 on the disk), 2 workers"


def test_plain_lines_are_rare_and_describe_events():
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
        "20 episodes (5 on the disk), 2 workers",
        f"6/20 episodes, {status(totals)}",
        "s0000_e0002 is made again: worker 1 (pid 7) was killed by SIGSEGV",
        "s0000_e0003 could not be made: dropped 20",
        "  try it alone: robocell generate r.yaml --shard 3/20",
        "stopping (Ctrl-C); finished episodes are kept; interrupt again to kill",
        f"6/20 episodes, {status(totals)}",
    ]


def test_a_reason_is_printed_once_for_each_item():
    file = io.StringIO()
    lines = PlainLines(file)
    totals = totals_after_one()
    for item in ("a", "b"):
        lines.retry(item, "KeyError: 'cup' (own.py:3, in judge)", totals)
    lines.retry("a", "killed", totals)
    lines.unmade(Unmade("a", "killed\nits log", ""), totals)
    lines.unmade(Unmade("b", "KeyError: 'cup' (own.py:3, in judge)", "robocell generate"), totals)
    assert file.getvalue().splitlines() == [
        "a is made again: KeyError: 'cup' (own.py:3, in judge)",
        "b is made again: KeyError: 'cup' (own.py:3, in judge)",
        "a is made again: killed",
        "a could not be made: the same error again",
        "its log",
        "b could not be made: the same error again",
        "  try it alone: robocell generate",
    ]


def test_a_run_that_ends_itself_was_not_interrupted():
    file = io.StringIO()
    PlainLines(file, interval_s=0).stopping(CANNOT_GO_ON, totals_after_one())
    assert file.getvalue() == "stopping (it cannot go on); finished episodes are kept\n"


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
    bar.warning("the table is low")
    bar.tick(totals)
    bar.finished(totals)
    shown = console.file.getvalue()
    assert "s0000_e0003 could not be made: [dropped] 20" in shown
    assert "warning: the table is low" in shown
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
    assert ItemRecord.from_json(events[1]["result"]) == RESULT
    assert events[1]["totals"]["made"] == 1
    assert events[1]["totals"]["refusals"] == {"too far": 2}
    assert events[3] == {
        "event": "unmade",
        "id": "b",
        "reason": "dropped 20",
        "reproduce": "robocell generate",
    }
