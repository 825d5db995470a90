"""Chains of robots: tool frame, gravity, dynamics, and everything of it to and from PyKDL."""

import gc

import mujoco
import numpy as np
import pytest

import robocell as rc
from test_kdl_chain import PyKDL, needs_pykdl, random_positions, to_kdl

MOUNTS = {"upright": [0, 0, 0], "tilted": [20, -35, 110], "ceiling": [180, 0, 30]}


@pytest.fixture(scope="module", params=MOUNTS.values(), ids=MOUNTS.keys())
def gen3(request: pytest.FixtureRequest) -> rc.Scene:
    """The Gen3 with the 2F-85 on a mount, without a configuration."""
    from menagerie import require_menagerie

    require_menagerie()
    arm = rc.RobotSpec(path=rc.menagerie.model_path("kinova_gen3"), pos=[0, 0, 2])
    arm.euler = request.param
    arm.attachments.append(
        rc.robots.AttachmentSpec(
            mjcf_path=rc.menagerie.model_path("robotiq_2f85"),
            attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Site, "pinch_site"),
            prefix="g_",
        )
    )
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False, robots=[arm])
    return rc.Scene.build(spec)


@pytest.fixture
def robot(gen3: rc.Scene) -> rc.Robot:
    gen3.reset()
    tool = rc.robots.ToolFrameSpec(tool_body="g_base", tcp_site="g_pinch")
    return rc.Robot.from_scene(gen3, "base_link", "bracelet_link", tool=tool)


def dofs(robot: rc.Robot) -> list[int]:
    """Where the arm's joints are in the engine's vectors."""
    return [robot.scene.model.joint(name).dofadr[0] for name in robot.joint_names]


def test_joints_are_in_chain_order_with_their_limits(robot: rc.Robot):
    assert robot.n_joints == 7
    assert robot.joint_names == [f"joint_{i}" for i in range(1, 8)]
    assert robot.joint_limits.shape == (7, 2)
    assert robot.joint_limits[1].tolist() == [-2.24, 2.24]
    assert np.isinf(robot.joint_limits[0]).all()


def test_ports_reject_wrong_lengths_and_closed_scenes():
    from test_robot import cell

    robot = cell().robot("a")
    with pytest.raises(ValueError, match="expected 7 joint values, got 3"):
        robot.jnt_pos_cmd = [0.0] * 3
    robot.scene.close()
    with pytest.raises(RuntimeError, match="robot 'a' is closed"):
        robot.update()


def test_the_tools_site_is_the_tcp(robot: rc.Robot):
    scene = robot.scene
    assert robot.has_tcp_frame
    assert robot.tcp_site == "g_pinch"
    in_base = scene.body_pose("base_link").inverse() * scene.site_pose("g_pinch")
    assert robot.fk_frame().is_close(in_base, 1e-9, 1e-9)
    in_tip = scene.body_pose("bracelet_link").inverse() * scene.site_pose("g_pinch")
    assert robot.tip_to_tcp.is_close(in_tip, 1e-9, 1e-9)
    bare = rc.Robot.from_scene(scene, "base_link", "bracelet_link")
    assert (bare.has_tcp_frame, bare.tcp_site) == (False, "")


def test_the_chain_weighs_arm_and_tool(robot: rc.Robot):
    moving = robot.scene.model.body("shoulder_link").subtreemass[0]
    assert robot.chain.moving_mass == pytest.approx(moving, abs=1e-12)
    assert robot.scene.model.body("g_base_mount").subtreemass[0] > 0.8


def test_gravity_torques_match_the_engine_at_rest(robot: rc.Robot):
    for q in random_positions(robot, 20):
        robot.set_joint_pos(q)
        needed = robot.scene.data.qfrc_bias[dofs(robot)]
        np.testing.assert_allclose(robot.gravity_torques(), needed, atol=1e-6)
        in_base = robot.chain.gravity_torques(q, robot.gravity_in_base())
        np.testing.assert_allclose(in_base, needed, atol=1e-6)
    half = robot.gravity_torques(gravity_z=-9.81 / 2)
    np.testing.assert_allclose(half, robot.gravity_torques() / 2, atol=1e-9)


def test_refreshing_tool_inertia_includes_a_closed_gripper(robot: rc.Robot):
    scene = robot.scene
    robot.set_joint_pos([0.3, 0.8, -0.5, 1.2, 0.2, 1.1, 0.4])
    scene.set_actuator_ctrl("g_fingers_actuator", 255)
    assert scene.step_n(500)
    scene.data.qvel[:] = 0
    scene.forward()
    needed = scene.data.qfrc_bias[dofs(robot)]
    assert 1e-4 < np.abs(robot.gravity_torques() - needed).max() < 5e-2
    robot.refresh_tool_inertia()
    np.testing.assert_allclose(robot.gravity_torques(), needed, atol=1e-6)


def test_dynamics_are_those_of_the_engine(robot: rc.Robot):
    scene, chain, at = robot.scene, robot.chain, dofs(robot)
    rng = np.random.default_rng(3)
    full = np.zeros((scene.model.nv, scene.model.nv))
    for q in random_positions(robot, 10):
        robot.set_joint_pos(q)
        mujoco.mj_fullM(scene.model, scene.data, full)
        np.testing.assert_allclose(chain.mass_matrix(q), full[np.ix_(at, at)], atol=1e-9)
        gravity = scene.data.qfrc_bias[at].copy()
        qd, qdd = rng.normal(size=(2, 7))
        scene.data.qvel[at] = qd
        scene.forward()
        moving = scene.data.qfrc_bias[at]
        np.testing.assert_allclose(chain.coriolis_torques(q, qd), moving - gravity, atol=1e-6)
        needed = full[np.ix_(at, at)] @ qdd + moving
        torques = chain.inverse_dynamics(q, qd, qdd, robot.gravity_in_base())
        np.testing.assert_allclose(torques, needed, atol=1e-6)
        scene.data.qvel[:] = 0


@needs_pykdl
def test_dynamics_are_those_of_kdl(robot: rc.Robot):
    chain, kdl = robot.chain, robot.kdl_chain()
    gravity = robot.gravity_in_base()
    solver = PyKDL.ChainDynParam(kdl, PyKDL.Vector(*gravity))
    for q in random_positions(robot, 10):
        qd = np.cos(q)
        mass, coriolis = PyKDL.JntSpaceInertiaMatrix(7), PyKDL.JntArray(7)
        solver.JntToMass(to_kdl(q), mass)
        solver.JntToCoriolis(to_kdl(q), to_kdl(qd), coriolis)
        theirs = [[mass[r, c] for c in range(7)] for r in range(7)]
        np.testing.assert_allclose(chain.mass_matrix(q), theirs, atol=1e-9)
        theirs = [coriolis[i] for i in range(7)]
        np.testing.assert_allclose(chain.coriolis_torques(q, qd), theirs, atol=1e-8)


@needs_pykdl
def test_gravity_torques_are_kdls(gen3: rc.Scene, robot: rc.Robot):
    robot.set_joint_pos([0.3, 0.8, -0.5, 1.2, 0.2, 1.1, 0.4])
    upright = robot.base_in_world.rotation[2, 2] > 0.999
    gravity = PyKDL.Vector(0, 0, -9.81) if upright else PyKDL.Vector(*robot.gravity_in_base(-9.81))
    torques = PyKDL.JntArray(7)
    solver = PyKDL.ChainDynParam(robot.kdl_chain(), gravity)
    solver.JntToGravity(to_kdl(robot.arm.joint_pos), torques)
    ours = robot.gravity_torques(gravity_z=-9.81)
    np.testing.assert_allclose(ours, [torques[i] for i in range(7)], atol=1e-9)


@needs_pykdl
def test_chains_outlive_the_solvers_that_do_not_keep_them():
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    scene = rc.Scene.build(spec)
    robot = scene.robot("a")
    q, chain = robot.arm.joint_pos, robot.chain
    solvers = [
        PyKDL.ChainFkSolverPos_recursive(robot.kdl_chain()),
        PyKDL.ChainFkSolverPos_recursive(scene.robot("a").kdl_chain()),
        PyKDL.ChainFkSolverPos_recursive(robot.chain.to_kdl()),
    ]
    assert robot.kdl_chain() is robot.kdl_chain()
    plate = rc.SceneObject(
        name="plate", shape="box", size=[0.02] * 3, rgba=[1, 0, 0, 1], mass=2, fixed=True,
        friction=[0.8, 0.02, 0.001],
        attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Body, "link7"),
    )  # fmt: skip
    bare = robot.kdl_chain()
    scene.add_object(plate)
    assert robot.kdl_chain() is not bare, "it weighs more"
    loaded = robot.kdl_chain()
    scene.add_object(rc.SceneObject(name="cube", shape="box", size=[0.02] * 3, mass=0.1,
        rgba=[1, 0, 0, 1], friction=[0.8, 0.02, 0.001], pos=[0.9, 0.9, 0.02]))  # fmt: skip
    assert robot.kdl_chain() is loaded, "the same arm"
    del bare, loaded
    gc.collect()
    spoil = [PyKDL.Chain() for _ in range(100)]  # where chains that are gone would have been
    for solver in solvers:
        frame = PyKDL.Frame()
        solver.JntToCart(to_kdl(q), frame)
        assert rc.Pose(frame).is_close(chain.fk(q), 1e-9, 1e-9)
    assert len(spoil) == 100
    longer = robot.kdl_chain()
    longer.addSegment(longer.getSegment(0))
    assert robot.kdl_chain() is not longer, "what somebody added to is theirs"


@needs_pykdl
def test_accepts_joint_values_in_every_form(robot: rc.Robot):
    q = [0.3, 0.8, -0.5, 1.2, 0.2, 1.1, 0.4]
    frames = []
    for form in (list(q), tuple(q), np.array(q), to_kdl(np.array(q)), rc.kinematics.jnt_array(q)):
        robot.set_joint_pos(form)
        assert robot.arm.joint_pos.tolist() == q
        robot.jnt_pos_cmd = form
        assert robot.jnt_pos_cmd.tolist() == q
        frames.append(robot.fk_frame(form))
        assert robot.chain.fk(form) == frames[0]
    assert all(frame == frames[0] for frame in frames)
    assert isinstance(rc.kinematics.jnt_array(q), PyKDL.JntArray)


@needs_pykdl
def test_frames_of_kdl_are_targets(robot: rc.Robot):
    target = robot.fk_frame([0.3, 0.8, -0.5, 1.2, 0.2, 1.1, 0.4])
    for found in (robot.ik(target.to_kdl()), robot.chain.ik(target.to_kdl())):
        assert found
        assert robot.fk_frame(found.q).is_close(target, 1.1e-5, 1.1e-5)
    with pytest.raises(TypeError):
        robot.ik("tcp")


def segment(name: str, joint: "PyKDL.Joint", mass: float) -> "PyKDL.Segment":
    tip = PyKDL.Frame(PyKDL.Rotation.RPY(0.1, -0.4, 0.7), PyKDL.Vector(0.1, 0.2, 0.3))
    inertia = PyKDL.RotationalInertia(0.02, 0.03, 0.04, 0.001, 0.002, 0.003)
    return PyKDL.Segment(
        name, joint, tip, PyKDL.RigidBodyInertia(mass, PyKDL.Vector(0.01, -0.02, 0.05), inertia)
    )


@needs_pykdl
def test_a_custom_kdl_chain_has_the_same_kinematics_and_dynamics():
    kdl = PyKDL.Chain()
    kdl.addSegment(segment("foot", PyKDL.Joint(PyKDL.Joint.Fixed), 9))
    kdl.addSegment(segment("a", PyKDL.Joint("turn", PyKDL.Joint.RotX, 1, 0.3), 2))
    at, axis = PyKDL.Vector(0.1, 0, -0.2), PyKDL.Vector(1, 2, -1)
    kdl.addSegment(
        segment("b", PyKDL.Joint("askew", at, axis, PyKDL.Joint.RotAxis, 1, -0.6, 0.25), 0.5)
    )
    kdl.addSegment(segment("c", PyKDL.Joint("slide", PyKDL.Joint.TransY, 1, 0.1, 0.75), 0.4))
    kdl.addSegment(segment("tool", PyKDL.Joint(PyKDL.Joint.Fixed), 0.2))
    chain = rc.kinematics.Chain.from_kdl(kdl, limits=[(-1, 1), (-2, 2), (-0.5, 0.5)])
    assert chain.joint_names == ["turn", "askew", "slide"]
    assert chain.joint_limits.tolist() == [[-1, 1], [-2, 2], [-0.5, 0.5]]
    assert chain.moving_mass == pytest.approx(3.1)
    fk = PyKDL.ChainFkSolverPos_recursive(kdl)
    dynamics = PyKDL.ChainDynParam(kdl, PyKDL.Vector(1, -3, -9))
    for q in np.random.default_rng(1).uniform(-1, 1, (10, 3)):
        tip, mass, torques = PyKDL.Frame(), PyKDL.JntSpaceInertiaMatrix(3), PyKDL.JntArray(3)
        fk.JntToCart(to_kdl(q), tip)
        assert rc.Pose(tip).is_close(chain.fk(q), 1e-7, 1e-9)
        dynamics.JntToMass(to_kdl(q), mass)
        theirs = [[mass[r, c] for c in range(3)] for r in range(3)]
        np.testing.assert_allclose(chain.mass_matrix(q), theirs, atol=1e-9)
        dynamics.JntToGravity(to_kdl(q), torques)
        ours = chain.gravity_torques(q, [1, -3, -9])
        np.testing.assert_allclose(ours, [torques[i] for i in range(3)], atol=1e-9)


@needs_pykdl
def test_a_chain_round_trips_through_kdl():
    from test_robot import cell

    chain = cell().robot("a").chain
    back = rc.kinematics.Chain.from_kdl(chain.to_kdl(), chain.joint_limits)
    assert back.joint_names == chain.joint_names
    q = np.linspace(-0.05, 0.8, 7)
    assert back.fk(q).is_close(chain.fk(q), 1e-7, 1e-12)
    np.testing.assert_allclose(back.mass_matrix(q), chain.mass_matrix(q), atol=1e-10)
    assert back.ik(chain.fk(q), seed=q)


@needs_pykdl
def test_rejects_unsupported_kdl_chains():
    with pytest.raises(TypeError, match=r"chain must be a PyKDL.Chain, got str"):
        rc.kinematics.Chain.from_kdl("chain")
    geared = PyKDL.Chain()
    geared.addSegment(PyKDL.Segment("a", PyKDL.Joint("j", PyKDL.Joint.RotZ, 2)))
    with pytest.raises(rc.ArgumentError, match="joint 'j' has scale 2; a chain's joints have"):
        rc.kinematics.Chain.from_kdl(geared)


@needs_pykdl
def test_applies_a_wrench_of_kdl():
    from test_scene import small_spec

    scene = rc.Scene.build(small_spec())
    weight = PyKDL.Wrench(PyKDL.Vector(0, 0, 0.1 * 9.81), PyKDL.Vector(0, 0, 0))
    scene.set_body_wrench("cube", weight)
    scene.step_n(100)
    assert scene.body_pose("cube").translation[2] == pytest.approx(0.5, abs=1e-6)
    with pytest.raises(rc.ArgumentError, match="force must be 3 numbers, got 6"):
        scene.set_body_wrench("cube", weight, [0, 0])


def test_a_chain_between_two_places_of_a_scene():
    from test_robot import cell

    scene = cell()
    chain = rc.kinematics.Chain.from_scene(scene, "base_link", tip_site="tcp")
    assert chain.tip == "tcp"
    assert chain.fk(np.zeros(7)) == scene.robot("a").fk_frame(np.zeros(7))
    with pytest.raises(rc.ArgumentError, match="give either tip_body or tip_site"):
        rc.kinematics.Chain.from_scene(scene, "base_link")


def test_a_chain_of_a_model_of_mujocos_own_package():
    import mujoco

    text = (
        "<mujoco><worldbody><body name='base' pos='1 2 3' euler='10 20 30'>"
        "<body name='a' pos='0 0 .3'><joint name='j' axis='0 1 0'/><geom size='.1'/>"
        "<body name='b' pos='.3 0 0'><joint name='k' axis='0 0 1'/><geom size='.1'/>"
        "<site name='tip' pos='.1 .2 .3'/></body></body></body></worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(text)
    chain = rc.kinematics.Chain.from_model(model, "base", tip_site="tip")
    data, q = mujoco.MjData(model), [0.4, -0.7]
    data.qpos[:] = q
    mujoco.mj_kinematics(model, data)
    del model  # the chain keeps what it needs
    base = rc.Pose(translation=data.xpos[1], quaternion=np.roll(data.xquat[1], -1))
    assert np.allclose((base * chain.fk(q)).translation, data.site("tip").xpos, atol=1e-12)
    with pytest.raises(TypeError, match=r"expected a mujoco.MjModel, got MjData"):
        rc.kinematics.Chain.from_model(data, "base", tip_site="tip")
    with pytest.raises(rc.NotFoundError, match="no body 'bas'"):
        rc.kinematics.Chain.from_model(data.model, "bas", tip_site="tip")
