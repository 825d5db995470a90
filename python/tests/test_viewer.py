"""The viewer: as a program uses it in memory, and as a user does at a display."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
import robocell.compat.mj_kdl_wrapper as mjk
from graphics import require_gl
from virtual_display import Display, virtual_display


def built() -> rc.Scene:
    """The built-in arm and a cube."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="arm", config=config, control_modes=config.used_modes()))
    spec.objects.append(
        rc.SceneObject(
            name="cube",
            shape=rc.Shape.BOX,
            size=[0.03, 0.03, 0.03],
            rgba=[1, 0.4, 0, 1],
            mass=0.1,
            friction=[0.8, 0.02, 0.001],
            pos=[0.6, 0.2, 0.03],
        )
    )
    spec.cameras.append(
        rc.render.CameraSpec(name="side", pos=[0, -3, 0.7], fovy=45, look_at=[0, 0, 0.5])
    )
    return rc.Scene.build(spec)


@pytest.fixture
def scene() -> rc.Scene:
    require_gl()
    return built()


def in_memory(target: object, **options: object) -> rc.viewer.Viewer:
    return rc.viewer.open(target, width=480, height=360, on_screen=False, **options)


def test_steps_until_the_window_is_closed(scene: rc.Scene):
    robot = scene.robot("arm")
    with in_memory(robot, title="arm") as viewer:
        viewer.realtime_factor = 0
        assert viewer.title == "arm"
        for _ in range(5):
            assert viewer.step()
        assert scene.time() == pytest.approx(0.01)
        viewer.post("close")
        viewer.show()
        assert not viewer.is_running
        assert not viewer.step()
        assert not robot.step()
        result = scene.step_n(3)
        assert result.stopped
        assert not result.diverged
        assert "closed the window 'arm'" in result.message
    assert robot.step()


def test_pausing_holds_steps_of_any_number(scene: rc.Scene):
    with in_memory(scene) as viewer:
        viewer.paused = True
        assert scene.step_n(1000).steps == 0
        assert viewer.step()
        assert scene.time() == 0


def test_names_are_checked(scene: rc.Scene):
    with in_memory(scene) as viewer:
        with pytest.raises(rc.NotFoundError, match="Did you mean 'side'"):
            viewer.use_camera("sied")
        with pytest.raises(rc.NotFoundError, match="cube"):
            viewer.show_frame("body", "cub")
        with pytest.raises(ValueError, match="'tcp' or 'camera', got 'joint'"):
            viewer.show_frame("joint", "cube")
        with pytest.raises(ValueError, match="realtime_factor"):
            viewer.realtime_factor = -1
    with pytest.raises(TypeError, match=r"expected a Scene, a Robot or an environment"):
        rc.viewer.open(rc.SceneSpec(name="a"), on_screen=False)


def test_an_environment_goes_on_without_its_window():
    require_gl()
    env = rc.Env(rc.EnvConfig.load(rc.models.cell_file("rc7")))
    env.reset(0)
    with in_memory(env) as viewer:
        viewer.realtime_factor = 0
        viewer.post("close")
        viewer.show()
        assert env.scene.step()


def test_the_scene_of_an_environment_is_not_stopped():
    require_gl()
    env = rc.Env(rc.EnvConfig.load(rc.models.cell_file("rc7")))
    env.reset(0)
    with in_memory(env.scene) as viewer:
        viewer.realtime_factor = 0
        with pytest.raises(rc.Error, match="cannot pause"):
            viewer.paused = True
        viewer.post("key", key=ord(" "))
        viewer.show()
        assert not viewer.paused
        viewer.post("close")
        viewer.show()
        assert env.scene.step()


def test_a_scene_has_one_viewer_at_a_time(scene: rc.Scene):
    first = in_memory(scene, title="first")
    with pytest.raises(rc.Error, match="has the viewer 'first' already"):
        in_memory(scene, stops_scene=False, draws_steps=False)
    first.close()
    in_memory(scene).close()


def test_robots_of_another_scene_are_refused(scene: rc.Scene):
    viewer = in_memory(scene)
    with pytest.raises(rc.ArgumentError, match="belongs to another scene"):
        viewer.drag_tcp(built().robot("arm"))
    viewer.close()


# In a process of its own: that of the tests has memory of other tests, which comes and goes.
COME_AND_GO = """
import gc
from pathlib import Path
import robocell as rc, test_viewer

scene = test_viewer.built()

def memory():
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

def once():
    viewer = rc.viewer.open(scene, width=128, height=96, on_screen=False)
    viewer.show()
    viewer.close()

def grown_by_ten():
    before = memory()
    for _ in range(10):
        once()
    return memory() - before

for _ in range(5):  # OpenGL keeps what the first windows took
    once()
# Threads of OpenGL take memory when they first wait for one another: once, and not for each window.
print(min(grown_by_ten() for _ in range(3)))
"""


@pytest.mark.proof
def test_viewers_come_and_go_without_leaks():
    done = subprocess.run(
        [sys.executable, "-c", COME_AND_GO],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[-1]) < 10 * 1e6, "a window has 6 MB of panels alone"


def test_the_guides_names(scene: rc.Scene):
    viewer = mjk.SimulateViewer(in_memory(scene))
    assert viewer.is_running()
    assert viewer.use_camera("side")
    assert not viewer.use_camera("none")
    assert viewer.use_camera("")
    viewer.realtime_factor = 0.0
    viewer.add_trace_segment([0, 0, 0], [0, 0, 1])
    viewer.clear_trace()
    viewer.set_free_camera(2.5, 135.0, -20.0, (0.0, 0.0, 0.7))
    assert viewer.step()
    assert viewer.step_n(3)
    assert scene.time() == pytest.approx(0.008)
    viewer.close()
    assert not viewer.step()
    assert scene.step()


def test_without_a_display_the_error_says_what_to_do(tmp_path: Path):
    program = "import robocell as rc, test_viewer\nrc.viewer.open(test_viewer.built())"
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**environment(), "DISPLAY": "", "WAYLAND_DISPLAY": ""},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 1
    assert "viewer: no window" in done.stderr
    assert "xvfb-run -a python program.py" in done.stderr


def environment() -> dict[str, str]:
    import os

    here = str(Path(__file__).parent)
    return os.environ | {"PYTHONPATH": os.pathsep.join([here, os.environ.get("PYTHONPATH", "")])}


# --- at a display --------------------------------------------------------------------------------

START = """
import sys
import numpy as np
import robocell as rc
from test_viewer import built
scene = built()
robot = scene.robot("arm")
viewer = rc.viewer.open(robot, "arm window", 800, 600)
viewer.set_free_camera(1.2, 90, -30, [0.6, 0.2, 0.03])
"""


@pytest.fixture(scope="module")
def display() -> Iterator[Display]:
    with virtual_display() as display:
        display.environment |= {"PYTHONPATH": environment()["PYTHONPATH"]}
        yield display


def test_a_user_pauses_and_closes_the_window(display: Display, tmp_path: Path):
    program = (
        START
        + """
print("ready", flush=True)
while viewer.step():
    robot.update()
    if viewer.paused:
        print("paused", flush=True)
        viewer.paused = False
print("closed", bool(robot.step()), bool(scene.step().stopped), flush=True)
viewer.close()
print("goes on", bool(robot.step()), flush=True)
"""
    )
    with display.start(program, tmp_path) as running:
        assert running.stdout
        assert running.stdout.readline() == "ready\n"
        display.window("arm window")
        display.xdotool("key", "space")
        assert running.stdout.readline() == "paused\n"
        display.xdotool("key", "ctrl+q")
        rest = [line for line in running.stdout if line != "paused\n"]
        assert rest == ["closed False True\n", "goes on True\n"]
        assert running.wait() == 0


def test_a_user_clicks_drags_and_looks(display: Display, tmp_path: Path):
    program = (
        START
        + """
viewer.show()
x, y = viewer.place_of("View", "Contacts")
print(round(x), 600 - round(y), flush=True)
while not viewer.contacts:
    viewer.step()
before = scene.body_pose("cube").translation
print("contacts", flush=True)
while not viewer.selected:
    viewer.step()
print(viewer.selected, flush=True)
highest = 0
while highest < 0.045:  # it rests at 0.03
    viewer.step()
    highest = max(highest, scene.body_pose("cube").translation[2])
print("lifted", flush=True)
viewer.save_screenshot("window.png")
while viewer.step():
    pass
"""
    )
    with display.start(program, tmp_path) as running:
        assert running.stdout
        x, y = map(int, running.stdout.readline().split())
        window = display.window("arm window")
        display.xdotool("mousemove", "--window", window, x, y, "click", 1)
        assert running.stdout.readline() == "contacts\n"
        display.xdotool("mousemove", "--window", window, 410, 300)
        display.xdotool("click", "--repeat", 2, "--delay", 60, 1)
        assert running.stdout.readline() == "cube\n"
        display.xdotool("keydown", "ctrl", "mousedown", 3)
        for up in range(1, 12):
            display.xdotool("mousemove", "--window", window, 410, 300 - 15 * up)
        assert running.stdout.readline() == "lifted\n"
        display.xdotool("mouseup", 3, "keyup", "ctrl", "key", "ctrl+q")
        assert running.wait() == 0
    from PIL import Image

    with Image.open(tmp_path / "window.png") as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    assert pixels.shape == (600, 800, 3)
    red, green, blue = np.moveaxis(pixels[:, 250:550], -1, 0)
    assert np.count_nonzero((red > 120) & (red > 1.5 * green) & (green > 1.2 * blue)) > 100, (
        "the cube"
    )


def test_a_user_records_a_video(display: Display, tmp_path: Path):
    """The recorder draws with a context of its own, beside that of the window."""
    program = (
        START
        + """
viewer.realtime_factor = 0
viewer.show_panels("Recorder", "")
viewer.show()
for item in ("Start", "Stop"):
    x, y = viewer.place_of("Recorder", item)
    print(round(x), 600 - round(y), flush=True)
while not viewer.recording:
    viewer.step()
print("recording", flush=True)
for _ in range(200):
    viewer.step()
print(viewer.pixels().std() > 1, flush=True)
while viewer.recording:
    viewer.step()
print("saved", flush=True)
while viewer.step():
    pass
"""
    )
    with display.start(program, tmp_path) as running:
        assert running.stdout
        places = [tuple(map(int, running.stdout.readline().split())) for _ in range(2)]
        window = display.window("arm window")
        display.xdotool("mousemove", "--window", window, *places[0], "click", 1)
        assert running.stdout.readline() == "recording\n"
        assert running.stdout.readline() == "True\n"
        display.xdotool("mousemove", "--window", window, *places[1], "click", 1)
        assert running.stdout.readline() == "saved\n"
        display.xdotool("key", "ctrl+q")
        assert running.wait() == 0
    assert (tmp_path / "recording.mp4").stat().st_size > 1000


@pytest.mark.parametrize("times", [2, pytest.param(100, marks=pytest.mark.proof)])
def test_windows_open_and_close_again_and_again(display: Display, tmp_path: Path, times: int):
    program = (
        START
        + f"times = {times}"
        + """
viewer.close()
def memory():
    return int(open("/proc/self/statm").read().split()[1]) * 4096
for i in range(times):
    if i == min(4, times - 1):
        before = memory()
    viewer = rc.viewer.open(scene, "again", 64, 64)
    assert viewer.show()
    viewer.close()
    assert scene.step()
assert memory() - before < 60e6, memory() - before
renderer = rc.render.Renderer(scene)  # off-screen drawing beside a window, in the same thread
viewer = rc.viewer.open(scene, "again", 64, 64)
assert renderer.render("side", 32, 24)["rgb"].std() > 1
assert viewer.step()
assert renderer.render("side", 32, 24)["rgb"].std() > 1
print("done", flush=True)
"""
    )
    with display.start(program, tmp_path) as running:
        assert running.stdout
        assert list(running.stdout) == ["done\n"]
        assert running.wait() == 0
