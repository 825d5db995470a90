"""Conditions on episodes: which episodes they select, and the errors of invalid ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

import robocell
from robocell.data._where import Condition

FIELDS = {
    "success": True,
    "truncated": False,
    "length": 150.0,
    "task": "pick up the nut",
    "rates.policy_ms": 66.0,
    "seed": 9007199254740993,  # no float is equal to it
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("success", True),
        ("truncated", False),
        ("not success", False),
        ("not not success", True),
        ("success and length < 200", True),
        ("success and length < 150", False),
        ("length <= 150 and length >= 150.0", True),
        ("length > 1e2", True),
        ("length != 150", False),
        ("truncated or length == 150", True),
        ("truncated and truncated or success", True),  # "and" binds closer
        ("truncated and (truncated or success)", False),
        ("not truncated and success", True),  # "not" binds closest
        ("not (truncated or success)", False),
        ("success == true and truncated != true", True),
        ("task contains 'nut'", True),
        ('task == "pick up the nut"', True),
        ("task < 'q'", True),
        ("rates.policy_ms == 66", True),
        ("length>-5and(success)", True),
        ("scene == 3", False),  # some episodes have none
        ("not scene == 3", True),
        ("seed == 9007199254740993", True),
        ("seed == 9007199254740992", False),
        ("seed < " + "9" * 5000, True),
    ],
)
def test_conditions_hold(text: str, expected: bool):
    assert Condition.parse(text).holds(FIELDS) is expected


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "the condition is empty; an example: success and length < 200"),
        ("success and", "character 12: the end instead of a field of episodes"),
        ("success length", "character 9: 'length' instead of 'and' or 'or'"),
        ("length = 3", "character 8: '=' has no meaning here. A comparison is written =="),
        ("length <", "the end instead of a number, a text in quotes, true or false"),
        ("task == nut", "'nut' instead of a number, a text in quotes, true or false: \"nut\" with"),
        ("(success", "the end instead of ')'"),
        ("success)", "character 8: ')' instead of 'and' or 'or'"),
        ("3 < length", "'3' instead of a field of episodes, such as success or length"),
        ("__import__('os')", "character 11: '(' instead of 'and' or 'or'"),
        ("length < 'a", "has no meaning here"),
        ("(" * 200 + "success" + ")" * 200, "more than 100 levels"),
        ("success or " * 2000 + "success", "a condition has at most 10000 characters"),
    ],
)
def test_texts_that_are_no_conditions_are_named(text: str, told: str):
    with pytest.raises(robocell.ArgumentError) as raised:
        Condition.parse(text)
    assert told in str(raised.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("length", "'length' is a number, here 150.0; compare it: length == 150"),
        ("success < 3", "'success' is true or false and 3 is a number"),
        ("length == '3'", "'length' is a number and \"3\" is a text"),
        ("length contains 3", "contains is for texts"),
        ("success < true", "'success' is true or false; compare with == or !="),
    ],
)
def test_types_that_do_not_fit_are_named(text: str, told: str):
    with pytest.raises(robocell.ArgumentError) as raised:
        Condition.parse(text).holds(FIELDS)
    assert told in str(raised.value)


def test_unknown_fields_get_a_suggestion():
    condition = Condition.parse("success and lenght < 3 and succes")
    assert condition.names == ["success", "lenght", "succes"]
    with pytest.raises(robocell.NotFoundError) as raised:
        condition.require_known(FIELDS)
    assert "character 13: episodes have no 'lenght'. Did you mean 'length'? They have: " in str(
        raised.value
    )


@given(st.text("()<>=!'\" .andort3e-", max_size=30))
def test_no_text_does_anything_but_parse_or_be_refused(text: str):
    try:
        condition = Condition.parse(text)
    except robocell.ArgumentError:
        return
    at = 0
    for name in condition.names:
        at = text.index(name, at) + len(name)
    assert condition.names
