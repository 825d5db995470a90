"""The pages in a browser: they draw, act and play, and their consoles stay empty."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from browser import Tab, browsing
from command_line import RC7, environment_with, write_run
from report_dataset import mixed_dataset
from robocell._cli.robot_scene import load_robot
from robocell._web.dataset_page import DatasetPages
from robocell._web.live_scene import LiveScene
from robocell._web.teleop_page import PageDevice, TeleopPage
from robocell._web.web_server import WebServer
from test_soft_parts import soft_model

pytestmark = pytest.mark.proof

BUTTON = "[...document.querySelectorAll('button')].find((each) => each.textContent === '{}')"


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browsing(tmp_path_factory.mktemp("browser")) as made:
        made.resize(1280, 800)
        yield made


@pytest.fixture(autouse=True)
def silence(tab: Tab) -> Iterator[None]:
    tab.said.clear()
    yield
    tab.open("about:blank")
    assert tab.said == []


@contextlib.contextmanager
def served(site: Any) -> Iterator[WebServer]:
    server = WebServer(site)
    server.start()
    yield server
    server.close()


def press(tab: Tab, text: str) -> None:
    tab.value(f"{BUTTON.format(text)}.click()")


def colours(image: np.ndarray) -> int:
    return len(np.unique(image.reshape(-1, 3), axis=0))


def test_a_running_robot_is_drawn_and_obeys_the_page(tab: Tab, tmp_path: Path):
    scene = load_robot(RC7).scene
    live = LiveScene(scene, "robot")
    thread = threading.Thread(target=live.run)
    thread.start()
    with served(live) as server:
        try:
            tab.open(server.url)
            tab.wait_for("Number(document.documentElement.dataset.frames) > 3")
            before = tab.screenshot(tmp_path / "before.png")
            assert colours(before[:, :900]) > 200
            assert tab.value("document.title") == "robot"
            press(tab, "Pause")
            tab.value(
                "RC.page.joints[0].querySelector('input').value = 1.2;"
                "RC.page.joints[0].querySelector('input').dispatchEvent(new Event('input'))"
            )
            tab.wait_for("Math.abs(RC.page.view.bodies.length) > 3")
            press(tab, "wrist_camera")
            tab.wait_for("RC.page.cameras.wrist_camera.width === 320")
            tab.value(
                "document.querySelector('select').value = 'robot';"
                "document.querySelector('select').dispatchEvent(new Event('change'))"
            )
            tab.wait_for("document.querySelector('.note').textContent.length > 0")
            after = tab.screenshot(tmp_path / "after.png")
            assert np.mean(before[:, :900] != after[:, :900]) > 0.005, "the arm has turned"
            tab.drag(400, 400, 200, 30)
            turned = tab.screenshot(tmp_path / "turned.png")
            assert np.mean(turned[:, :900] != after[:, :900]) > 0.05
        finally:
            live.stop()
            thread.join(10)
    assert scene.robot("rc7").arm.joint_pos[0] == pytest.approx(1.2, abs=0.01)
    tab.wait_for("document.documentElement.dataset.connected === 'false'")
    assert "closed" in tab.value("document.querySelector('.banner').textContent")


def test_a_dataset_is_listed_and_its_episodes_play(
    tab: Tab, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    folder = mixed_dataset(tmp_path_factory)
    dataset = rc.Dataset(folder)
    good = [episode.id for episode in dataset if episode.success]
    with served(DatasetPages(folder)) as server:
        tab.open(server.url)
        tab.wait_for("document.documentElement.dataset.loaded")
        rows = "document.querySelectorAll('tbody tr').length"
        assert tab.value(rows) == len(dataset)
        tab.value(
            "document.querySelector('select').value = 'success';"
            "document.querySelector('select').dispatchEvent(new Event('change'))"
        )
        assert tab.value(rows) == len(good)
        tab.value("document.querySelector('tbody a').click()")
        tab.wait_for("document.documentElement.dataset.loaded && !!RC.page?.slider")
        assert tab.value("document.title") == f"{good[0]}, success"
        episode = dataset[good[0]]
        tab.value(f"RC.page.show({len(episode) - 1})")
        assert tab.value("document.documentElement.dataset.row") == str(len(episode) - 1)
        last = tab.screenshot(tmp_path / "last.png")
        press(tab, "Play")
        tab.wait_for("Number(document.documentElement.dataset.row) > 2")
        first = tab.screenshot(tmp_path / "first.png")
        assert colours(first[:400, :900]) > 200
        assert np.mean(first[:, :900] != last[:, :900]) > 0.01
        assert tab.value("RC.page.plotted.size") >= 1
        videos = "RC.page.videos.filter((each) => each.readyState >= 2).length"
        tab.wait_for(f"{videos} === {len(episode.cameras)}")


def test_tendons_flexes_and_skins_are_drawn(tab: Tab, tmp_path: Path):
    """Each has a colour of its own: red, blue and green."""
    model = tmp_path / "soft.xml"
    model.write_text(soft_model())
    spec = rc.SceneSpec(name="soft", timestep=0.002, add_floor=False, add_skybox=False)
    spec.base = model
    file = tmp_path / "soft.html"
    rc.show(rc.Scene.build(spec)).save(str(file))
    tab.open(file.as_uri())
    tab.wait_for("document.documentElement.dataset.loaded")
    time.sleep(0.5)
    pixels = tab.screenshot(tmp_path / "soft.png")[..., :3].astype(int)
    for channel in range(3):
        others = np.delete(pixels, channel, axis=2).max(axis=2)
        assert (pixels[..., channel] > others + 60).sum() > 30


def test_a_page_in_one_file_needs_no_server(tab: Tab, tmp_path: Path):
    file = tmp_path / "scene.html"
    rc.show(load_robot(RC7).scene).save(str(file))
    tab.open(file.as_uri())
    tab.wait_for("document.documentElement.dataset.loaded")
    assert colours(tab.screenshot(tmp_path / "still.png")[:, :900]) > 200


# From the TCP to the target, as the operator sees it: forward, left, up.
AWAY = """(() => {
  const view = RC.page.view, header = view.header;
  const at = view.bodies[header.bodies.indexOf("target")].position.clone();
  const tcp = header.frames.find((each) => each.kind === "robot");
  const body = view.bodies[tcp.body];
  body.updateMatrixWorld(true);
  at.sub(new THREE.Vector3(...tcp.pos).applyMatrix4(body.matrixWorld));
  const angle = view.azimuth(), c = Math.cos(angle), s = Math.sin(angle);
  return [c * at.x + s * at.y, -s * at.x + c * at.y, at.z];
})()"""
METRES_PER_SECOND = 0.2  # of a key


def step(tab: Tab, keys: str, away: float) -> None:
    """Holds the first or the second key until a distance should be covered."""
    code = f"Key{keys[0] if away > 0 else keys[1]}"
    tab.key(code, code[-1].lower(), min(0.6 * abs(away) / METRES_PER_SECOND, 0.5))
    before = None
    while before != (before := [round(each, 3) for each in tab.value(AWAY)]):
        time.sleep(0.2)  # until the arm is there


def pick(tab: Tab) -> None:
    """Moves above the target, down to it, closes the gripper and lifts, by keys alone."""
    for _ in range(100):
        forward, left, up = tab.value(AWAY)
        if abs(forward) > 0.012:
            step(tab, "WS", forward)
        elif abs(left) > 0.012:
            step(tab, "AD", left)
        elif up < -0.012:
            step(tab, "RF", max(up, -0.05))
        else:
            break
    tab.key("Space", " ", 0.1)
    time.sleep(1)
    for _ in range(20):
        if tab.value("document.documentElement.dataset.phase") == "review":
            return
        tab.key("KeyR", "r", 0.3)


def test_a_pick_is_recorded_in_the_browser(tab: Tab, tmp_path: Path):
    run = write_run(tmp_path, rates={"policy_ms": 66, "control_ms": 2, "sim_ms": 2})
    command = [sys.executable, "-m", "robocell", "teleop", str(run), "-n", "1"]
    command += ["--output", str(tmp_path / "out"), "--countdown", "0.2", "--max-seconds", "300"]
    tab.resize(760, 560)  # without a graphics card, large pictures take long
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment_with({}))
    try:
        assert process.stdout is not None
        mark = "page: "
        url = next(each.removeprefix(mark) for each in process.stdout if each.startswith(mark))
        tab.open(url.strip())
        tab.wait_for("document.documentElement.dataset.phase === 'waiting'")
        tab.key("Enter")
        tab.wait_for("document.documentElement.dataset.phase === 'recording'")
        before = tab.value(AWAY)[2]
        pad = tab.value(
            "(() => { const box = document.querySelector('[data-pad=lift]')"
            ".getBoundingClientRect(); return [box.x + 60, box.y + 90]; })()"
        )
        for _ in range(10):  # a busy machine loses some of the moves
            tab.drag(*pad, 0, -50)
            time.sleep(0.5)
            if tab.value(AWAY)[2] < before - 0.015:
                break
        assert tab.value(AWAY)[2] < before - 0.015, "the pad lifts the TCP"
        tab.wait_for("RC.page.cameras.wrist.width === 64")
        pick(tab)
        tab.screenshot(tmp_path / "picked.png")
        tab.wait_for("document.documentElement.dataset.phase === 'review'")
        assert tab.value("document.querySelector('.banner').textContent").startswith("Success")
        tab.key("Enter")
        assert process.wait(30) == 0
    finally:
        process.kill()
    [episode] = rc.Dataset(tmp_path / "out")
    assert episode.success
    assert rc.data.verify(tmp_path / "out", decode_videos=True).ok


def test_two_arms_of_a_cell_are_driven_in_the_browser(tab: Tab, tmp_path: Path):
    """T hands over to the other arm, and what was closed stays closed."""
    cell = tmp_path / "duo.yaml"
    cell.write_text(
        f"name: duo\nrobots: {{left: {RC7}, right: {RC7}}}\nadd_floor: true\n"
        "robot_to_shared_base_frame: {left: {pos: [0, 0.4, 0]}, right: {pos: [0, -0.4, 0]}}\n"
        "sim: {frequency: 15}\n"
    )
    command = [sys.executable, "-m", "robocell", "teleop", str(cell), "--keep-all", "-n", "1"]
    command += ["--output", str(tmp_path / "out"), "--countdown", "0.2", "--max-seconds", "300"]
    tab.resize(760, 560)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment_with({}))
    try:
        assert process.stdout is not None
        mark = "page: "
        url = next(each.removeprefix(mark) for each in process.stdout if each.startswith(mark))
        tab.open(url.strip())
        tab.wait_for("document.documentElement.dataset.phase === 'waiting'")
        tab.key("Enter")
        tab.wait_for("document.documentElement.dataset.phase === 'recording'")
        tab.wait_for("RC.page.arm === 'left'")
        tab.key("Space", " ", 0.1)
        for key in ("KeyR", "KeyT", "KeyF"):
            tab.key(key, key[-1].lower(), 0.6)
            time.sleep(0.5)
        tab.wait_for("RC.page.arm === 'right'")
        tab.screenshot(tmp_path / "two_arms.png")
        tab.key("KeyY", "y", 0.1)
        assert process.wait(60) == 0
    finally:
        process.kill()
    [episode] = rc.Dataset(tmp_path / "out")
    assert episode.success
    up = {
        side: np.ptp(episode[f"robots/{side}/action/tcp_pose"][:, 2]) for side in ("left", "right")
    }
    assert min(up.values()) > 0.02
    assert episode["robots/left/action/gripper"][-1] == 0
    assert episode["robots/right/action/gripper"][-1] > 0.9


class Phone(threading.Thread):
    """A session without a run: reads the device, and shows a scene as if it recorded."""

    def __init__(self) -> None:
        super().__init__()
        self.device, self.turned, self.ends = PageDevice(), np.zeros(3), threading.Event()
        self.site = self.device.site = TeleopPage("phone", self.device, [])
        self.scene = load_robot(RC7).scene
        self.start()

    def run(self) -> None:
        status = {"phase": "recording", "rows": 0, "episode": "", "success": False}
        status |= {"left_s": None, "silent": False, "blocked": "", "instruction": ""}
        while not self.ends.wait(0.03):
            motion = self.device.read(0.03)
            if motion is not None:
                self.turned += motion.rotation
            self.site.show(self.scene, status, {})


def test_a_phone_turns_the_tool(tab: Tab):
    phone = Phone()
    try:
        with served(phone.site) as server:
            tab.call("Emulation.setTouchEmulationEnabled", enabled=True)
            coarse = [{"name": "pointer", "value": "coarse"}]
            tab.call("Emulation.setEmulatedMedia", features=coarse)
            tab.open(server.url)
            tab.wait_for("document.documentElement.dataset.phase === 'recording'")
            tab.value("RC.page.frame = 'base'")
            press(tab, "Turn with the phone")
            for alpha, beta, gamma in ((0, 0, 0), (30, 0, 0), (30, 20, 0), (30, 20, 10)):
                tab.call(
                    "DeviceOrientation.setDeviceOrientationOverride",
                    alpha=alpha,
                    beta=beta,
                    gamma=gamma,
                )
                time.sleep(1)
    finally:
        phone.ends.set()
        phone.join()
        tab.call("Emulation.setTouchEmulationEnabled", enabled=False)
        tab.call("Emulation.setEmulatedMedia", features=[])
    # gamma turns about the phone's y axis, which beta has raised by 20 degrees
    c, s = np.cos(np.radians(20)), np.sin(np.radians(20))
    np.testing.assert_allclose(np.degrees(phone.turned), [10 * c, -20, 30 + 10 * s], atol=0.1)


def rotation_of_phone(degrees: np.ndarray) -> np.ndarray:
    """As the W3C defines alpha, beta and gamma."""
    (ca, cb, cg), (sa, sb, sg) = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    about_z = np.array([[ca, -sa, 0], [sa, ca, 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, cb, -sb], [0, sb, cb]])
    about_y = np.array([[cg, 0, sg], [0, 1, 0], [-sg, 0, cg]])
    return np.asarray(about_z @ about_x @ about_y)


def test_turns_of_a_phone_are_those_of_its_rotation_matrices(tab: Tab):
    """Whatever its attitude: upright, too, where alpha and gamma jump."""
    rng = np.random.default_rng(3)
    with served(TeleopPage("phone", None, [])) as server:
        tab.open(server.url)
        tab.wait_for("typeof RC !== 'undefined' && !!RC.phoneTurn")
        for k in range(20):
            first = rng.uniform((0, -180, -90), (360, 180, 90))
            if k < 5:
                first[1] = 90 - 1e-4  # it stands
            second = rng.uniform((0, -180, -90), (360, 180, 90)) if k % 2 else first + rng.normal(3)
            a, b = (f"RC.phoneRotation({','.join(map(str, each))})" for each in (first, second))
            turn = np.array(tab.value(f"RC.phoneTurn({a}, {b})"))
            before, now = rotation_of_phone(first), rotation_of_phone(second)
            right = before[:, 0] * [1, 1, 0] / np.linalg.norm(before[:2, 0])
            axes = np.stack([[-right[1], right[0], 0], -right, [0, 0, 1]], axis=1)
            angle = np.linalg.norm(vector := axes @ turn)
            x, y, z = vector / angle
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turned = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
            np.testing.assert_allclose(turned @ before, now, atol=1e-6)


def test_a_key_that_is_let_go_never_moves_the_arm_on(tab: Tab):
    """Whatever is held, chosen or clicked meanwhile; and a picture that stands drives nothing."""
    phone = Phone()
    send = "(on || document).dispatchEvent(new KeyboardEvent(kind, {{code, bubbles: true, {}}}))"
    key = "((kind, code, on) => {{ {}; return RC.page.pressed.size }})({!r}, {!r}, {})"

    def says(kind: str, code: str, held: str = "", on: str = "document.body") -> int:
        return int(tab.value(key.format(send.format(held), kind, code, on)))

    try:
        with served(phone.site) as server:
            tab.open(server.url)
            tab.wait_for("document.documentElement.dataset.phase === 'recording'")
            assert says("keydown", "KeyW") == 1
            assert says("keyup", "KeyW", "ctrlKey: true") == 0
            assert says("keydown", "KeyW") == 1
            assert says("keydown", "ControlLeft", "ctrlKey: true") == 0
            assert says("keydown", "KeyW") == 1
            assert says("keyup", "KeyW", on="document.querySelector('select')") == 0
            assert says("keydown", "KeyW") == 1
            assert (
                tab.value("(document.querySelector('select').focus(), RC.page.pressed.size)") == 0
            )
            assert says("keydown", "KeyW") == 1
            press(tab, "Clutch")
            assert tab.value("RC.page.pressed.size") == 0
            press(tab, "Clutch")
            assert says("keydown", "KeyW") == 1
            phone.ends.set()
            tab.wait_for("RC.page.isStale() && RC.page.pressed.size === 0")
    finally:
        phone.ends.set()
        phone.join()


def test_a_frame_that_fails_is_told_and_others_follow(tab: Tab):
    phone = Phone()
    try:
        with served(phone.site) as server:
            tab.open(server.url)
            tab.wait_for("document.documentElement.dataset.phase === 'recording'")
            tab.value(
                "RC.page.show_ = RC.page.show; RC.page.show = () => { throw Error('no phase') }"
            )
            tab.wait_for("RC.page.banner.textContent.includes('not of now: no phase')")
            tab.wait_for("RC.page.isStale()")
            tab.value("RC.page.show = RC.page.show_")
            tab.wait_for("!RC.page.isStale() && RC.page.banner.textContent.includes('Recording')")
    finally:
        phone.ends.set()
        phone.join()
