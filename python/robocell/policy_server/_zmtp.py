"""A request socket of ZeroMQ whose every operation ends in time and in a bounded amount of memory.

It speaks ZMTP 3.0 with the mechanism NULL over TCP: a greeting, one READY command of each end, then
requests and replies, each an empty frame and a frame with the message. libzmq would collect a
message of endless frames; here every frame counts against the deadline and the largest size.
"""

from __future__ import annotations

import contextlib
import socket
import struct

from robocell._channel import CHUNK, Deadline, DroppedError, MisbehavedError

SIGNATURE = b"\xff\x00\x00\x00\x00\x00\x00\x00\x00\x7f"
NULL = b"NULL".ljust(20, b"\0")
GREETING = SIGNATURE + b"\x03\x00" + NULL + b"\0" * 32
MORE, LONG, COMMAND = 1, 2, 4  # flags of a frame
MOST_COMMAND = 1 << 12
MOST_FRAMES = 16  # of a reply, commands included


class RequestSocket:
    """The requesting end of a connection, for one thread.

    Args:
        sock: A connected socket, which this object closes.
        most_bytes: Largest reply.
        deadline: When the greeting must be done.

    Raises:
        DroppedError: The other end closed the connection.
        MisbehavedError: The other end is no reply socket of ZeroMQ.
        TimeoutError: The greeting was not complete in time.
    """

    def __init__(self, sock: socket.socket, most_bytes: int, deadline: Deadline) -> None:
        self._socket, self._most_bytes = sock, most_bytes
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._send(GREETING, deadline)
        greeting = self._receive(len(GREETING), deadline)
        if greeting[:1] != SIGNATURE[:1] or greeting[9:10] != SIGNATURE[9:] or greeting[10] < 3:
            raise MisbehavedError("the other end does not speak ZeroMQ 3 or later")
        if greeting[12:32] != NULL:
            mechanism = greeting[12:32].rstrip(b"\0").decode("ascii", "replace")
            raise MisbehavedError(f"the other end wants the security mechanism {mechanism!r}")
        ready = b"\x05READY" + _property(b"Socket-Type", b"REQ") + _property(b"Identity", b"")
        self._send(bytes([COMMAND, len(ready)]) + ready, deadline)
        flags, body = self._frame(MOST_COMMAND, deadline)
        if not flags & COMMAND or not body.startswith(b"\x05READY"):
            raise MisbehavedError("the other end does not answer the greeting of ZeroMQ")
        if _property(b"Socket-Type", b"REP") not in body and (
            _property(b"Socket-Type", b"ROUTER") not in body
        ):
            raise MisbehavedError("the other end is no reply socket of ZeroMQ")

    def request(self, message: bytes, deadline: Deadline) -> bytes:
        """Sends a message and returns the reply.

        Raises:
            DroppedError: The connection is gone.
            MisbehavedError: The reply is too large, or is none.
            TimeoutError: The reply was not complete in time.
        """
        size = len(message)
        head = bytes([0, size]) if size < 256 else bytes([LONG]) + struct.pack(">Q", size)
        self._send(bytes([MORE, 0]) + head, deadline)
        self._send(message, deadline)
        frames: list[bytes] = []
        left = self._most_bytes
        for _ in range(MOST_FRAMES):
            flags, body = self._frame(left, deadline)
            if flags & COMMAND:
                continue
            frames.append(body)
            left -= len(body)
            if not flags & MORE:
                break
        if len(frames) != 2 or frames[0]:
            raise MisbehavedError("the reply is not an empty frame and one with a message")
        return frames[1]

    def close(self) -> None:
        """Closes the connection."""
        with contextlib.suppress(OSError):
            self._socket.close()

    def _frame(self, most_bytes: int, deadline: Deadline) -> tuple[int, bytes]:
        """Returns the flags and the body of the next frame."""
        [flags] = self._receive(1, deadline)
        if flags > 7:
            raise MisbehavedError("the other end does not speak ZeroMQ")
        if flags & LONG:
            [size] = struct.unpack(">Q", self._receive(8, deadline))
        else:
            [size] = self._receive(1, deadline)
        if size > most_bytes:
            raise MisbehavedError(f"a message is too large: {size} bytes, at most {most_bytes}")
        return flags, self._receive(size, deadline)

    def _send(self, data: bytes, deadline: Deadline) -> None:
        try:
            self._socket.settimeout(deadline.left())
            self._socket.sendall(data)
        except TimeoutError as error:
            raise deadline.error() from error
        except OSError as error:
            raise DroppedError(f"the connection broke: {error.strerror or error}") from error

    def _receive(self, size: int, deadline: Deadline) -> bytes:
        data = bytearray()
        while len(data) < size:
            try:
                self._socket.settimeout(deadline.left())
                more = self._socket.recv(min(CHUNK, size - len(data)))
            except TimeoutError as error:
                raise deadline.error() from error
            except OSError as error:
                raise DroppedError(f"the connection broke: {error.strerror or error}") from error
            if not more:
                raise DroppedError("the other end closed the connection")
            data += more
        return bytes(data)


def _property(name: bytes, value: bytes) -> bytes:
    return bytes([len(name)]) + name + struct.pack(">I", len(value)) + value
