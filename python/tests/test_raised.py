"""Where a user's code raised, and the text of a hook's error."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

import robocell as rc
from robocell._generation.protocol import Failure
from robocell._generation.run_source import import_module
from robocell._raised import (
    LONGEST_MESSAGE,
    is_of_users,
    message_and_place,
    place_of,
    text_of_hook,
    trace_of,
    where,
    without_names,
)


def test_an_error_without_code_of_a_user_has_no_place():
    assert place_of(ValueError("text")) == "ValueError: text"


def raised_in(tmp_path: Path, call: str) -> Exception:
    """What a function of a user's module raised."""
    name = f"raises_{abs(hash(tmp_path))}"
    text = f"import json\nimport numpy as np\n\n\ndef judge():\n    return {call}\n"
    (tmp_path / f"{name}.py").write_text(text)
    module = import_module(f"{name}.py", tmp_path)
    try:
        with pytest.raises(BaseException) as raised:
            module.judge()
        return raised.value
    finally:
        sys.modules.pop(name)


@pytest.mark.parametrize(
    "call", ["json.loads('x')", "np.linalg.inv(np.zeros((2, 2)))", "eval('x y')", "[][0]", "exit()"]
)
def test_the_place_of_an_error_is_in_user_code(tmp_path, monkeypatch, call):
    monkeypatch.setattr(sys, "path", list(sys.path))
    error = raised_in(tmp_path, call)
    assert is_of_users(error)
    assert where(error).startswith(f" ({tmp_path}/")
    assert where(error).endswith(".py:6, in judge)")


def test_frames_of_the_standard_library_are_not_user_code():
    with pytest.raises(ValueError) as raised:
        json.loads("x")
    error = raised.value
    assert "test_raised.py" in where(error)
    error.__traceback__ = error.__traceback__.tb_next  # as when robocell calls it
    assert not is_of_users(error)
    assert where(error) == ""


def test_an_error_without_readable_text_is_reported_by_its_class(tmp_path):
    class MuteError(Exception):
        def __str__(self) -> str:
            raise RuntimeError("no text")

    assert place_of(MuteError()) == "MuteError: (its text cannot be made)"
    assert Failure.of(MuteError()).message == "MuteError: (its text cannot be made)"


def test_the_message_of_a_hook_is_one_short_line():
    assert message_and_place(ValueError("two\n  lines")) == ("ValueError: two lines", "")
    message, _ = message_and_place(KeyError("x" * 1000))
    assert len(message) == LONGEST_MESSAGE + len(" ...")
    assert message.endswith(" ...")
    message, _ = message_and_place(ValueError("word " * 100))
    assert message.endswith("word ...")
    assert len(message) <= LONGEST_MESSAGE + len(" ...")


def test_a_long_list_of_names_is_cut_after_a_name():
    names = [f"robots/left/joint_{number:03d}" for number in range(40)]
    for more in ("", " and 5 more"):
        error = rc.NotFoundError(f"no 'x'. It has: {', '.join(names)}{more}")
        message, _ = message_and_place(error)
        assert len(message) <= LONGEST_MESSAGE + len(" and 45 more")
        *listed, last = message.partition("It has: ")[2].split(", ")
        last, _, rest = last.partition(" and ")
        assert [*listed, last] == names[: len(listed) + 1]
        assert rest == f"{40 - len(listed) - 1 + (5 if more else 0)} more"
    message, _ = message_and_place(rc.NotFoundError(f"There are: {', '.join(names)}. Choose one"))
    assert message.endswith(" ..."), "the rest is not a list"


def test_an_error_without_the_names_is_the_same_for_all_rows():
    near = "act(): the row has no 'x'. Did you mean 'y'?"
    place = " (policy.py:5, in act)"
    for names in ("a, y", "y and 3 more"):
        assert without_names(f"{near} It has: {names}{place}") == near + place
        assert without_names(f"{near} It has: {names}") == near
    assert without_names("timeout") == "timeout"


def test_the_message_of_robocells_own_error_needs_no_class():
    assert message_and_place(rc.SpecError("no such thing")) == ("no such thing", "")


def test_the_message_of_a_hook_names_one_place():
    """The text of an error that went through another hook ends with its place already."""
    try:
        raise rc.ArgumentError("no body 'a' (tasks.py:12, in judge)")
    except rc.ArgumentError as error:
        said = text_of_hook(error)
    assert said.startswith("no body 'a' (tasks.py:12, in judge)")
    assert message_and_place(TypeError("odd (tasks.py:1, in act)")) == (
        "TypeError: odd",
        "tasks.py:1, in act",
    )


def test_the_trace_of_an_error_ends_with_its_text():
    def fails() -> None:
        raise ValueError("no cubes")

    with pytest.raises(ValueError) as raised:
        fails()
    lines = trace_of(raised.value).splitlines()
    assert lines[0].startswith("Traceback")
    assert any("in fails" in line for line in lines)
    assert lines[-1] == "ValueError: no cubes"
