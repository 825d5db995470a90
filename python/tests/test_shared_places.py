"""Containers and arrays that two places share."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robocell._shared_places import shared_places


class Tracker:
    def __init__(self, points: Any) -> None:
        self.points = points


def pairs(**attributes: Any) -> list[tuple[str, str]]:
    found = shared_places(
        attributes.items(),
        object(),
        lambda value: isinstance(value, Tracker),
        lambda value: vars(value).items(),
    )
    return [(str(one), str(other)) for one, other in found]


@pytest.mark.parametrize("made", [list, dict, set, lambda: np.zeros(2)])
def test_finds_the_second_place_at_any_depth(made: Any):
    value = made()
    assert pairs(a=value, b=made()) == []
    assert pairs(a=value, b=value) == [("a", "b")]
    assert pairs(a={"x": value}, b=(0, [value])) == [("a['x']", "b[1][0]")]
    assert pairs(a=value, b=Tracker([value])) == [("a", "b.points[0]")]


def test_views_share_their_numbers_where_they_overlap():
    table = np.zeros((4, 3))
    assert pairs(a=table, b=table[1]) == [("a", "b")]
    assert pairs(a=table[:2], b=table[1:3].T) == [("a", "b")]
    assert pairs(a=table[:2], b=table[2:]) == []
    assert pairs(a=table[:, 0], b=table[:, 1]) == []
    assert pairs(a=table[0].copy(), b=table) == []


def test_an_object_in_two_places_is_one_place():
    tracker = Tracker([1])
    assert pairs(a=tracker, b=tracker, c=[tracker]) == []
    assert pairs(a=Tracker(tracker.points), b=tracker) == [("a.points", "b.points")]


def test_a_list_that_contains_itself_is_a_second_place():
    loop: list[Any] = []
    loop.append(loop)
    assert pairs(a=loop) == [("a", "a[0]")]


def test_immutable_values_may_be_shared():
    text, pair = "x" * 30, (1, "y")
    assert pairs(a=[text, pair], b={"k": pair}, c=text) == []
