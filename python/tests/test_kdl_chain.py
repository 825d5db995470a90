"""The robot's chain as PyKDL.Chain: the same kinematics and dynamics."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell import _pykdl
from test_robot import cell

try:
    import PyKDL
except ImportError:
    PyKDL = None

needs_pykdl = pytest.mark.skipif(PyKDL is None, reason="PyKDL is not installed")


def to_kdl(q: np.ndarray) -> "PyKDL.JntArray":
    array = PyKDL.JntArray(len(q))
    for i, value in enumerate(q):
        array[i] = value
    return array


def random_positions(robot: rc.Robot, count: int) -> np.ndarray:
    """(count, n) within the limits, +-pi where there are none."""
    lower, upper = np.clip(robot.joint_limits, -np.pi, np.pi).T
    return np.random.default_rng(5).uniform(lower, upper, (count, len(lower)))


def check_against_kdl(robot: rc.Robot) -> None:
    chain = robot.kdl_chain()
    assert isinstance(chain, PyKDL.Chain)
    assert chain.getNrOfJoints() == robot.n_joints
    fk = PyKDL.ChainFkSolverPos_recursive(chain)
    jacobian = PyKDL.ChainJntToJacSolver(chain)
    gravity = robot.base_in_world.rotation.T @ robot.scene.model.opt.gravity
    dynamics = PyKDL.ChainDynParam(chain, PyKDL.Vector(*gravity))
    for q in random_positions(robot, 50):
        tip = PyKDL.Frame()
        assert fk.JntToCart(to_kdl(q), tip) >= 0
        assert rc.Pose.from_kdl(tip).is_close(robot.fk_frame(q), 1e-9, 1e-9)
        theirs = PyKDL.Jacobian(len(q))
        jacobian.JntToJac(to_kdl(q), theirs)
        kdl = [[theirs[r, c] for c in range(len(q))] for r in range(6)]
        np.testing.assert_allclose(kdl, robot.kinematics.jacobian(q), atol=1e-9)
        robot.set_joint_pos(q)
        torques = PyKDL.JntArray(len(q))
        dynamics.JntToGravity(to_kdl(q), torques)
        if not robot.scene.model.body_gravcomp.any():  # which KDL does not know
            kdl = [torques[i] for i in range(len(q))]
            np.testing.assert_allclose(kdl, robot.gravity_torques(), atol=1e-7)


@needs_pykdl
def test_the_built_in_robot_is_the_same_in_kdl():
    check_against_kdl(cell().robot("a"))


@needs_pykdl
def test_an_arm_with_a_tool_is_the_same_in_kdl(menagerie):
    arm = rc.RobotSpec(path=rc.menagerie.model_path("kinova_gen3"))
    tool = rc.robots.AttachmentSpec(
        mjcf_path=rc.menagerie.model_path("robotiq_2f85"),
        attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Site, "pinch_site"),
        prefix="g_",
    )
    arm.attachments.append(tool)
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False, robots=[arm])
    scene = rc.Scene.build(spec)
    frame = rc.robots.ToolFrameSpec(tool_body="g_base", tcp_site="g_pinch")
    check_against_kdl(rc.Robot.from_scene(scene, "base_link", "bracelet_link", tool=frame))


def test_without_pykdl_the_message_says_how_to_install_it():
    code = (
        "import sys; sys.modules['PyKDL'] = None\n"
        "from test_robot import cell\n"
        "cell().robot('a').kdl_chain()\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parent,
        check=False,
    )
    assert result.returncode == 1
    assert "ImportError: this needs PyKDL" in result.stderr
    assert _pykdl.remedy() in result.stderr
