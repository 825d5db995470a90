"""The worker's side: takes items from the supervisor, one at a time, and makes their episodes.

The main thread makes episodes; a listener thread hears the supervisor meanwhile, so that a stop
request reaches the runner while C++ is busy. Ctrl-C in the terminal is the supervisor's business
and ignored here. When the supervisor is gone, the worker ends.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Mapping
from queue import SimpleQueue
from typing import Any, Protocol

from robocell._own_code import RAISED
from robocell.generate.items import Item, ItemResult
from robocell.generate.protocol import Failure, LineReader, ProtocolError, encode

# After a stop request the worker ends itself by force when it has not ended by then.
STOP_GRACE_S = 20.0

MakeEpisode = Callable[[Item], ItemResult]


class Stop(Protocol):
    """What the runner polls: `robocell.generate.StopFlag`."""

    def set(self) -> None:
        """Asks the present episode to end."""


def serve(open_maker: Callable[[], MakeEpisode], stop: Stop) -> int:
    """Works until the supervisor has nothing more; the exit code of the process.

    `open_maker` loads the run and returns the function that makes episodes; `stop` is the flag that
    this function obeys. What either raises is told to the supervisor. Standard output belongs to
    the protocol: what libraries print goes to the log (standard error).
    """
    replies = _take_stdout()
    requests: SimpleQueue[Item | None] = SimpleQueue()
    listener = _Listener(requests, stop)
    try:
        return _work(open_maker, requests, replies)
    except BrokenPipeError:
        return 1
    finally:
        listener.close()


def _work(
    open_maker: Callable[[], MakeEpisode], requests: SimpleQueue[Item | None], replies: int
) -> int:
    try:
        make = open_maker()
    except RAISED as error:
        return _tell_failure(replies, "refused", error)
    _send(replies, {"ready": True})
    while (item := requests.get()) is not None:
        try:
            result = make(item)
        except RAISED as error:
            return _tell_failure(replies, "failed", error)
        _send(replies, {"done": result.to_json()})
    return 0


def _tell_failure(replies: int, verb: str, error: BaseException) -> int:
    with contextlib.suppress(OSError):  # the log may be on the very disk that is full
        traceback.print_exception(error)
    _send(
        replies, {verb: Failure.of(error, loading=verb == "refused").to_json()}
    )  # nobody may listen any more
    return 1


def _take_stdout() -> int:
    """A private copy of standard output, which from now on is standard error."""
    sys.stdout.flush()
    private = os.dup(1)  # not inherited by programs that it starts
    os.dup2(2, 1)
    to_close = [private]  # once: a child's child may have given the number to another file

    def close() -> None:
        while to_close:
            os.close(to_close.pop())

    # A process that a user's code forks would keep the pipe open, and hide the worker's death.
    os.register_at_fork(after_in_child=close)
    return private


def _send(fd: int, message: Mapping[str, Any]) -> None:
    line = encode(message)
    while line:
        line = line[os.write(fd, line) :]


class _Listener:
    """Hears the supervisor and SIGTERM: items go to `requests`, then None."""

    def __init__(self, requests: SimpleQueue[Item | None], stop: Stop) -> None:
        self._woken, self._waker = os.pipe()
        os.set_blocking(self._waker, False)
        signal.set_wakeup_fd(self._waker, warn_on_full_buffer=False)  # written even while C++ runs
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, lambda *_: None)
        arguments = (requests, stop, self._woken)
        self._thread = threading.Thread(target=_hear, args=arguments, name="listener", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the thread, so that nothing holds the stop flag when the interpreter ends."""
        os.write(self._waker, b"!")
        self._thread.join(1.0)


def _hear(requests: SimpleQueue[Item | None], stop: Stop, woken: int) -> None:
    """The listener's thread; from its end on the process has STOP_GRACE_S to end."""
    try:
        _receive(requests, woken)
    finally:
        stop.set()
        requests.put(None)
    deadline = threading.Timer(STOP_GRACE_S, os._exit, (1,))
    deadline.daemon = True
    deadline.start()


def _receive(requests: SimpleQueue[Item | None], woken: int) -> None:
    """Returns at a stop request, a signal, the end of input, or nonsense."""
    reader = LineReader()
    while True:
        if woken in select.select([0, woken], [], [])[0]:
            return
        data = os.read(0, 65536)
        if not data:
            return
        try:
            for message in reader.feed(data):
                if "do" not in message:
                    return
                requests.put(Item.from_json(message["do"]))
        except ProtocolError as error:
            print(error, file=sys.stderr)
            return
