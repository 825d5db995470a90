"""Signals become stop requests or interruptions, and are as they were afterwards."""

import os
import signal
import threading

import pytest

from robocell._generation.signals import STOP_SIGNALS, interrupted_by_signals, stop_on_signals


@pytest.fixture(autouse=True)
def signals_are_not_ignored():
    """Under nohup SIGHUP is ignored, and what is ignored stays so."""
    before = {number: signal.getsignal(number) for number in STOP_SIGNALS}
    for number, handler in before.items():
        if handler is signal.SIG_IGN:
            signal.signal(number, signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(
    ("number", "name"),
    [(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM"), (signal.SIGHUP, "SIGHUP")],
)
def test_each_signal_requests_a_stop_by_name(number, name):
    before = [signal.getsignal(each) for each in STOP_SIGNALS]
    asked: list[str] = []
    with stop_on_signals(asked.append):
        os.kill(os.getpid(), number)
    assert asked == [name]
    assert [signal.getsignal(each) for each in STOP_SIGNALS] == before


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_closed_terminal_interrupts_as_ctrl_c_does(number):
    name = signal.Signals(number).name
    with pytest.raises(KeyboardInterrupt, match=name), interrupted_by_signals():
        os.kill(os.getpid(), number)


def test_a_signal_that_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    asked: list[str] = []
    try:
        with stop_on_signals(asked.append):
            os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)
    assert asked == []


def test_handlers_are_restored_after_an_exception():
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(ValueError, match="mine"), stop_on_signals(lambda name: None):
        raise ValueError("mine")
    assert signal.getsignal(signal.SIGTERM) is before


def test_other_threads_keep_the_handlers():
    before = signal.getsignal(signal.SIGTERM)
    seen: list[object] = []

    def work() -> None:
        with stop_on_signals(lambda name: None):
            seen.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]
