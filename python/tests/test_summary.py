"""The table at the end of a run."""

from __future__ import annotations

import io
from pathlib import Path

from rich.console import Console

from robocell._generation.items import ItemRecord
from robocell._generation.summary import Summary
from robocell._generation.totals import (
    Totals,
    Unmade,
    side_by_side,
)
from test_totals import totals_after_one


def test_the_summary_counts_on_disk_and_omits_empty_rows():
    totals = totals_after_one()
    rows = Summary("demo", Path("out/demo"), on_disk=6, totals=totals).rows()
    assert rows == {
        "episodes": "6 of 20 (5 made before)",
        "success": "50 % of 2 rollouts",
        "starts accepted": "50 % of 4 sampled",
        "placements": "20 % of 10 accepted",
        "placements rejected": "no base pose is free of collisions 6",
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


def test_the_summary_lists_success_per_object_kind():
    totals = Totals(planned=3)
    totals.add(
        ItemRecord("a", success=True, object_kind="mug", kinds={"mug": 1}, rollouts={"mug": 1})
    )
    assert "success by object" not in Summary("r", Path(), 1, totals).rows()
    totals.add(
        ItemRecord("b", success=True, object_kind="box", kinds={"box": 3}, rollouts={"box": 2})
    )
    totals.add(ItemRecord("c", object_kind="can", kinds={"can": 4}))
    totals.attempts, totals.accepted = 8, 3
    read = Totals.from_record(totals.record())
    for told in (totals, side_by_side([read])):
        text = Summary("r", Path(), 2, told).rows()["success by object"]
        assert text == "box 50 % of 2, can - of 0, mug 100 % of 1"
