"""Draws the pictures of the pages in a browser: docs/web_live.png, web_episode.png and teleop.png.

    python docs/make_web_pictures.py

Needs Debian's chromium, which runs without a display. The picks come from examples/demo.yaml.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import robocell as rc
from robocell._cli.robot_scene import load_robot
from robocell._teleop.device import Device, Motion
from robocell._teleop.operator import OperatorOptions
from robocell._teleop.session import record
from robocell._web.dataset_page import DatasetPages
from robocell._web.live_scene import LiveScene
from robocell._web.teleop_page import PageDevice, TeleopPage
from robocell._web.web_server import WebServer

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS.parent / "python" / "tests"))

from browser import Tab, browsing  # noqa: E402

BUTTON = "[...document.querySelectorAll('button')].find((each) => each.textContent === '{}')"


def press(tab: Tab, text: str) -> None:
    """Clicks a button."""
    tab.value(f"{BUTTON.format(text)}.click()")


def picture(tab: Tab, name: str, is_ready: str) -> None:
    """Writes a picture when an expression is true."""
    tab.wait_for(is_ready)
    tab.screenshot(DOCS / name)
    assert not tab.said, tab.said
    tab.open("about:blank")


def of_site(tab: Tab, site: Any, act: Callable[[], None]) -> None:
    """Serves a site, opens it, and acts."""
    server = WebServer(site)
    server.start()
    tab.open(server.url)
    act()
    server.close()


def live(tab: Tab) -> None:
    """A robot with its frames and the images of a camera."""
    site = LiveScene(load_robot(Path(rc.models.robot_file("rc7"))).scene, "rc7")
    thread = threading.Thread(target=site.run)
    thread.start()

    def act() -> None:
        tab.wait_for("Number(document.documentElement.dataset.frames) > 3")
        tab.value("document.querySelectorAll('details').forEach((each) => (each.open = true))")
        tab.value("document.querySelector('details:nth-of-type(2)').open = false")
        press(tab, "wrist_camera")
        tab.value(
            "(() => { const select = document.querySelector('select'); select.value = 'robot';"
            "select.dispatchEvent(new Event('change')); })()"
        )
        picture(tab, "web_live.png", "RC.page.cameras.wrist_camera.width === 320")

    of_site(tab, site, act)
    site.stop()
    thread.join()


def demo(folder: Path) -> Path:
    """The example, with one pick."""
    run = DOCS.parent / "examples" / "demo.yaml"
    command = [sys.executable, "-m", "robocell", "generate", str(run), "--episodes", "1"]
    subprocess.run([*command, "--output", str(folder)], check=True, stdout=subprocess.DEVNULL)
    return folder


def episode(tab: Tab, folder: Path) -> None:
    """A pick in the middle."""

    def act() -> None:
        tab.wait_for("document.documentElement.dataset.loaded")
        tab.wait_for("RC.page.videos.every((each) => each.readyState >= 2)")
        tab.value("RC.page.show(Math.round(0.6 * RC.page.times.length))")
        picture(tab, "web_episode.png", "RC.page.videos.every((each) => !each.seeking)")

    of_site(tab, DatasetPages(folder, "s0000_e0000"), act)


class Hand(Device):
    """A page, and a hand that moves the arm down to the object."""

    def __init__(self, page: PageDevice) -> None:
        self.page, self.actions, self.quits = page, 0, False

    def read(self, seconds: float) -> Motion | None:
        """Records at once, and quits after the picture."""
        self.page.read(seconds)
        self.actions += 1
        commands = ("quit",) if self.quits else ("record",) if self.actions < 5 else ()
        return Motion(translation=(0.006, 0, -0.006), opening=1, commands=commands)


def teleop(tab: Tab, folder: Path) -> None:
    """A session while it records."""
    run = rc.RunConfig.load(str(DOCS.parent / "examples" / "demo.yaml"))
    run.output = str(folder)
    device = PageDevice()
    site = TeleopPage(
        "Teleoperation, demo", device, [stream.name for stream in run.cameras.streams], device.help
    )
    device.site = site
    hand = Hand(device)
    options = OperatorOptions(countdown_s=0)
    thread = threading.Thread(target=lambda: record(run, hand, options, site))
    thread.start()

    def act() -> None:
        tab.wait_for("document.documentElement.dataset.phase === 'recording'")
        picture(tab, "teleop.png", "RC.page.cameras.exo.width === 320")

    of_site(tab, site, act)
    hand.quits = True
    thread.join()


def main() -> None:
    """Draws all pictures."""
    with tempfile.TemporaryDirectory() as folder, browsing(Path(folder)) as tab:
        tab.resize(1280, 800)
        live(tab)
        episode(tab, demo(Path(folder) / "demo"))
        teleop(tab, Path(folder) / "teleop")


if __name__ == "__main__":
    main()
