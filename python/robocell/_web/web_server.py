"""Serves a page with its data and its WebSocket, to browsers that have the address with the token.

    server = WebServer(site)
    print(server.url)       # http://127.0.0.1:40123/?token=...
    server.start()          # answers in threads of its own
    ...
    server.close()

Only this machine reaches it unless another host is asked for. A page of another site cannot use it:
the token is compared in constant time, and the headers Host and Origin must be those of the
server. A client that sends garbage, reads slowly or disappears ends its own connection alone.
"""

from __future__ import annotations

import contextlib
import hmac
import http
import ipaddress
import json
import math
import secrets
import socket
import ssl
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import parse_qs

from robocell._channel import Channel, ChannelServer, Deadline, MisbehavedError
from robocell._core import Error, IoError
from robocell._extras import needed_by
from robocell._raised import place_of
from robocell._web.page_files import FILES, index_page, page_file

with needed_by("robocell view --web", "web"):
    from websockets.datastructures import Headers
    from websockets.frames import CloseCode
    from websockets.http11 import Request, Response
    from websockets.server import ServerProtocol

HOST = "127.0.0.1"
LOOPBACK_NAMES = ("127.0.0.1", "localhost", "[::1]")
MOST_CLIENTS = 32
MOST_BYTES = 1 << 16  # of a message from a page
MOST_LEVELS = 8  # of lists and maps in it
MOST_FIELDS = 20  # of an address
MESSAGE_S = 10.0  # for a message, once its first byte is there, and for an answer to be read
HANDSHAKE_S = 10.0
RESPONSE_S = 120.0  # for shapes and videos to be read, on a slow network too
PUBLIC_S = 20.0  # for what is there without the token, and for refusals
IDLE_S = 30.0  # an open page says something more often
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "media-src blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)


@dataclass(frozen=True)
class Reply:
    """The content of an address.

    Attributes:
        content: The bytes.
        kind: Their media type.
    """

    content: bytes
    kind: str = "application/octet-stream"


class Visit(Protocol):
    """One open page."""

    def answer(self, message: dict[str, Any]) -> bytes | str | None:
        """Answers a message of the page; None for a message without an answer."""

    def end(self) -> None:
        """The page has gone."""


class Site(Protocol):
    """What a server shows."""

    def page(self, query: Mapping[str, str]) -> tuple[str, str] | None:
        """Returns the part of the page that shows it, and its title; None if there is none."""

    def get(self, path: str, query: Mapping[str, str]) -> Reply | None:
        """Returns the data at an address; None if there is none. Called in a client's thread."""

    def visit(self) -> Visit | None:
        """Returns the session of a page that opened a WebSocket; None if the site has none."""


class WebServer(ChannelServer):
    """Serves a site. It listens from its construction on, and answers after `start`.

    Args:
        site: What is shown.
        host: Address to listen at; only this machine reaches the default.
        port: 0 for a free one.
        token: The secret in the address. Default: a new one.
        certificate: Files with a certificate and its key, for https.

    Raises:
        ArgumentError: There is no such port.
        IoError: The address, the port or the certificate cannot be used.
    """

    def __init__(
        self,
        site: Site,
        *,
        host: str = HOST,
        port: int = 0,
        token: str | None = None,
        certificate: tuple[Path, Path] | None = None,
    ) -> None:
        self._site = site
        self._token = token or secrets.token_urlsafe(24)
        self._tls = None if certificate is None else _tls(*certificate)
        super().__init__(host, port, MOST_CLIENTS, "page")
        self._asked_host = host
        self._thread_of_all: threading.Thread | None = None

    @property
    def url(self) -> str:
        """Address of the page, with the token. Whoever has it may use the page."""
        scheme = "http" if self._tls is None else "https"
        host = self.host
        if ipaddress.ip_address(host.partition("%")[0]).is_unspecified:
            host = socket.gethostname()
        netloc = f"[{host}]:{self.port}" if ":" in host else f"{host}:{self.port}"
        return f"{scheme}://{netloc}/?token={self._token}"

    def start(self) -> None:
        """Answers clients from now on, in threads."""
        self._thread_of_all = threading.Thread(target=self.serve, name="page server", daemon=True)
        self._thread_of_all.start()

    def close(self) -> None:
        """Stops listening and ends all connections; may be repeated."""
        super().close()
        if self._thread_of_all is not None:
            self._thread_of_all.join(5)

    def wrapped(self, connection: socket.socket) -> socket.socket:
        """Encrypts the connection if there is a certificate; the handshake comes with the data."""
        if self._tls is None:
            return connection
        return self._tls.wrap_socket(connection, server_side=True, do_handshake_on_connect=False)

    def protocol(self) -> ServerProtocol:
        """Returns the state of a new connection."""
        return ServerProtocol(max_size=MOST_BYTES)

    def serve_client(
        self, channel: Channel, protocol: ServerProtocol, is_one_too_many: bool
    ) -> None:
        """Answers a request, or the messages of a WebSocket."""
        deadline = Deadline(HANDSHAKE_S, "request")
        request = channel.handshake(deadline)
        if not isinstance(request, Request) or protocol.parser_exc is not None:
            return
        try:
            response = self._response(protocol, request, is_one_too_many)
        except Exception as error:  # of a site: the others' pages go on
            response = _refused(
                http.HTTPStatus.INTERNAL_SERVER_ERROR, f"The page failed: {place_of(error)}"
            )
        protocol.send_response(response)
        has_token = response.status_code == http.HTTPStatus.OK and _path_of(request) not in FILES
        channel.flush(Deadline(RESPONSE_S if has_token else PUBLIC_S, "reader"))
        if response.status_code == http.HTTPStatus.SWITCHING_PROTOCOLS:
            self._converse(channel)

    def _response(
        self, protocol: ServerProtocol, request: Request, is_one_too_many: bool
    ) -> Response:
        if is_one_too_many:
            return _refused(http.HTTPStatus.SERVICE_UNAVAILABLE, "There are too many clients.")
        host = _only(request.headers.get_all("Host"))
        if not self._is_own(host):
            return _refused(http.HTTPStatus.FORBIDDEN, "This is not the host of the server.")
        name = _path_of(request)
        if name in FILES:
            return _found(Reply(page_file(name), FILES[name]))
        try:
            found_in_query = parse_qs(request.path.partition("?")[2], max_num_fields=MOST_FIELDS)
        except ValueError:
            return _refused(http.HTTPStatus.BAD_REQUEST, "The address has too many fields.")
        query = {key: values[0] for key, values in found_in_query.items()}
        given = query.pop("token", "").encode(errors="surrogateescape")
        if not hmac.compare_digest(given, self._token.encode()):
            return _refused(
                http.HTTPStatus.UNAUTHORIZED,
                "The address lacks the token: open the one that the command printed.",
            )
        if name == "socket":
            scheme = "http" if self._tls is None else "https"
            origin = _only(request.headers.get_all("Origin"))
            if origin.lower() != f"{scheme}://{host}".lower():
                return _refused(http.HTTPStatus.FORBIDDEN, "Pages of other sites may not connect.")
            return protocol.accept(request)
        try:
            found = self._index(query) if name == "" else self._site.get(name, query)
        except Error as error:
            return _refused(http.HTTPStatus.CONFLICT, str(error))
        if found is None:
            return _refused(http.HTTPStatus.NOT_FOUND, "There is no such address.")
        return _found(found)

    def _index(self, query: Mapping[str, str]) -> Reply | None:
        page = self._site.page(query)
        if page is None:
            return None
        kind, title = page
        return Reply(index_page(kind, title).encode(), "text/html; charset=utf-8")

    def _is_own(self, host: str) -> bool:
        """Returns True for the names by which a browser may call this server.

        Another name would be that of a site whose address was changed to this machine's.
        """
        host = host.lower()  # as browsers write it
        name, _, port = host.rpartition(":")
        if self.port == (80 if self._tls is None else 443) and (
            not port.isdecimal() or host.endswith("]")
        ):
            name, port = host, str(self.port)  # browsers leave the usual port out
        if port != str(self.port):
            return False
        address = ipaddress.ip_address(self.host.partition("%")[0])
        if address.is_loopback:
            return name in LOOPBACK_NAMES or name == self.netloc.rpartition(":")[0]
        if address.is_unspecified:
            own = {socket.gethostname().lower(), *LOOPBACK_NAMES}
            return name in own or _is_address(name)
        return name in (self._asked_host.lower(), self.netloc.rpartition(":")[0])

    def _converse(self, channel: Channel) -> None:
        visit = self._site.visit()
        if visit is None:
            return
        try:
            while True:
                message = channel.receive(Deadline(MESSAGE_S, "message"), True, IDLE_S)
                answer = visit.answer(message_of(message))
                if answer is not None:
                    channel.send(answer, Deadline(MESSAGE_S, "reader"))
        except MisbehavedError as error:
            channel.close(CloseCode.POLICY_VIOLATION, str(error))
            raise
        finally:
            visit.end()


def message_of(data: bytes | str) -> dict[str, Any]:
    """Returns a message of a page: a JSON object with finite numbers and an `op`.

    Raises MisbehavedError for anything else.
    """
    if isinstance(data, bytes):
        raise MisbehavedError("a page sends text")
    try:
        message = json.loads(data, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise MisbehavedError(f"a message is not JSON: {error}") from error
    if not isinstance(message, dict) or not isinstance(message.get("op"), str):
        raise MisbehavedError("a message is an object with an `op`")
    _require_plain(message, MOST_LEVELS)
    return message


def number_of(message: Mapping[str, Any], key: str) -> float:
    """Returns a number of a message. Raises MisbehavedError."""
    value = message.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MisbehavedError(f"`{key}` of '{message['op']}' is a number")
    return float(value)


def text_of(message: Mapping[str, Any], key: str) -> str:
    """Returns a text of a message. Raises MisbehavedError."""
    value = message.get(key)
    if not isinstance(value, str):
        raise MisbehavedError(f"`{key}` of '{message['op']}' is a text")
    return value


def vector_of(message: Mapping[str, Any], key: str, size: int) -> list[float]:
    """Returns so many numbers of a message; zeros if the key is missing. Raises MisbehavedError."""
    values = message.get(key, [0.0] * size)
    if (
        not isinstance(values, list)
        or len(values) != size
        or any(isinstance(each, bool) or not isinstance(each, int | float) for each in values)
    ):
        raise MisbehavedError(f"`{key}` of '{message['op']}' is a list of {size} numbers")
    return [float(each) for each in values]


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number of JSON")


def _require_plain(value: object, levels: int) -> None:
    if levels == 0:
        raise MisbehavedError("a message is nested too deeply")
    if isinstance(value, float) and not math.isfinite(value):
        raise MisbehavedError("a number of a message is not finite")
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) > 1 << 53:
        raise MisbehavedError("a number of a message is too large")
    children = value.values() if isinstance(value, dict) else value
    if isinstance(children, list) or isinstance(value, dict):
        for child in children:  # type: ignore[attr-defined]
            _require_plain(child, levels - 1)


def _path_of(request: Request) -> str:
    """Returns the path of a request, without its query."""
    return request.path.partition("?")[0].partition("#")[0].removeprefix("/")


def _only(values: list[str]) -> str:
    """Returns the value of a header that is there once; '' otherwise."""
    return values[0] if len(values) == 1 else ""


def _is_address(name: str) -> bool:
    with contextlib.suppress(ValueError):
        ipaddress.ip_address(name.removeprefix("[").removesuffix("]"))
        return True
    return False


def _tls(certificate: Path, key: Path) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(certificate, key)
    except OSError as error:  # an SSLError is one
        raise IoError(
            f"cannot use the certificate '{certificate}' with the key '{key}': {error}"
        ) from error
    return context


def _headers(kind: str, size: int) -> Headers:
    return Headers(
        {
            "Content-Type": kind,
            "Content-Length": str(size),
            "Connection": "close",
            "Cache-Control": "no-store",
            "Content-Security-Policy": POLICY,
            "Cross-Origin-Resource-Policy": "same-origin",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
        }
    )


def _found(reply: Reply) -> Response:
    return Response(200, "OK", _headers(reply.kind, len(reply.content)), reply.content)


def _refused(status: http.HTTPStatus, text: str) -> Response:
    content = f"{text}\n".encode()
    headers = _headers("text/plain; charset=utf-8", len(content))
    return Response(status.value, status.phrase, headers, content)
