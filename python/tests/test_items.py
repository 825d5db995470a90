"""Items of a plan, and what became of them."""

from __future__ import annotations

from robocell._generation.items import counts_text


def test_counts_are_sorted_by_number_then_name():
    assert counts_text({"b": 1, "a": 1, "c": 5}) == "c 5, a 1, b 1"
    assert counts_text({"b": 1, "a": 1, "c": 5}, limit=1) == "c 5, and 2 more"
    assert counts_text({}) == ""
