"""benchmarks/houses.py in short: what it counts, and how row P16 is judged."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
import houses
from floors import HOUSES
from table import markdown
from verdicts import judge


def test_the_rows_are_those_that_are_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name in ("house_a.xml", "house_a_ceiling.xml", "house_b.xml"):  # b has no ceiling: a part
        (tmp_path / name).touch()
    assert [file.name for file in houses.house_files(tmp_path)] == ["house_a.xml"]
    monkeypatch.setattr(houses, "house_files", lambda folder: [tmp_path / "house_a.xml"])
    monkeypatch.setattr(houses, "milliseconds", lambda program, *arguments: 40.0)
    monkeypatch.setattr(houses, "episodes_of", lambda run, out, seed, options: 600.0)
    monkeypatch.setattr(houses.subprocess, "run", lambda *words, **options: None)
    section = {"houses": markdown(houses.rows(tmp_path))}
    says = {floor.what: judge(floor, section).says for floor in HOUSES}
    assert says == {
        "a house with a robot, compiled": "aim met",
        "the same in a later process": "aim met",
        "reset of a house": "**floor missed**",
        "pick episodes in houses an hour, without cameras": "floor met",
        "pick episodes in houses an hour, with two cameras 320x240": "floor met",
    }
