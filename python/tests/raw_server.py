"""A server of raw bytes, for clients that no server may hold up."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def raw_server(talk: Callable[[socket.socket, int], None]) -> Iterator[str]:
    """A server that gives each connection, and its number, to `talk`."""
    listening = socket.create_server(("127.0.0.1", 0))
    ended = threading.Event()
    kept = []

    def accept() -> None:
        with contextlib.suppress(OSError):
            for number in range(100):
                connection, _ = listening.accept()
                kept.append(connection)

                def one(connection: socket.socket = connection, number: int = number) -> None:
                    with contextlib.suppress(OSError):
                        talk(connection, number)

                threading.Thread(target=one, daemon=True).start()

    threading.Thread(target=accept, daemon=True).start()
    yield f"ws://127.0.0.1:{listening.getsockname()[1]}"
    ended.set()
    listening.close()
    for connection in kept:
        connection.close()
