"""Turns Ctrl-C, SIGTERM and a closed terminal into stop requests or KeyboardInterrupt."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def stop_on_signals(request_stop: Callable[[str], None]) -> Iterator[None]:
    """Context manager: signals call `request_stop(name)`. Does nothing outside the main thread.

    Ignored signals stay ignored, for `nohup` and background jobs.
    """

    def stop(number: int, frame: FrameType | None) -> None:
        request_stop("Ctrl-C" if number == signal.SIGINT else signal.Signals(number).name)

    with _handled(STOP_SIGNALS, stop):
        yield


@contextmanager
def interrupted_by_signals() -> Iterator[None]:
    """Context manager: SIGTERM and SIGHUP raise KeyboardInterrupt, like Ctrl-C; see above."""

    def interrupt(number: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt(signal.Signals(number).name)

    with _handled((signal.SIGTERM, signal.SIGHUP), interrupt):
        yield


@contextmanager
def _handled(
    numbers: Sequence[signal.Signals], handle: Callable[[int, FrameType | None], None]
) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    obeyed = [number for number in numbers if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, handle) for number in obeyed}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
