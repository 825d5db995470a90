"""Debian's chromium without a window, driven through its DevTools protocol."""

from __future__ import annotations

import base64
import contextlib
import json
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from websockets.sync.client import ClientConnection, connect

ANSWER_S = 60.0
# Nothing leaves the machine, the browser's own requests included.
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1"
WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


class Tab:
    """A page of a browser, and what it has written to its console."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket, self._number, self._session = socket, 0, ""
        self.said: list[str] = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        found = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = found["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Calls a method of the protocol."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._socket.send(json.dumps(message))
        while True:
            answer = json.loads(self._socket.recv(ANSWER_S))
            if answer.get("id") == self._number:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]
            self._note(answer)

    def open(self, url: str) -> None:
        self.call("Page.navigate", url=url)

    def value(self, expression: str) -> Any:
        """Returns the value of an expression of JavaScript."""
        found = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def wait_for(self, expression: str, seconds: float = 60.0) -> Any:
        """Waits until an expression is true, and returns its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            with contextlib.suppress(AssertionError):  # scripts are not loaded yet
                if value := self.value(expression):
                    return value
            time.sleep(0.05)
        raise AssertionError(f"never true: {expression}; console: {self.said}")

    def resize(self, width: int, height: int) -> None:
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def screenshot(self, path: Path) -> np.ndarray:
        """Writes the page as a PNG, and returns its pixels (height, width, 3)."""
        data = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        path.write_bytes(data)
        with Image.open(path) as image:
            return np.asarray(image.convert("RGB"))

    def key(self, code: str, text: str = "", seconds: float = 0.0) -> None:
        """Presses a key, holds it, and lets it go."""
        self.call("Input.dispatchKeyEvent", type="keyDown", code=code, key=text or code)
        time.sleep(seconds)
        self.call("Input.dispatchKeyEvent", type="keyUp", code=code, key=text or code)

    def drag(self, x: float, y: float, dx: float, dy: float, steps: int = 8) -> None:
        """Drags with the left button."""
        mouse: dict[str, Any] = {"button": "left", "clickCount": 1}
        self.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, **mouse)
        for i in range(1, steps + 1):
            at = {"x": x + dx * i / steps, "y": y + dy * i / steps}
            self.call("Input.dispatchMouseEvent", type="mouseMoved", buttons=1, **at, **mouse)
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x + dx, y=y + dy, **mouse)

    def _note(self, event: dict[str, Any]) -> None:
        parameters = event.get("params", {})
        if event.get("method") == "Runtime.consoleAPICalled":
            if parameters["type"] in ("error", "warning", "assert"):
                self.said.append(json.dumps(parameters["args"]))
        elif event.get("method") == "Runtime.exceptionThrown":
            self.said.append(json.dumps(parameters["exceptionDetails"]))
        elif event.get("method") == "Log.entryAdded":
            entry = parameters["entry"]
            if entry["level"] in ("error", "warning") and "GPU stall" not in entry["text"]:
                self.said.append(entry["text"])


@contextlib.contextmanager
def browsing(folder: Path) -> Iterator[Tab]:
    """Starts a browser with its profile in a folder."""
    command = ["chromium", "--headless=new", "--no-sandbox", "--disable-background-networking"]
    command += [*WEBGL, OFFLINE, "--window-size=1280,800", "--remote-debugging-port=0"]
    command += [f"--user-data-dir={folder / 'profile'}", "about:blank"]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    )
    try:
        assert process.stderr is not None
        mark = "DevTools listening on "
        address = next(line.removeprefix(mark).strip() for line in process.stderr if mark in line)
        with connect(address, max_size=1 << 28, compression=None) as socket:
            yield Tab(socket)
    finally:
        process.terminate()
        process.wait(20)
