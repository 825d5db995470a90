"""benchmarks/export_lerobot.py and evaluation_rate.py in short: what they count."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
import evaluation_rate
import export_lerobot
from floors import EVALUATIONS, EXPORTS
from table import Row, markdown
from verdicts import judge


def test_an_evaluation_and_the_environment_alone_take_as_many_actions(tmp_path: Path):
    rows = evaluation_rate.rows(tmp_path, repetitions=1, rollouts=2)
    assert all(row.ours[0] > 0 for row in rows)
    assert all(row.peer[0] > 0 for row in rows)
    for floor in EVALUATIONS:
        verdict = judge(floor, {"evaluation_rate": markdown(rows)})
        assert verdict.says in ("**floor missed**", "floor met", "aim met", "aim missed")


def test_an_export_counts_the_frames_of_both_cameras(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    class Made:
        encoded: dict[str, str] = {}  # noqa: RUF012
        cameras, frames = 2, 50

    def export(dataset: object, out: Path) -> Made:
        (out / "meta").mkdir(parents=True)
        (out / "meta/info.json").write_text('{"total_frames": 50}')
        return Made()

    monkeypatch.setattr(export_lerobot, "export_dataset", export)
    monkeypatch.setattr(export_lerobot.time, "perf_counter", iter([1.0, 1.5]).__next__)
    assert export_lerobot.exported_per_s([], tmp_path, 0) == 200  # type: ignore[arg-type]


def test_exports_are_judged_alone_and_beside_the_peer():
    name = "frames exported as LeRobot v3.0, two cameras 640x480, rc7"
    note = "100 episodes; peer: lerobot==0.4.4 on 4 of them"
    row = Row(name, "1/s", [4000], [200], better="higher", note=note)
    says = [judge(floor, {"export_lerobot": markdown([row])}).says for floor in EXPORTS]
    assert says == ["floor met", "floor met"]
