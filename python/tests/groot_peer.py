"""A server of GR00T's protocol, made of pyzmq and msgpack alone, without robocell's code."""

from __future__ import annotations

import contextlib
import io
import threading
from collections.abc import Callable, Iterator
from typing import Any

import msgpack
import numpy as np
import zmq


def packed(value: Any) -> bytes:
    def array(each: Any) -> Any:
        file = io.BytesIO()
        np.save(file, each, allow_pickle=False)
        return {"__ndarray_class__": True, "as_npy": file.getvalue()}

    return msgpack.packb(value, default=array)


def unpacked(data: bytes) -> Any:
    def array(each: dict[Any, Any]) -> Any:
        if "__ndarray_class__" in each:
            return np.load(io.BytesIO(each["as_npy"]), allow_pickle=False)
        return each

    return msgpack.unpackb(data, object_hook=array)


def modalities(
    video: list[str], state: list[str], action: list[str], times: int = 1
) -> dict[str, Any]:
    """What `get_modality_config` answers."""

    def config(keys: list[str], count: int) -> dict[str, Any]:
        fields = {"delta_indices": list(range(count)), "modality_keys": keys}
        return {"__ModalityConfig_class__": True, "as_json": fields}

    return {
        "video": config(video, times),
        "state": config(state, 1),
        "action": config(action, 16),
        "language": config(["annotation.human.task_description"], 1),
    }


@contextlib.contextmanager
def groot_server(
    act: Callable[[dict[str, Any]], Any], config: Any, token: str = "", requests: Any = None
) -> Iterator[str]:
    """A server on a free port. What `act` returns as bytes is sent as it is."""

    def answer(request: dict[str, Any]) -> Any:
        if token and request.get("api_token") != token:
            return {"error": "Unauthorized: Invalid API token"}
        if requests is not None:
            requests.append(request)
        endpoint = request["endpoint"]
        if endpoint == "get_modality_config":
            return config
        if endpoint == "reset":
            return {}
        try:
            return act(**{"observation": request["data"]["observation"]})
        except Exception as error:
            return {"error": str(error)}

    with zmq.Context() as context, context.socket(zmq.REP) as socket:
        socket.linger = 0
        port = socket.bind_to_random_port("tcp://127.0.0.1")
        ended = threading.Event()

        def serve() -> None:
            while not ended.is_set():
                if socket.poll(20):
                    reply = answer(unpacked(socket.recv()))
                    socket.send(reply if isinstance(reply, bytes) else packed(reply))

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield f"zmq://127.0.0.1:{port}"
        finally:
            ended.set()
            thread.join()
