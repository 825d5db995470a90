"""benchmarks/policy_round_trip.py in short: both sides answer, and the rows are those of P18."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
import policy_round_trip
from floors import POLICIES
from table import markdown
from verdicts import judge


def test_round_trips_are_measured_on_both_sides_and_judged(tmp_path: Path):
    rows = policy_round_trip.rows(tmp_path, repetitions=2, calls=5)
    assert [len(row.ours) for row in rows] == [2, 2]
    assert [len(row.peer) for row in rows] == [2, 2]
    assert all(value > 0 for row in rows for value in (*row.ours, *row.peer))
    section = {"policy_round_trip": markdown(rows)}
    judged = [judge(floor, section) for floor in POLICIES]
    assert [verdict.floor.floor for verdict in judged] == [0.3, 2.0]
    assert all(verdict.says in ("**floor missed**", "floor met", "aim met") for verdict in judged)
    assert judged[0].floor.measure.text(0.25) == "0.25 ms"
