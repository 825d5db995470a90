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

from robocell._generation.items import Item, ItemRecord
from robocell._generation.own_process import take_stream, write_all
from robocell._generation.protocol import Failure, LineReader, ProtocolError, encode
from robocell._generation.stacks import write_on_request
from robocell._own_code import RAISED, raise_interrupt

# After a stop request the worker ends itself by force when it has not ended by then.
STOP_GRACE_S = 20.0

MakeEpisode = Callable[[Item], ItemRecord]


class Stop(Protocol):
    """Stop request that the runner polls: `robocell.generate.StopFlag`."""

    def set(self) -> None:
        """Asks the present episode to end."""


def serve(open_maker: Callable[[], MakeEpisode], stop: Stop) -> int:
    """Works until the supervisor has no more items. Returns the exit code of the process.

    `open_maker` loads the run and returns the function that makes episodes; `stop` is the flag that
    this function obeys. Exceptions of either are sent to the supervisor. Standard input and output
    belong to the protocol: output of libraries goes to the log (standard error), and their input is
    empty.
    """
    write_on_request()
    sys.stdout.flush()
    replies, supervisor = take_stream(1, instead=2), take_stream(0)
    requests: SimpleQueue[Item | None] = SimpleQueue()
    listener = _Listener(supervisor, requests, stop)
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
        raise_interrupt(error)
        return _send_failure(replies, "refused", error)
    _send(replies, {"ready": True})
    while (item := requests.get()) is not None:
        try:
            result = make(item)
        except RAISED as error:
            raise_interrupt(error)
            return _send_failure(replies, "failed", error)
        _send(replies, {"done": result.to_json()})
    return 0


def _send_failure(replies: int, verb: str, error: BaseException) -> int:
    with contextlib.suppress(OSError):  # the log may be on the very disk that is full
        traceback.print_exception(error)
    _send(
        replies, {verb: Failure.of(error, loading=verb == "refused").to_json()}
    )  # nobody may listen any more
    return 1


def _send(fd: int, message: Mapping[str, Any]) -> None:
    write_all(fd, encode(message))


class _Listener:
    """Hears the supervisor and SIGTERM: items go to `requests`, then None."""

    def __init__(self, supervisor: int, requests: SimpleQueue[Item | None], stop: Stop) -> None:
        self._woken, self._waker = os.pipe()
        os.set_blocking(self._waker, False)
        signal.set_wakeup_fd(self._waker, warn_on_full_buffer=False)  # written even while C++ runs
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, lambda *_: None)
        arguments = (supervisor, requests, stop, self._woken)
        self._thread = threading.Thread(target=_hear, args=arguments, name="listener", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the thread, so that nothing holds the stop flag when the interpreter ends."""
        os.write(self._waker, b"!")
        self._thread.join(1.0)


def _hear(supervisor: int, requests: SimpleQueue[Item | None], stop: Stop, woken: int) -> None:
    """Runs the listener's thread; after its end the process has STOP_GRACE_S to end."""
    try:
        _receive(supervisor, requests, woken)
    finally:
        stop.set()
        requests.put(None)
    deadline = threading.Timer(STOP_GRACE_S, os._exit, (1,))
    deadline.daemon = True
    deadline.start()


def _receive(supervisor: int, requests: SimpleQueue[Item | None], woken: int) -> None:
    """Returns at a stop request, a signal, the end of input, or nonsense."""
    reader = LineReader()
    while True:
        if woken in select.select([supervisor, woken], [], [])[0]:
            return
        data = os.read(supervisor, 65536)
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
