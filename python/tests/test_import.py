"""Importing robocell does no work, and says what there is."""

import subprocess
import sys

import pytest

import robocell as rc


def run(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)


def test_importing_loads_neither_mujoco_nor_gl_nor_numpy():
    result = run(
        "import sys, robocell; "
        "bad = {'mujoco', 'numpy', 'gymnasium', 'yaml', 'OpenGL', 'h5py'} & set(sys.modules); "
        "maps = open('/proc/self/maps').read(); "
        "bad |= {lib for lib in ('libEGL', 'libOSMesa', 'libGL.so') if lib in maps}; "
        "sys.exit(str(bad) if bad else 0)"
    )
    assert result.returncode == 0, result.stderr


def test_the_command_line_loads_neither_mujoco_nor_numpy():
    """They take longer than the rest; the commands that need them load them."""
    result = run(
        "import sys, robocell._cli; "
        "robocell._cli.load([]); "
        "bad = {'mujoco', 'numpy', 'h5py', 'matplotlib', 'plotly', 'PIL'} & set(sys.modules); "
        "sys.exit(str(bad) if bad else 0)"
    )
    assert result.returncode == 0, result.stderr


def test_loading_a_command_loads_no_other_command():
    result = run(
        "import sys, robocell._cli; "
        "robocell._cli.load(['gripper-range', 'robot.yaml']); "
        "print(*(name for name in robocell._cli.COMMANDS"
        " if 'robocell._cli.' + name.replace('-', '_') in sys.modules))"
    )
    assert result.stdout == "gripper-range\n", result.stderr


def test_importing_opens_no_data_file():
    result = run(
        "import sys, os; opened = []; "
        "sys.addaudithook(lambda e, a: opened.append(str(a[0])) if e == 'open' else None); "
        "import robocell; "
        "bad = [f for f in opened if f.endswith(('.xml', '.yaml', '.json', '.h5'))]; "
        "sys.exit(str(bad) if bad else 0)"
    )
    assert result.returncode == 0, result.stderr


def test_importing_connects_to_nothing():
    result = run(
        "import sys; bad = []; "
        "sys.addaudithook(lambda e, a: bad.append(e) if e.startswith('socket.') else None); "
        "import robocell; sys.exit(str(bad) if bad else 0)"
    )
    assert result.returncode == 0, result.stderr


def test_all_public_names_exist_and_are_documented():
    for name in rc.__all__:
        value = getattr(rc, name)
        if isinstance(value, type) or callable(value):
            assert value.__doc__, name


def test_no_object_survives_at_exit():
    """nanobind reports leaked objects on stderr."""
    result = run(
        "import robocell as rc\n"
        "class Arm(rc.RobotSpec): pass\n"
        "spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True)\n"
        "spec.robots = [Arm(path='a.xml')]\n"
        "spec.robots[0].spec = spec\n"
        "robots = spec.robots\n"
        "view = spec.gravity\n"
        "del spec.robots[0]\n"
        "scene = rc.Scene.build(spec)\n"
        "scene.on_reset(lambda ctx: scene.time())\n"
        "kept = []\n"
        "scene.on_reset(kept.append)\n"
        "scene.reset()\n"
        "data, model = scene.data, scene.model\n"
    )
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""


CLOCK = """
import mujoco, sys
{before}
import robocell as rc
config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
spec.robots.append(rc.RobotSpec(config=config))
scene = rc.Scene.build(spec)
scene.step_n(10)
times = scene.data.timer.duration
sys.exit(0 if (times[mujoco.mjtTimer.mjTIMER_STEP] > 0) == {expected} else str(times))
"""


@pytest.mark.parametrize(
    ("before", "asked", "expected"),
    [
        ("", None, False),
        ("", "1", True),
        ("", "0", False),
        ("", "", False),
        ("import time; mujoco.set_mjcb_time(time.perf_counter)", None, True),
    ],
    ids=["by default", "when asked to", "not with 0", "nor with ''", "by a clock that was set"],
)
def test_the_engine_reads_the_clock(before, asked, expected, monkeypatch):
    monkeypatch.delenv("ROBOCELL_ENGINE_TIMERS", raising=False)
    if asked is not None:
        monkeypatch.setenv("ROBOCELL_ENGINE_TIMERS", asked)
    result = run(CLOCK.format(before=before, expected=expected))
    assert result.returncode == 0, result.stderr
