"""WebSocket connections whose every operation ends in time and in a bounded amount of memory.

The protocol is that of the package websockets, without its threads and event loop: a send and a
receive here have a deadline for the whole message, however slowly the other end reads or writes.
"""

from __future__ import annotations

import contextlib
import math
import socket
import threading
import time

from robocell._core import ArgumentError, Error, IoError
from robocell._extras import needed_by

with needed_by("a WebSocket", "web"):
    from websockets.exceptions import PayloadTooBig
    from websockets.frames import CloseCode, Frame, Opcode
    from websockets.http11 import Request, Response
    from websockets.protocol import Event, Protocol, State
    from websockets.server import ServerProtocol

CHUNK = 1 << 18  # bytes per read
ANSWER_S = 5.0  # for an answer to a ping to be read


class DroppedError(Error):
    """The other end closed the connection, or it broke."""


class MisbehavedError(Error):
    """The other end sent what is no WebSocket message, or one that is too large."""


class Deadline:
    """A moment by which something must be done.

    Args:
        seconds: Time from now; infinite for no deadline.
        what: What must be done, for the message.
    """

    def __init__(self, seconds: float, what: str) -> None:
        self.seconds, self.what = seconds, what
        self._end = time.monotonic() + seconds

    def left(self) -> float | None:
        """Returns the seconds that are left; None for no deadline. Raises TimeoutError if none."""
        if math.isinf(self._end):
            return None
        left = self._end - time.monotonic()
        if left <= 0:
            raise self.error()
        return left

    def is_before(self, other: Deadline) -> bool:
        """Whether this moment comes before that of another deadline."""
        return self._end < other._end

    def error(self) -> TimeoutError:
        """Returns the error of a missed deadline."""
        return TimeoutError(f"no {self.what} within {self.seconds:g} s")


class Channel:
    """One end of a connection, for one thread.

    Args:
        sock: A connected socket, which the channel closes.
        protocol: The protocol's state; its `max_size` limits a message.
    """

    def __init__(self, sock: socket.socket, protocol: Protocol) -> None:
        self._socket, self._protocol = sock, protocol
        self._waiting: list[Event] = []
        self._ended: DroppedError | MisbehavedError | None = None
        self._buffer = memoryview(bytearray(CHUNK))
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)

    def send(self, message: bytes | str, deadline: Deadline) -> None:
        """Sends bytes as a binary message, a text as a text message.

        Raises:
            DroppedError: The connection is gone.
            TimeoutError: The other end does not read fast enough.
        """
        if self._protocol.state is not State.OPEN:
            raise DroppedError("the connection is closed")
        if isinstance(message, str):
            self._protocol.send_text(message.encode())
        else:
            self._protocol.send_binary(message)
        self.flush(deadline)

    def receive(
        self, deadline: Deadline, idle: bool = False, idle_s: float = math.inf
    ) -> bytes | str:
        """Returns the next message; control frames are answered on the way.

        Args:
            deadline: When the message must be complete.
            idle: Wait for the message's first byte for `idle_s`; then `deadline.seconds` are left.
            idle_s: The time for which the other end may say nothing, s.

        Raises:
            DroppedError: The connection is gone.
            MisbehavedError: The message is too large, or is none.
            TimeoutError: The message was not complete in time.
        """
        silence = Deadline(idle_s, "sign of life")
        began: Deadline | None = None if idle else deadline
        whole, is_text = bytearray(), False
        while True:
            while self._waiting:
                frame = self._waiting.pop(0)
                if not isinstance(frame, Frame):
                    continue
                if frame.opcode in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
                    is_text = is_text or frame.opcode is Opcode.TEXT
                    if frame.fin and not whole:
                        return _decoded(bytes(frame.data), is_text)
                    whole += frame.data
                    if frame.fin:
                        return _decoded(bytes(whole), is_text)
                    began = began or Deadline(deadline.seconds, deadline.what)
            if not self._feed(began or silence) and began is None:
                began = Deadline(deadline.seconds, deadline.what)

    def handshake(self, deadline: Deadline) -> Request | Response:
        """Returns the HTTP request, or the response, that begins the connection."""
        while not self._waiting:
            self._feed(deadline)
        first = self._waiting.pop(0)
        if not isinstance(first, Request | Response):
            raise MisbehavedError("the other end does not speak WebSocket")
        return first

    def flush(self, deadline: Deadline) -> None:
        """Sends what the protocol has to send."""
        try:
            for data in self._protocol.data_to_send():
                if data:
                    self._send_all(data, deadline)
                else:
                    self._socket.shutdown(socket.SHUT_WR)
        except TimeoutError as error:
            self.abort()
            raise deadline.error() from error
        except OSError as error:
            self.abort()
            raise DroppedError(f"the connection broke: {error.strerror or error}") from error

    def _send_all(self, data: bytes, deadline: Deadline) -> None:
        """Sends by the deadline. `sendall` of TLS takes its timeout for each record anew."""
        left = memoryview(data)
        while left:
            self._socket.settimeout(deadline.left())
            left = left[self._socket.send(left[:CHUNK]) :]

    def close(self, code: int = CloseCode.NORMAL_CLOSURE, reason: str = "") -> None:
        """Says goodbye if that does not take long, and closes the socket."""
        with contextlib.suppress(Exception):
            if self._protocol.state is State.OPEN:
                self._protocol.send_close(code, reason[:120])
                self.flush(Deadline(0.5, "goodbye"))
        self.abort()

    def abort(self) -> None:
        """Closes the socket at once; also from another thread."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        with contextlib.suppress(OSError):
            self._socket.close()

    def _feed(self, deadline: Deadline | None) -> bool:
        """Reads once. Returns False if the read bytes completed no frame."""
        if self._ended is not None:
            raise self._ended
        try:
            self._socket.settimeout(deadline.left() if deadline else None)
            data = bytes(self._buffer[: self._socket.recv_into(self._buffer)])
        except TimeoutError as error:
            self.abort()
            raise (deadline.error() if deadline else error) from error
        except (OSError, ValueError) as error:  # a ValueError of a socket that was closed here
            self.abort()
            raise DroppedError(f"the connection broke: {error}") from error
        if data:
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        events = self._protocol.events_received()
        self._waiting += events
        self._ended = self._end()
        if self._ended is None:
            patience = Deadline(ANSWER_S, "reader")
            self.flush(deadline if deadline and deadline.is_before(patience) else patience)
        else:  # what came before the end is still read
            with contextlib.suppress(DroppedError, TimeoutError):
                self.flush(Deadline(0.5, "reader"))
            self.abort()
        return bool(events)

    def _end(self) -> DroppedError | MisbehavedError | None:
        """Returns why the connection has ended; None if it is open."""
        error = self._protocol.parser_exc or self._protocol.handshake_exc
        close = self._protocol.close_rcvd
        if isinstance(error, PayloadTooBig):
            return MisbehavedError(f"a message is too large: {error}")
        if error is not None and not isinstance(error, EOFError):
            return MisbehavedError(f"the other end does not speak WebSocket: {error}")
        if error is None and close is None:
            return None
        return DroppedError(f"the other end closed the connection{_reason(close)}")


def _decoded(data: bytes, is_text: bool) -> bytes | str:
    return data.decode("utf-8", "replace") if is_text else data


def _reason(close: object) -> str:
    code, reason = getattr(close, "code", None), getattr(close, "reason", "")
    return f" (code {code}{f': {reason}' if reason else ''})" if code else ""


class ChannelServer:
    """Listens from its construction on, and gives each connection a thread.

    Subclasses define `protocol` and `serve_client`. More than `most_clients` connections are marked
    as one too many, and more than twice as many are closed at once, also those that say nothing.

    Args:
        host: Address to listen at.
        port: 0 for a free one; see `port`.
        most_clients: Connections at one time.
        thread: Name of the threads.

    Attributes:
        host: The address.
        port: The port.

    Raises:
        ArgumentError: There is no such port.
        IoError: The address or the port cannot be used.
    """

    def __init__(self, host: str, port: int, most_clients: int, thread: str) -> None:
        if not 0 <= port < 65536:
            raise ArgumentError(f"port must be from 0 to 65535, got {port}")
        self._most_clients, self._thread = most_clients, thread
        self._channels: set[Channel] = set()
        self._lock = threading.Lock()
        self._closed = False
        self._socket = _listening(host, port, most_clients)
        self.host, self.port = self._socket.getsockname()[:2]

    def protocol(self) -> ServerProtocol:
        """Returns the state of a new connection."""
        raise NotImplementedError

    def serve_client(
        self, channel: Channel, protocol: ServerProtocol, is_one_too_many: bool
    ) -> None:
        """Talks to a client until it or this server has enough; runs in the client's thread."""
        raise NotImplementedError

    def serve(self) -> None:
        """Answers clients until `close` is called from another thread or a signal handler."""
        while not self._closed:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                if self._closed:
                    return
                time.sleep(0.05)  # out of file descriptors, for example
                continue
            self._begin(connection)

    def close(self) -> None:
        """Stops listening and ends all connections."""
        self._closed = True
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        with self._lock:
            channels = list(self._channels)
        for channel in channels:
            channel.abort()

    @property
    def netloc(self) -> str:
        """Address and port as URLs write them."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{host}:{self.port}"

    def wrapped(self, connection: socket.socket) -> socket.socket:
        """Returns the socket to talk on: a subclass may encrypt it. Does not block."""
        return connection

    def _begin(self, connection: socket.socket) -> None:
        """Starts the thread of a connection."""
        protocol = self.protocol()
        try:
            channel = Channel(self.wrapped(connection), protocol)
        except OSError:
            connection.close()
            return
        with self._lock:
            others = len(self._channels)
            if others < 2 * self._most_clients:
                self._channels.add(channel)
        if others >= 2 * self._most_clients:  # also of those that say nothing
            channel.abort()
            return
        thread = threading.Thread(
            target=self._talk,
            args=(channel, protocol, others >= self._most_clients),
            name=self._thread,
            daemon=True,
        )
        try:
            thread.start()
        except RuntimeError:  # the system has no more threads now; others are still answered
            channel.abort()
            with self._lock:
                self._channels.discard(channel)

    def _talk(self, channel: Channel, protocol: ServerProtocol, is_one_too_many: bool) -> None:
        try:
            self.serve_client(channel, protocol, is_one_too_many)
        except (DroppedError, MisbehavedError, TimeoutError):
            pass  # the client's end of the connection
        finally:
            channel.close()
            with self._lock:
                self._channels.discard(channel)


def _listening(host: str, port: int, waiting: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind, protocol)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen(waiting)
    except OSError as error:
        raise IoError(
            f"cannot listen at {host}:{port}: {error.strerror or error}. Choose another --port, or "
            "0 for a free one"
        ) from error
    return listening
