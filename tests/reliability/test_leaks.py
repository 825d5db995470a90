"""Descriptors, child processes, OpenGL contexts, memory stay flat; at the end nothing is left."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import figures
import leaks
import pytest
from processes import bare_environment

# How many of each are made, and how many bytes of each may stay. A forgotten scene is 200 kB, a
# context several MB; of few objects, what the pools hold counts for more.
FEW = {"scenes": 80, "resets": 200, "contexts": 8, "children": 8, "errors": 40, "batches": 12}
SHORT = {"heap_each": 10_000, "resident_each": 60_000}
LONG = {"heap_each": 1_000, "resident_each": 5_000}


def grow(kind: str, times: int) -> dict[str, int]:
    """Returns what stays behind when `times` objects of a kind were made."""
    done = subprocess.run(
        [sys.executable, leaks.__file__, kind, str(times)],
        env=bare_environment(),
        capture_output=True,
        text=True,
        timeout=1800,
    )
    assert done.returncode == 0, done.stderr
    assert "leaked" not in done.stderr, "nanobind reports what Python does not let go"
    result: dict[str, int] = json.loads(done.stdout)
    return result


def require_flat(kind: str, times: int, most: dict[str, int]) -> dict[str, int]:
    """Nothing stays but what memory pools keep; what does."""
    grown = grow(kind, times)
    assert grown["times"] >= times - leaks.ROUNDS
    assert (grown["files"], grown["threads"], grown["children"]) == (0, 0, 0)
    for memory, limit in most.items():
        assert grown[memory] < limit, memory
    return grown


@pytest.mark.parametrize("kind", leaks.KINDS)
def test_a_few_of_each_leak_nothing(kind: str):
    require_flat(kind, FEW[kind], SHORT)


@pytest.mark.soak
@pytest.mark.parametrize("kind", leaks.KINDS)
def test_a_thousand_of_each_leak_nothing(kind: str):
    figures.note("things", kind=kind, **require_flat(kind, 1000, LONG))


LEAKING = """
import json, os, sys
sys.path.insert(0, {folder!r})
import leaks, robocell
kept = []
def keep(_folder):
    def work():
        kept.append((open(os.devnull), leaks.cell(), bytearray(os.urandom(100_000))))
    return work
leaks.KINDS["kept"] = keep
print(json.dumps(leaks.growth("kept", 24)))
"""


def test_the_measurement_detects_a_leak(tmp_path: Path):
    folder = str(Path(leaks.__file__).parent)
    done = subprocess.run(
        [sys.executable, "-c", LEAKING.format(folder=folder)],
        env=bare_environment(),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    grown = json.loads(done.stdout)
    assert grown["files"] == 24
    assert grown["heap_each"] > SHORT["heap_each"]
    assert grown["resident_each"] > LONG["resident_each"]


ENDINGS = {
    "renderers and videos": """
scene = leaks.cell()
renderer = rc.render.Renderer(scene)
image = renderer.render(rc.render.OrbitCamera(), 32, 24)
recorder = rc.render.VideoRecorder(scene, "unfinished.mp4", 32, 24, 30)
recorder.record_frame()
""",
    "steppers and controllers": """
scene = leaks.cell()
robot = scene.robot("a")
stepper = rc.control.Stepper(scene, [robot], 2, 1)
outcome = stepper.advance({"a": {"gripper": rc.control.GroupCommand.opening(0)}})
port, group, kinematics = robot.jnt_pos_cmd, robot.arm, robot.kinematics
""",
    "groups of one's own": """
class Lamp(rc.robots.MoveGroup):
    def get_name(self): return "lamp"
    def get_joint_names(self): return []
    def get_actuator_names(self): return []
    def get_joint_pos(self): return []
    def get_joint_vel(self): return []
    def get_joint_torque(self): return []
    def get_ctrl(self): return []
    def scene(self): return scene
class Hand(rc.robots.GripperGroup):
    get_name = lambda self: "hand"
    get_joint_names = get_actuator_names = get_joint_pos = lambda self: []
    get_joint_vel = get_joint_torque = get_ctrl = lambda self: []
scene = leaks.cell()
robot = scene.robot("a")
robot.set_group(Lamp())
robot.set_group(Hand())
lamp, again = robot.group("lamp"), scene.robot("a")
stepper = rc.control.Stepper(scene, [robot], 2, 1)
""",
    "groups that hold their robot": """
class Holder(rc.robots.MoveGroup):
    def __init__(self, robot):
        super().__init__()
        self.robot = robot
    get_name = lambda self: "holder"
    get_joint_names = get_actuator_names = get_joint_pos = lambda self: []
    get_joint_vel = get_joint_torque = get_ctrl = lambda self: []
def work():
    scene = leaks.cell()
    robot = scene.robot("a")
    robot.set_group(Holder(robot))
work()
""",
    "tasks and experts of one's own": """
class Mine(rc.tasks.Task):
    def begin(self, scene): self.scene = scene
    def reward(self, scene): return 0.0
    def success(self, scene): return False
    def instruction(self): return ""
    def objects(self): return []
class Idle(rc.tasks.Expert):
    pass
scene = leaks.cell()
task = Mine()
task.begin(scene)
start = rc.tasks.EpisodeStart(scene, task)
run = rc.RunConfig.load(leaks.DEMO)
planner, other = rc.tasks.PickPlanner(run, start), rc.tasks.EpisodeStart(scene, start.task)
runner = rc.generate.Runner(run, expert=lambda run, start: Idle())
""",
    "environments with a task of one's own": """
from robocell.gym import GymEnv, VectorGymEnv, pick_cube_config
class Wait(rc.tasks.Task):
    def bind(self, scene, setting):
        self.scene = scene
    def reward(self, scene): return 0.0
    def success(self, scene): return False
    def instruction(self): return "wait"
rc.register_task("wait")(Wait)
waiting = pick_cube_config(task={"kind": "wait"}, root_frame_objects={})
env, vector = GymEnv(waiting), VectorGymEnv(waiting, 2, threads=2)
env.reset(seed=1)
vector.reset(seed=1)
env.core.save("here")
""",
    "runs with a task and a sampler of one's own": """
class Wait(rc.tasks.Task):
    def prepare(self, spec, rng):
        ball = rc.SceneObject(name="ball", shape=rc.Shape.SPHERE, size=[.03, 0, 0], mass=.05)
        ball.rgba, ball.friction = [1, .5, 0, 1], [1, .02, .001]
        spec.objects.append(ball)
    def judge(self, scene): return rc.tasks.TaskVerdict()
    def instruction(self): return "wait"
    def objects(self): return ["ball"]
class Mine(rc.tasks.StartSampler):
    pass
rc.register_task("wait")(Wait)
rc.tasks.register_sampler("mine")(Mine)
run = rc.RunConfig.load(leaks.DEMO, ["cameras.streams=[]"])
mine = rc.RunConfig.load(leaks.DEMO, ["cameras.streams=[]", "sampler=mine"])
waiting = rc.RunConfig.load(leaks.DEMO, ["cameras.streams=[]", "task={kind: wait}"])
picking, env = rc.envs.RunEnv(mine), rc.envs.RunEnv(waiting)
picking.reset(0)
env.reset(0)
env.reset(1)
row, scene = env.row(), env.scene
""",
    "filters, samplers and solutions": """
scene = leaks.cell()
robot = scene.robot("a")
free = rc.kinematics.CollisionFilter(robot)
found = robot.kinematics.ik(robot.fk_frame(), filter=lambda q: free(q))
class Mine(rc.tasks.StartSampler):
    def make_task(self):
        return super().make_task()
run = rc.RunConfig.load(leaks.DEMO)
sampler = Mine(run)
start = sampler.sample(rc.tasks.SampleRequest(), rc.tasks.Rng.stream(1, "test"))
scene.on_reset(lambda context: (robot, free, sampler))
""",
    "exceptions": """
try:
    leaks.cell().robot("b")
except rc.NotFoundError as error:
    kept = error
sys.exit(0)
""",
    "threads": """
import threading
scene = leaks.cell()
threads = [threading.Thread(target=leaks.cell) for _ in range(2)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
""",
}


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_script_that_exits_with_live_objects_reports_no_leaks(tmp_path: Path, ending: str):
    script = tmp_path / "script.py"
    script.write_text(f"import sys\nimport leaks\nimport robocell as rc\n{ENDINGS[ending]}")
    done = subprocess.run(
        [sys.executable, script],
        env=bare_environment(),
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (0, "")
