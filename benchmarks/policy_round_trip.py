"""P18: a round trip to a policy server on this machine, beside openpi's way to make it.

The server is a process of its own and returns the same chunk each time. The peer is the client and
the server of the package websockets with msgpack, as openpi uses them: no limits, no deadlines.
"""

from __future__ import annotations

import contextlib
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray

from table import Row

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))

from robocell.policy_server import PolicyClient, PolicyServer  # noqa: E402

REPETITIONS = 7
CALLS = 300  # of each side in a repetition
CHUNK = np.linspace(-1, 1, 80, dtype=np.float32).reshape(10, 8)
STATE: dict[str, Any] = {
    "observation/joint_position": np.zeros(7, np.float32),
    "observation/gripper_position": np.zeros(1, np.float32),
    "prompt": "pick up the cube",
}
IMAGES: dict[str, Any] = {
    name: np.arange(224 * 224 * 3, dtype=np.uint8).reshape(224, 224, 3)
    for name in ("observation/exterior_image_1_left", "observation/wrist_image_left")
}
MESSAGES = {"state only": STATE, "state and two 224x224 images": STATE | IMAGES}
Infer = Callable[[Mapping[str, Any]], NDArray[Any]]


def rows(folder: Path, repetitions: int = REPETITIONS, calls: int = CALLS) -> list[Row]:
    """Milliseconds of a round trip, the median of each repetition's calls."""
    found = []
    with ours() as our_infer, peer() as peer_infer:
        for what, message in MESSAGES.items():
            times: tuple[list[float], list[float]] = ([], [])
            for repetition in range(repetitions):
                sides = list(zip((our_infer, peer_infer), times, strict=True))
                for infer, values in sides if repetition % 2 == 0 else reversed(sides):
                    values.append(median_ms(infer, message, calls))
            note = (
                "peer: openpi's way, websockets and msgpack; two processes, a chunk of 10 actions"
            )
            name = f"policy round trip, {what}, rc7"
            found.append(Row(name, "ms", times[0], times[1], note=note))
    return found


def median_ms(infer: Infer, message: Mapping[str, Any], calls: int) -> float:
    """The median time of a call; every answer is checked."""
    times = []
    for _ in range(calls):
        began = time.perf_counter()
        actions = infer(message)
        times.append(1e3 * (time.perf_counter() - began))
        if not np.array_equal(actions, CHUNK):
            raise RuntimeError("the server returned other actions")
    return statistics.median(times)


@contextlib.contextmanager
def server(kind: str) -> Iterator[str]:
    """The URL of a server in a process of its own."""
    command = [sys.executable, __file__, kind]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process.stdout.readline().strip()
        finally:
            process.kill()


@contextlib.contextmanager
def ours() -> Iterator[Infer]:
    """A call of our server by our client."""
    with server("ours") as url, PolicyClient(url) as client:
        yield lambda message: client.infer(message).actions


@contextlib.contextmanager
def peer() -> Iterator[Infer]:
    """A call of the peer's server by the peer's client."""
    from websockets.sync.client import connect

    with (
        server("peer") as url,
        connect(url, compression=None, max_size=None, proxy=None) as connection,
    ):
        connection.recv()

        def infer(message: Mapping[str, Any]) -> NDArray[Any]:
            connection.send(packed(message))
            actions: NDArray[Any] = unpacked(connection.recv())["actions"]
            return actions

        yield infer


class Constant:
    """A session that needs no time."""

    def reset(self, info: Mapping[str, Any]) -> None:
        """Nothing."""

    def infer(self, observation: dict[str, Any]) -> dict[str, Any]:
        """The same chunk each time."""
        return {"actions": CHUNK}


def serve_ours() -> None:
    """Serves until it is killed."""
    made = PolicyServer(Constant, port=0, api_key="")
    print(made.url, flush=True)
    made.serve()


def serve_peer() -> None:
    """Serves until it is killed, as openpi does."""
    from websockets.sync.server import ServerConnection, serve

    def talk(connection: ServerConnection) -> None:
        connection.send(packed({}))
        for data in connection:
            unpacked(data)
            connection.send(packed({"actions": CHUNK, "server_timing": {"infer_ms": 0.0}}))

    with serve(talk, "127.0.0.1", 0, compression=None, max_size=None) as made:
        print(f"ws://127.0.0.1:{made.socket.getsockname()[1]}", flush=True)
        made.serve_forever()


def packed(message: Mapping[str, Any]) -> bytes:
    """A message as openpi's msgpack_numpy writes it."""

    def array(value: NDArray[Any]) -> dict[bytes, Any]:
        return {
            b"__ndarray__": True,
            b"data": value.tobytes(),
            b"dtype": value.dtype.str,
            b"shape": value.shape,
        }

    data: bytes = msgpack.packb(message, default=array)
    return data


def unpacked(data: bytes | str) -> Any:
    """A message as openpi's msgpack_numpy reads it."""

    def array(value: dict[Any, Any]) -> Any:
        if b"__ndarray__" not in value:
            return value
        dtype = np.dtype(value[b"dtype"])
        return np.ndarray(buffer=value[b"data"], dtype=dtype, shape=value[b"shape"])

    return msgpack.unpackb(data, object_hook=array)


if __name__ == "__main__":
    {"ours": serve_ours, "peer": serve_peer}[sys.argv[1]]()
