"""benchmarks/record.py: what is measured anew replaces its own section of RESULTS.md only."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
from record import record, sections
from verdicts import BEGIN, END

ORDER = ("a", "b", "c")
TABLE = "- commit: 1\n\n| what |\n|---|\n| x |"


def test_sections_keep_their_order_in_any_order_of_runs(tmp_path: Path):
    path = tmp_path / "RESULTS.md"
    record(path, {"c": TABLE}, ORDER)
    record(path, {"a": "first\n"}, ORDER)
    assert list(sections(path.read_text())) == ["a", "c"]


def test_only_sections_that_ran_are_replaced(tmp_path: Path):
    path = tmp_path / "RESULTS.md"
    record(path, {"a": TABLE, "b": "old"}, ORDER)
    before = path.read_text()
    record(path, {"b": "new"}, ORDER)
    assert path.read_text() == before.replace("old", "new")


def test_the_recorded_results_are_read_whole():
    path = Path(__file__).parents[1] / "benchmarks/RESULTS.md"
    text = path.read_text()
    measured = text.replace(text[text.index(BEGIN) : text.index(END)], "")
    assert sum(body.count("\n|") for body in sections(text).values()) == measured.count("\n|")


def test_a_summary_precedes_all_sections(tmp_path: Path):
    path = tmp_path / "RESULTS.md"
    record(path, {"a": TABLE, "c": TABLE}, ORDER, ", ".join)
    record(path, {"b": TABLE}, ORDER, ", ".join)
    assert path.read_text().count("a, b, c\n## `a`") == 1
    assert "a, c" not in path.read_text()
