"""The server of pages: only its own page gets in, and no client can hold it up."""

from __future__ import annotations

import contextlib
import http.client
import json
import socket
import ssl
import threading
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from robocell import IoError
from robocell._channel import MisbehavedError
from robocell._web import web_server
from robocell._web.certificate import make_certificate
from robocell._web.web_server import Reply, WebServer, message_of, number_of, vector_of


class Echo:
    """A site that answers messages with themselves."""

    def __init__(self) -> None:
        self.open, self.ended = 0, threading.Event()

    def page(self, query: Mapping[str, str]) -> tuple[str, str] | None:
        return None if "none" in query else ("still", "<b>&\"'")

    def get(self, path: str, query: Mapping[str, str]) -> Reply | None:
        return Reply(b"x" * (8 << 20)) if path == "large" else None

    def visit(self) -> Echo:
        self.open += 1
        return self

    def answer(self, message: dict[str, Any]) -> str | None:
        return json.dumps(message) if message["op"] == "echo" else None

    def end(self) -> None:
        self.open -= 1
        self.ended.set()


@contextlib.contextmanager
def serving(site: Echo | None = None) -> Iterator[WebServer]:
    server = WebServer(site or Echo(), token="secret")
    server.start()
    yield server
    server.close()


def get(server: WebServer, path: str, **headers: str) -> tuple[int, bytes, dict[str, str]]:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=5)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    found = (answer.status, answer.read(), dict(answer.getheaders()))
    connection.close()
    return found


def visiting(server: WebServer, token: str = "secret", **options: Any) -> ClientConnection:
    options.setdefault("origin", f"http://127.0.0.1:{server.port}")
    return connect(f"ws://127.0.0.1:{server.port}/socket?token={token}", **options)


def test_a_page_with_the_token_gets_in():
    with serving() as server:
        assert server.url == f"http://127.0.0.1:{server.port}/?token=secret"
        status, page, headers = get(server, "/?token=secret")
        assert status == 200
        assert b"<title>&lt;b&gt;&amp;&quot;&#x27;</title>" in page
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert headers["Cache-Control"] == "no-store"
        with visiting(server) as page_socket:
            page_socket.send('{"op": "echo", "x": 1}')
            assert json.loads(page_socket.recv(5)) == {"op": "echo", "x": 1}
            page_socket.send('{"op": "quiet"}')
            page_socket.send('{"op": "echo"}')
            assert json.loads(page_socket.recv(5)) == {"op": "echo"}
        assert get(server, "/large?token=secret")[1] == b"x" * (8 << 20)
        assert get(server, "/page.js")[0] == 200
        assert get(server, "/nothing?token=secret")[0] == 404
        assert get(server, "/?token=secret&none=1")[0] == 404


@pytest.mark.parametrize("path", ["/?token=wrong", "/", "/large", "/large?token=", "/../page.css"])
def test_without_the_token_there_is_nothing(path: str):
    with serving() as server:
        status, text, _ = get(server, path)
        assert status == 401
        assert b"open the one that the command printed" in text


@pytest.mark.parametrize(
    "host", ["robocell.example:{port}", "127.0.0.1:1", "", "127.0.0.1", "127.0.0.1.evil.com:{port}"]
)
def test_names_of_other_sites_are_refused(host: str):
    with serving() as server:
        assert get(server, "/?token=secret", Host=host.format(port=server.port))[0] == 403


def test_names_of_this_server_are_those_of_browsers(monkeypatch: pytest.MonkeyPatch):
    """They write names in lower case, and leave the usual ports out."""
    monkeypatch.setattr(socket, "gethostname", lambda: "MyLaptop")
    server = WebServer(Echo(), host="0.0.0.0", token="secret")
    server.start()
    try:
        assert server.url.startswith("http://MyLaptop:")
        name = f"mylaptop:{server.port}"
        assert get(server, "/?token=secret", Host=name)[0] == 200
        plain = socket.create_connection(("127.0.0.1", server.port))
        url = f"ws://{name}/socket?token=secret"
        with connect(url, sock=plain, origin=f"http://{name}"):  # type: ignore[arg-type]
            pass
        assert not server._is_own("mylaptop")
        for tls, port, other in ((None, 80, 443), (object(), 443, 80)):
            server._tls = tls  # type: ignore[assignment]
            server.port = port
            for host in ("mylaptop", "LOCALHOST", "[::1]", "192.168.0.7"):
                assert server._is_own(host), host
                assert server._is_own(f"{host}:{port}"), host
                assert not server._is_own(f"{host}:{other}"), host
            assert not server._is_own("evil.com")
            assert not server._is_own("")
    finally:
        server.close()


@pytest.mark.parametrize(
    "path", [b"//[x", b"/?token=\xff", b"/?token=%ff%ed%a0%80", b"/?" + b"a=1&" * 900, b"/\xff"]
)
def test_a_strange_address_gets_an_answer(path: bytes, capfd: pytest.CaptureFixture[str]):
    with serving() as server:
        with socket.create_connection(("127.0.0.1", server.port), timeout=5) as plain:
            host = f"127.0.0.1:{server.port}".encode()
            plain.sendall(b"GET " + path + b" HTTP/1.1\r\nHost: " + host + b"\r\n\r\n")
            answer = plain.recv(1000)
        # What is not ASCII is no HTTP.
        assert answer[:12] in ((b"HTTP/1.1 401", b"HTTP/1.1 400") if path.isascii() else (b"",))
        assert get(server, "/?token=secret")[0] == 200
    assert capfd.readouterr().err == ""


def test_a_site_that_fails_answers_with_its_error(capfd: pytest.CaptureFixture[str]):
    class Breaks(Echo):
        def get(self, path: str, query: Mapping[str, str]) -> Reply | None:
            raise KeyError("no such column")

    with serving(Breaks()) as server:
        status, text, _ = get(server, "/large?token=secret")
    assert status == 500
    assert b"no such column" in text
    assert capfd.readouterr().err == ""


def test_a_page_that_says_nothing_leaves_its_place(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(web_server, "IDLE_S", 0.3)
    site = Echo()
    with serving(site) as server, visiting(server, ping_interval=None):
        assert site.ended.wait(5)


def test_a_slow_reader_of_https_has_one_deadline(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Not one for each of the records in which TLS sends."""
    monkeypatch.setattr(web_server, "RESPONSE_S", 0.5)
    server = WebServer(Echo(), token="secret", certificate=make_certificate(tmp_path, "127.0.0.1"))
    server.start()
    trust = ssl.create_default_context(cafile=tmp_path / "certificate.pem")
    try:
        with trust.wrap_socket(
            socket.create_connection(("127.0.0.1", server.port)), server_hostname="127.0.0.1"
        ) as page:
            host = f"127.0.0.1:{server.port}"
            page.sendall(f"GET /large?token=secret HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
            began = time.monotonic()
            with contextlib.suppress(OSError):
                while server._channels or time.monotonic() < began + 0.2:
                    page.recv(16384)
                    time.sleep(0.02)  # a record takes a 25th of the deadline, all of them 10 s
            assert time.monotonic() - began < 5
    finally:
        server.close()


def test_a_server_without_threads_goes_on(monkeypatch: pytest.MonkeyPatch):
    with serving() as server:

        def none(_thread: threading.Thread) -> None:
            raise RuntimeError("can't start new thread")

        with monkeypatch.context() as full:
            full.setattr(threading.Thread, "start", none)
            with pytest.raises((http.client.HTTPException, ConnectionError)):
                get(server, "/page.css")
        assert get(server, "/page.css")[0] == 200


@pytest.mark.parametrize("origin", [None, "null", "http://evil.com", "https://127.0.0.1:{port}"])
def test_pages_of_other_sites_may_not_connect(origin: str | None):
    with serving() as server:
        origin = origin and origin.format(port=server.port)
        with pytest.raises(InvalidStatus) as refused:
            visiting(server, origin=origin)
        assert refused.value.response.status_code == 403
        with pytest.raises(InvalidStatus) as refused:
            visiting(server, token="wrong")
        assert refused.value.response.status_code == 401


@pytest.mark.parametrize(
    "message",
    [
        b"\x00\x01",
        "",
        "{",
        "[]",
        "{}",
        '{"op": 1}',
        '{"op": "echo", "x": NaN}',
        '{"op": "echo", "x": 1e999}',
        '{"op": "echo", "x": 99999999999999999999}',
        '{"op": "echo", "x": ' + "[" * 20 + "]" * 20 + "}",
        "[" * 30000,
        '{"op": "echo", "x": "' + "x" * (1 << 17) + '"}',
    ],
)
def test_garbage_ends_its_own_connection_alone(message: str | bytes):
    site = Echo()
    with serving(site) as server, visiting(server) as good:
        with visiting(server) as bad:
            with contextlib.suppress(ConnectionClosed):  # while it is still being sent
                bad.send(message)
            with pytest.raises(ConnectionClosed):
                bad.recv(5)
            assert site.ended.wait(5)
        good.send('{"op": "echo"}')
        assert json.loads(good.recv(5)) == {"op": "echo"}
        assert site.open == 1


@given(st.recursive(st.none() | st.floats() | st.integers() | st.text(), st.lists))
@settings(max_examples=50)
def test_no_value_of_a_message_raises_anything_else(value: object):
    text = json.dumps({"op": "x", "value": value})
    for read in (
        lambda message: number_of(message, "value"),
        lambda message: vector_of(message, "value", 3),
    ):
        with contextlib.suppress(MisbehavedError):
            read(message_of(text))


def test_no_client_keeps_others_out(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(web_server, "MOST_CLIENTS", 3)
    with serving() as server, contextlib.ExitStack() as silent:
        for _ in range(2):  # they say nothing
            silent.enter_context(socket.create_connection(("127.0.0.1", server.port)))
        noisy = silent.enter_context(socket.create_connection(("127.0.0.1", server.port)))
        noisy.sendall(b"\x16\x03\x01\x02\x00garbage\r\n\r\n")  # as a client of https begins
        deadline = time.monotonic() + 10
        page = None
        while page is None:  # until the noisy one is gone
            assert time.monotonic() < deadline
            with contextlib.suppress(InvalidStatus):
                page = silent.enter_context(visiting(server))
        assert get(server, "/page.css")[0] == 503


def test_it_listens_on_this_machine_alone_and_names_a_taken_port():
    with serving() as server:
        assert server.host == "127.0.0.1"
        with pytest.raises(IoError, match="Choose another --port"):
            WebServer(Echo(), port=server.port)
    server.close()


def test_a_closed_server_ends_its_pages():
    site = Echo()
    with serving(site) as server, visiting(server) as page:
        server.close()
        assert site.ended.wait(5)
        with pytest.raises(ConnectionClosed):
            page.recv(5)


def test_https_with_a_certificate_of_its_own(tmp_path: Path):
    certificate = make_certificate(tmp_path, "127.0.0.1")
    server = WebServer(Echo(), token="secret", certificate=certificate)
    server.start()
    try:
        assert server.url.startswith("https://127.0.0.1:")
        trust = ssl.create_default_context(cafile=certificate[0])
        connection = http.client.HTTPSConnection("127.0.0.1", server.port, context=trust, timeout=5)
        connection.request("GET", "/?token=secret")
        assert connection.getresponse().status == 200
        with socket.create_connection(("127.0.0.1", server.port)) as plain:
            plain.sendall(b"GET / HTTP/1.1\r\n\r\n")
            assert b"200 OK" not in plain.recv(1000)
        origin = f"https://127.0.0.1:{server.port}"
        url = f"wss://127.0.0.1:{server.port}/socket?token=secret"
        with connect(url, ssl=trust, origin=origin) as page:  # type: ignore[arg-type]
            page.send('{"op": "echo"}')
            assert page.recv(5) == '{"op": "echo"}'
        with pytest.raises(IoError, match="certificate"):
            WebServer(Echo(), certificate=(certificate[1], certificate[0]))
    finally:
        server.close()
    assert certificate[1].stat().st_mode & 0o077 == 0
