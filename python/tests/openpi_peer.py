"""A client and a server of the openpi protocol, made of msgpack and websockets alone.

They are written from the protocol's description, without robocell's code: what both sides of
`robocell.policy_server` must get along with.
"""

from __future__ import annotations

import contextlib
import dataclasses
import threading
from collections.abc import Callable, Iterator
from typing import Any

import msgpack
import numpy as np
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.sync.server import ServerConnection, serve


def packed(value: Any) -> bytes:
    def array(each: Any) -> Any:
        if isinstance(each, np.ndarray):
            return {
                b"__ndarray__": True,
                b"data": each.tobytes(),
                b"dtype": each.dtype.str,
                b"shape": each.shape,
            }
        return {b"__npgeneric__": True, b"data": each.item(), b"dtype": each.dtype.str}

    return msgpack.packb(value, default=array)


def unpacked(data: bytes) -> Any:
    def array(each: dict[Any, Any]) -> Any:
        if b"__ndarray__" in each:
            return np.ndarray(
                buffer=each[b"data"], dtype=np.dtype(each[b"dtype"]), shape=each[b"shape"]
            )
        if b"__npgeneric__" in each:
            return np.dtype(each[b"dtype"]).type(each[b"data"])
        return each

    return msgpack.unpackb(data, object_hook=array)


class OpenpiClient:
    def __init__(self, url: str, api_key: str | None = None) -> None:
        headers = {"Authorization": f"Api-Key {api_key}"} if api_key else None
        self._opened = contextlib.ExitStack()
        self.socket = self._opened.enter_context(
            connect(url, compression=None, max_size=None, additional_headers=headers)
        )
        self.metadata = unpacked(self.socket.recv())

    def infer(self, observation: dict[str, Any]) -> Any:
        self.socket.send(packed(observation))
        answer = self.socket.recv()
        if isinstance(answer, str):
            raise RuntimeError(f"Error in inference server:\n{answer}")
        return unpacked(answer)


@dataclasses.dataclass
class RoboArenaConfig:
    image_resolution: tuple[int, int] | None = (96, 128)
    needs_wrist_camera: bool = True
    n_external_cameras: int = 1
    needs_stereo_camera: bool = False
    needs_session_id: bool = True
    action_space: str = "joint_position"


@contextlib.contextmanager
def openpi_server(
    infer: Callable[[dict[str, Any]], Any],
    metadata: Any = None,
    reset: Callable[[dict[str, Any]], None] | None = None,
    requests: list[Any] | None = None,
) -> Iterator[str]:
    """A server on a free port.

    What `infer` returns as a text is sent as an error; at `...` the connection ends without a word.

    With `reset` it is a server of RoboArena: observations have an `endpoint`.
    """

    def talk(connection: ServerConnection) -> None:
        if requests is not None:
            requests.append(connection.request)
        connection.send(packed(metadata if metadata is not None else {}))
        with contextlib.suppress(ConnectionClosed):
            while True:
                observation = unpacked(connection.recv())
                if reset is not None and observation.pop("endpoint") == "reset":
                    reset(observation)
                    connection.send("reset successful")
                    continue
                answer = infer(observation)
                if answer is ...:
                    return
                if isinstance(answer, str):
                    connection.send(answer)
                    connection.close(1011, "Internal server error.")
                    return
                connection.send(answer if isinstance(answer, bytes) else packed(answer))

    with serve(talk, "127.0.0.1", 0, compression=None, max_size=None) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join()
