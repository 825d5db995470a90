"""The code of the guide of mj_kdl_wrapper 0.2.2, block by block, and what each block needs.

The only change is the import's module.
"""

IMPORT = "import robocell.compat.mj_kdl_wrapper as mjk\n"

WITH_GRIPPER = """
gripper = mjk.AttachmentSpec()
gripper.mjcf_path = "assets/robotiq_2f85/2f85.xml"
gripper.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "pinch_site")
gripper.prefix = "g_"
robot_spec = mjk.RobotSpec()
robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
robot_spec.attachments = [gripper]
"""
EMPTY = """
spec = mjk.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True)
"""
BUILT = "spec.robots = [robot_spec]\nscene = mjk.Scene.build(spec)\n"
GRIPPER_SCENE = EMPTY + WITH_GRIPPER + BUILT
ROBOT = GRIPPER_SCENE + 'robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link")\n'
CUBE = """
cube = mjk.SceneObject()
cube.name = "red_cube"
cube.shape = mjk.Shape.BOX
cube.size = [0.03, 0.03, 0.03]
cube.pos = [0.35, 0.10, 0.73]
cube.rgba = [1.0, 0.0, 0.0, 1.0]
cube.mass = 0.1
cube.condim = mjk.Condim.Torsional
cube.friction = [0.8, 0.02, 0.001]
"""
# A robot beside the arm whose actuator is called as the guide's.
FINGER = """
import pathlib
pathlib.Path("finger.xml").write_text('''<mujoco><worldbody><body name="knuckle" pos="1 1 1">
<joint name="bend" range="0 1"/><geom size="0.01" mass="0.1"/></body></worldbody>
<actuator><position name="ger" joint="bend" ctrlrange="0 1"/></actuator></mujoco>''')
finger = mjk.RobotSpec(path="finger.xml", prefix="fin")
"""
WITH_FINGER_AND_CUBE = (
    EMPTY + WITH_GRIPPER + FINGER + CUBE + "spec.robots = [robot_spec, finger]\n"
    "spec.objects = [cube]\n"
)
# Ends the loop that runs until a viewer is closed.
STOPS = """
class Stops:
    def __init__(self, robot):
        self.__dict__.update(robot=robot, left=50)
    def __getattr__(self, name):
        return getattr(self.robot, name)
    def __setattr__(self, name, value):
        setattr(self.robot, name, value)
    def step(self):
        self.__dict__["left"] -= 1
        return self.robot.step() and self.left > 0
robot = Stops(robot)
"""

# The windows are in memory, and each is closed at its first picture.
IN_MEMORY = """
import types
from robocell.viewer import Viewer
class SimulateViewer(mjk.SimulateViewer):
    @classmethod
    def open(cls, target, title="MuJoCo"):
        viewer = Viewer.open(target, title, 160, 120, on_screen=False)
        viewer.post("close")
        return cls(viewer)
mjk = types.SimpleNamespace(**vars(mjk) | {"SimulateViewer": SimulateViewer})
"""

LOAD = """\
spec = mjk.SceneSpec()
spec.timestep = 0.002
spec.add_floor = True
spec.add_skybox = True
robot_spec = mjk.RobotSpec()
robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
spec.robots = [robot_spec]
scene = mjk.Scene.build(spec)
"""

# Section -> (what comes before, the guide's code), in its order.
BLOCKS = {
    "load": ("", LOAD),
    "load an object": (
        LOAD,
        """\
cabinet = mjk.SceneObject()
cabinet.name = "cabinet"
cabinet.mjcf_path = mjk.menagerie.asset_path("cabinet/cabinet.xml")
cabinet.fixed = True
spec.objects = [cabinet]
scene = mjk.Scene.build(spec)
""",
    ),
    "step and save": (
        LOAD,
        """\
scene.step_n(10)
print(scene.time(), scene.timestep())
scene.save_xml("combined_scene.xml")
scene.save_binary("combined_scene.mjb")
""",
    ),
    "log": (
        "",
        """\
mjk.set_log_level(mjk.LogLevel.INFO)
assert mjk.get_log_level() == mjk.LogLevel.INFO
print(mjk.mujoco_version())
""",
    ),
    "chain": (
        LOAD,
        """\
robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link")
robot.ctrl_mode = mjk.CtrlMode.POSITION
robot.jnt_pos_cmd = [0.0] * robot.n_joints
robot.update()
robot.step()
""",
    ),
    "tool": (
        GRIPPER_SCENE,
        """\
tool = mjk.ToolFrameSpec()
tool.tool_body = "g_base"
tool.tcp_site = "g_pinch"
robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link", tool=tool)
assert robot.has_tcp_frame
""",
    ),
    "force-torque sensor": (
        "",
        """\
ft_sensor = mjk.AttachmentSpec()
ft_sensor.mjcf_path = mjk.menagerie.asset_path("ft_sensor.xml")
ft_sensor.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "pinch_site")
gripper = mjk.AttachmentSpec()
gripper.mjcf_path = mjk.menagerie.asset_path("robotiq_2f85/2f85.xml")
gripper.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "wrist_ft_site")
gripper.prefix = "g_"
robot_spec = mjk.RobotSpec()
robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
robot_spec.attachments = [ft_sensor, gripper]
""",
    ),
    "wrench": (
        "block:force-torque sensor;" + EMPTY + BUILT + "tool = mjk.ToolFrameSpec()\n",
        """\
ft = mjk.ForceTorqueSensorSpec()
ft.name = "wrist_ft" # resolves wrist_ft_force + wrist_ft_torque
ft.frame_site = "wrist_ft_site"
tool.ft_sensors = [ft]
robot = mjk.Robot.from_scene(scene, "base_link", "bracelet_link", tool=tool)
robot.update()
wrench = robot.ft_sensor("wrist_ft")
""",
    ),
    "attach": (
        "",
        """\
gripper = mjk.AttachmentSpec()
gripper.mjcf_path = "assets/robotiq_2f85/2f85.xml"
gripper.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, "pinch_site")
gripper.prefix = "g_"
robot_spec = mjk.RobotSpec()
robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
robot_spec.attachments = [gripper]
""",
    ),
    "offset": (
        WITH_GRIPPER,
        """\
gripper.pos[2] = 0.005
gripper.euler[2] = 15.0
""",
    ),
    "two robots": (
        EMPTY,
        """\
left = mjk.RobotSpec()
left.path = mjk.menagerie.model_path("kinova_gen3")
left.pos = [-0.5, 0.0, 0.0]
right = mjk.RobotSpec()
right.path = mjk.menagerie.model_path("kinova_gen3")
right.prefix = "r2_"
right.pos = [0.5, 0.0, 0.0]
spec.robots = [left, right]
scene = mjk.Scene.build(spec)
robot1 = mjk.Robot.from_scene(scene, "base_link", "bracelet_link")
robot2 = mjk.Robot.from_scene(scene, "base_link", "bracelet_link", prefix="r2_")
""",
    ),
    "table": (
        EMPTY,
        """\
table = mjk.SceneObject()
table.name = "table"
table.mjcf_path = "assets/table.xml"
table.pos = [0.0, 0.0, 0.7]
table.fixed = True
mount = mjk.scene_object_site_name(table, "table_top")
robot_spec = mjk.RobotSpec()
robot_spec.path = mjk.menagerie.model_path("kinova_gen3")
robot_spec.attach_to = mjk.AttachTarget(mjk.AttachKind.Site, mount)
cube = mjk.SceneObject()
cube.name = "red_cube"
cube.shape = mjk.Shape.BOX
cube.size = [0.03, 0.03, 0.03]
cube.pos = [0.35, 0.10, 0.73]
cube.rgba = [1.0, 0.0, 0.0, 1.0]
cube.mass = 0.1
cube.condim = mjk.Condim.Torsional
cube.friction = [0.8, 0.02, 0.001]
spec.objects = [table, cube]
spec.robots = [robot_spec]
scene = mjk.Scene.build(spec)
""",
    ),
    "cameras": (
        EMPTY + WITH_GRIPPER + "spec.robots = [robot_spec]\n",
        """\
cam = mjk.CameraSpec()
cam.name = "overview"
cam.pos = [1.8, -2.0, 1.4]
cam.fovy = 45.0
spec.cameras = [cam]
scene = mjk.Scene.build(spec)
print(scene.camera_names())
""",
    ),
    "poses": (
        WITH_FINGER_AND_CUBE + "scene = mjk.Scene.build(spec)\n",
        """\
tcp = scene.site_frame("g_pinch")
scene.set_body_pose("red_cube", [0.45, 0.0, 0.75], [0.0, 0.0, 0.0, 1.0])
""",
    ),
    "actuators": (
        WITH_FINGER_AND_CUBE + "scene = mjk.Scene.build(spec)\n",
        """\
if scene.has_actuator("finger"):
    scene.set_actuator_ctrl("finger", 0.25)
    print(scene.actuator_ctrl("finger"))
""",
    ),
    "PyKDL": (
        ROBOT,
        """\
import PyKDL as kdl
chain = robot.kdl_chain()
fk = kdl.ChainFkSolverPos_recursive(chain)
q = kdl.JntArray(robot.n_joints)
for i, value in enumerate(robot.jnt_pos_msr):
    q[i] = value
tcp = kdl.Frame()
fk.JntToCart(q, tcp)
""",
    ),
    "control loop": (
        ROBOT + STOPS,
        """\
robot.ctrl_mode = mjk.CtrlMode.TORQUE
while robot.step():
    robot.update()
    robot.jnt_trq_cmd = robot.gravity_torques()
""",
    ),
    "joint state": (
        ROBOT,
        """\
robot.set_joint_pos([0.0] * robot.n_joints)
print(robot.fk_frame())
""",
    ),
    "reset": (
        WITH_FINGER_AND_CUBE,
        """\
env = mjk.Env.build(spec)
robot = env.create_robot("base_link", "bracelet_link")
def on_reset(ctx: mjk.ResetContext) -> None:
    robot.set_joint_pos([0.0] * robot.n_joints, call_forward=False)
env.on_reset = on_reset
opts = mjk.ResetOptions()
opts.keyframe = 0
info = env.reset(opts)
""",
    ),
    "env": (
        WITH_FINGER_AND_CUBE + "env = mjk.Env.build(spec)\n",
        """\
env.set_actuator_ctrl("finger", 0.25)
frame = env.body_frame("red_cube")
env.save_xml("episode_start.xml")
""",
    ),
    "add and remove": (
        ROBOT,
        """\
cube = mjk.SceneObject()
cube.name = "cube"
cube.shape = mjk.Shape.BOX
cube.size = [0.02, 0.02, 0.02]
cube.pos = [0.4, 0.0, 0.02]
cube.rgba = [1.0, 0.5, 0.0, 1.0]
cube.mass = 0.1
cube.friction = [0.8, 0.02, 0.001]
scene.add_object(cube)
robot.update()
scene.remove_object("cube")
""",
    ),
    "video": (
        # Five frames are enough.
        ROBOT + "import builtins\nrange = lambda n: builtins.range(min(n, 5))\n",
        """\
recorder = mjk.VideoRecorder.open_preset(
    scene,
    "sim.mp4",
    mjk.VideoResolution.R720p,
    fps=60,
)
recorder.set_free_camera(2.5, 135.0, -20.0, (0.0, 0.0, 0.7))
for _ in range(3000):
    robot.update()
    robot.step()
    recorder.record_frame()
recorder.close()
""",
    ),
    "viewer": (
        ROBOT + IN_MEMORY,
        """\
viewer = mjk.SimulateViewer.open(robot, "MuJoCo")
while viewer.step():
    robot.update()
viewer.close()
viewer = mjk.SimulateViewer.open(scene, "object scene")
while viewer.step():
    pass
viewer.close()
""",
    ),
}
