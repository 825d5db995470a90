"""The counts of a run: their sums, their records, and how they read."""

from __future__ import annotations

import json
from pathlib import Path

from robocell._generation import report as reports
from robocell._generation.items import ItemRecord
from robocell._generation.report import Command, RunReport
from robocell._generation.summary import Summary
from robocell._generation.totals import (
    Again,
    Death,
    Totals,
    Unmade,
    duration,
    one_after_the_other,
    percent,
    side_by_side,
    size,
)

RESULT = ItemRecord(
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


def test_interrupted_items_are_not_failures():
    totals = totals_after_one()
    before = (totals.attempts, totals.success_rate, totals.acceptance_rate)
    totals.add(ItemRecord("s0000_e0002", stopped=True, undecided=1))
    assert (totals.attempts, totals.success_rate, totals.acceptance_rate) == before
    assert totals.to_json()["undecided"] == 1
    rows = Summary("demo", Path("out"), 6, totals).rows()
    assert rows["dropped"] == (
        "1 attempt interrupted by the end of the run; repeated by the next command"
    )
    assert "dropped" not in Summary("demo", Path("out"), 6, totals_after_one()).rows()


def test_durations_and_shares_are_readable():
    assert [duration(s) for s in (None, 0.4, 59, 61, 3900)] == [
        "-",
        "0 s",
        "59 s",
        "1 min 01 s",
        "1 h 05 min",
    ]
    assert [percent(s) for s in (None, 0, 0.955)] == ["-", "0 %", "96 %"]


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


def test_counts_of_commands_are_summed():
    totals = a_report(("b",), ("c", "a")).totals
    assert (totals.planned, totals.made, totals.attempts, totals.rows) == (5, 3, 9, 210)
    assert (totals.elapsed_s, totals.workers, totals.retries, len(totals.deaths)) == (20.0, 2, 2, 2)
    assert totals.refusals == {"too far": 3}
    assert totals.redrawn == {"no free place": 12}
    assert [unmade.id for unmade in totals.unmade] == ["z"], "the last command knows"
    both = side_by_side([totals, totals])
    assert (both.planned, both.made, both.elapsed_s, both.workers) == (10, 6, 20.0, 4)


def test_sums_keep_the_advice_until_the_run_is_complete():
    totals = a_report(("b",)).totals
    totals.advice = "stand nearer"
    whole = one_after_the_other([side_by_side([a_report(("a",)).totals, totals])])
    assert whole.advice == "stand nearer"
    whole.failures.clear()
    assert whole.unmade
    assert Summary("r", Path(), 0, whole).rows()["hint"] == "stand nearer"
    whole.unmade.clear()
    assert "hint" not in Summary("r", Path(), 0, whole).rows()


def test_totals_round_trip_through_their_record():
    totals = a_report(("b",), ("c", "a")).commands[1].totals
    totals.already, totals.undecided, totals.advice = 1, 2, "stand nearer"
    nothing = Totals(planned=0, workers=0, started=-1.0)
    same = [name for name, value in vars(totals).items() if value == getattr(nothing, name)]
    assert same == [], "a field that nobody filled would come back whatever happens to it"
    totals.started = 0.0
    assert Totals.from_record(json.loads(json.dumps(totals.record()))) == totals


def test_shards_add_up_side_by_side():
    first, second = (RunReport("demo", "hash", (i, 2), {}) for i in (0, 1))
    first.add(command("a", "c", planned=3, seconds=10.0), [made("a"), made("c")], ["a", "c", "e"])
    second.add(command("b", planned=2, seconds=12.0), [made("b")], ["b", "d"])
    totals = reports.whole([first, second])
    assert (totals.planned, totals.made, totals.elapsed_s, totals.workers) == (5, 3, 12.0, 4)


def test_sizes_are_readable():
    assert [size(n) for n in (0, 999, 1234, 5_600_000, 7e12)] == [
        *("0 B", "999 B", "1.23 kB", "5.6 MB", "7 TB")
    ]
    assert [size(n) for n in (999.6, 999_499, 999_600, 999.7e6, 999.9e9, 1234e12)] == [
        *("1 kB", "999 kB", "1 MB", "1 GB", "1 TB", "1234 TB")
    ]


def test_when_time_runs_out_the_number_of_actions_is_named():
    totals = Totals(planned=3)
    totals.failures.update({"timeout": 2, "not lifted": 2})
    assert "hint" not in Summary("r", Path(), 0, totals).rows()
    totals.failures["timeout"] += 1
    hint = "most failures are rollouts that ran out of actions: raise `rates.max_steps`"
    assert Summary("r", Path(), 0, totals).rows()["hint"] == hint
