"""The log in Python: a function of one's own instead of stderr."""

from __future__ import annotations

import subprocess
import sys
import textwrap
import threading
from collections.abc import Iterator

import pytest

import robocell as rc
from test_in_use import cell

Lines = list[tuple[str, str]]


@pytest.fixture
def lines() -> Iterator[Lines]:
    kept: Lines = []
    before = rc.log.set_log_sink(lambda level, text: kept.append((level, text)))
    yield kept
    rc.log.set_log_sink(before)


def command_beyond_limits(scene: rc.Scene) -> None:
    """Does what the log warns of once in a scene."""
    robot = scene.robot("a")
    robot.jnt_pos_cmd[0] = 100
    robot.update()


def test_a_sink_gets_level_and_message(lines: Lines):
    command_beyond_limits(cell())
    assert [level for level, _ in lines] == ["warn"]
    assert "joint 'joint1'" in lines[0][1]


def test_a_sink_gets_only_messages_at_its_level(lines: Lines):
    before = rc.log.log_level()
    rc.log.set_log_level("error")
    try:
        command_beyond_limits(cell())
    finally:
        rc.log.set_log_level(before)
    assert lines == []


def test_setting_a_sink_returns_the_previous_one(lines: Lines):
    def first(level: str, text: str) -> None:
        """Take it and keep nothing."""

    ours = rc.log.set_log_sink(first)
    ours("warn", "through the former one")
    assert lines == [("warn", "through the former one")]
    assert rc.log.set_log_sink(None) is first
    assert rc.log.set_log_sink(ours) is None


def test_rejects_a_sink_that_is_not_callable(lines: Lines):
    message = r"set_log_sink\(\): `sink` must be a function \(level, message\) or None, got 7"
    with pytest.raises(TypeError, match=message):
        rc.log.set_log_sink(7)
    command_beyond_limits(cell())
    assert len(lines) == 1


def test_an_exception_in_a_sink_is_reported_and_the_call_completes(monkeypatch: pytest.MonkeyPatch):
    told = []
    monkeypatch.setattr(
        sys, "unraisablehook", lambda each: told.append((each.object, str(each.exc_value)))
    )

    def broken(level: str, text: str) -> None:
        raise ValueError(f"no {level} wanted")

    before = rc.log.set_log_sink(broken)
    try:
        command_beyond_limits(cell())
    finally:
        rc.log.set_log_sink(before)
    assert told == [(broken, "no warn wanted")]


def test_ctrl_c_in_a_sink_interrupts():
    def interrupted(level: str, text: str) -> None:
        raise KeyboardInterrupt

    def log_and_go_on() -> None:
        command_beyond_limits(cell())
        cell()  # heard at the next look

    before = rc.log.set_log_sink(interrupted)
    try:
        with pytest.raises(KeyboardInterrupt):
            log_and_go_on()
    finally:
        rc.log.set_log_sink(before)


def test_messages_of_all_threads_reach_the_sink(lines: Lines):
    scenes = [cell() for _ in range(4)]
    threads = [threading.Thread(target=command_beyond_limits, args=[s]) for s in scenes]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(lines) == len(scenes)


def test_a_process_exits_with_a_custom_sink_set():
    code = """
        import robocell as rc
        class Sink:
            def __call__(self, level, text):
                raise AssertionError
            def __del__(self):
                print("let go of")
        rc.log.set_log_sink(Sink())
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=True
    )
    assert done.stdout == "let go of\n"
    assert done.stderr == ""
