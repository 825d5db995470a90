"""`robocell view --web`: a page of a robot, a scene, a start of a run, an episode or a dataset."""

from __future__ import annotations

import contextlib
import ipaddress
import signal
import threading
from collections.abc import Iterator
from pathlib import Path

from robocell._cli.common import fail, is_dataset, print_warning
from robocell._cli.view import load
from robocell._stored_files import is_stored
from robocell._web.dataset_page import DatasetPages
from robocell._web.live_scene import LiveScene
from robocell._web.web_server import Site, WebServer


def view_in_browser(target: Path, index: int, speed: float, host: str, port: int) -> None:
    """Serves a page until Ctrl-C."""
    if target.name in ("", ".."):
        target = target.resolve()
    if is_stored(target / "episode.json"):
        wait_serving(DatasetPages(target.parent, target.name), host, port)
        return
    if is_dataset(target):
        wait_serving(DatasetPages(target), host, port)
        return
    if target.is_dir():
        fail(f"'{target}' is a folder without episodes; give a dataset, or one of its episodes")
    shown = load(target, index)
    live = LiveScene(shown.scene, target.stem, speed, shown.restart)
    with contextlib.suppress(KeyboardInterrupt), serving(live, host, port):
        live.run()


def _is_own(address: str) -> bool:
    """Returns True for an address that only this machine reaches."""
    return ipaddress.ip_address(address.partition("%")[0]).is_loopback


def wait_serving(site: Site, host: str, port: int) -> None:
    """Serves a site whose data stay as they are until Ctrl-C."""
    with contextlib.suppress(KeyboardInterrupt), serving(site, host, port):
        threading.Event().wait()


@contextlib.contextmanager
def serving(
    site: Site,
    host: str,
    port: int,
    certificate: tuple[Path, Path] | None = None,
    *,
    offers_tls: bool = False,
) -> Iterator[WebServer]:
    """Serves a site, prints its address, and ends at SIGTERM as at Ctrl-C.

    Args:
        site: The site.
        host: Address to listen at.
        port: 0 for a free one.
        certificate: Files with a certificate and its key, for https.
        offers_tls: The command has the option --tls.
    """
    server = WebServer(site, host=host, port=port, certificate=certificate)
    if not _is_own(server.host):
        way = "use --tls" if offers_tls else "use a tunnel, ssh -L"
        clear = "" if certificate else f" that goes over the network in clear text: {way}"
        print_warning(
            f"the page can be opened from other machines that reach {host}; its address is a "
            f"password{clear}"
        )

    def end(_signal: int, _frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, end)
    server.start()
    try:  # who reads the address may end the command at once
        print(f"page: {server.url}", flush=True)
        print("Ctrl-C ends it.", flush=True)
        yield server
    finally:
        signal.signal(signal.SIGTERM, before)
        server.close()
