"""The exceptions and what else they are."""

import mujoco
import pytest

import robocell as rc


@pytest.mark.parametrize(
    ("error", "also"),
    [
        (rc.Error, RuntimeError),
        (rc.SpecError, ValueError),
        (rc.NotFoundError, LookupError),
        (rc.ArgumentError, ValueError),
        (rc.ClosedError, RuntimeError),
        (rc.DivergedError, RuntimeError),
        (rc.EngineError, RuntimeError),
        (rc.IoError, OSError),
    ],
)
def test_every_error_is_a_robocell_error_and_what_python_would_raise(error, also):
    assert issubclass(error, rc.Error)
    assert issubclass(error, also)
    assert error.__module__ == "robocell"
    assert error.__doc__


def test_c_plus_plus_errors_arrive_as_their_class():
    with pytest.raises(rc.NotFoundError, match="Did you mean 'rc7'"):
        rc.models.robot_file("rc8")
    with pytest.raises(rc.IoError, match=r"nothing\.yaml"):
        rc.RobotConfig.load("/nonexistent/nothing.yaml")


def test_versions_are_texts():
    assert rc.__version__.count(".") == 2
    assert rc.diagnose.mujoco_version() == mujoco.mj_versionString()
    assert rc.__mujoco_version__ == rc.diagnose.mujoco_version()


def test_log_levels():
    before = rc.log.log_level()
    for level in ("error", "warn", "info", "debug", "none"):
        rc.log.set_log_level(level)
        assert rc.log.log_level() == level
    with pytest.raises(rc.NotFoundError):
        rc.log.set_log_level("loud")
    rc.log.set_log_level(before)


def cell(**fields: object) -> rc.SceneSpec:
    """A scene with the built-in robot, or one of other fields."""
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    fields = fields or {"config": rc.RobotConfig.load(rc.models.robot_file("rc7"))}
    spec.robots = [rc.RobotSpec(name="a", **fields)]
    return spec


def cube(name: str) -> rc.SceneObject:
    return rc.SceneObject(
        name=name, shape="box", size=[0.1] * 3, rgba=[1, 0, 0, 1], mass=1, friction=[1, 0.1, 0.1]
    )


def test_a_robot_of_a_chain_says_what_has_a_gripper():
    robot = rc.Robot.from_scene(rc.Scene.build(cell()), "base_link", "link7")
    with pytest.raises(
        rc.NotFoundError,
        match=r"It was made of a chain by Robot::FromScene \(in Python Robot.from_scene\), which "
        r"makes an arm only: .* with Scene::SetActuatorCtrl \(in Python Scene.set_actuator_ctrl\)",
    ):
        robot.gripper  # noqa: B018


def test_an_object_called_like_a_body_of_a_robot_is_told():
    spec = cell()
    spec.objects = [cube("cube"), cube("link3")]
    with pytest.raises(
        rc.SpecError,
        match=r"object 'link3': .*body 'link3' is in robot 'a' already, and the object would bring "
        "another one; give the object another name",
    ):
        rc.Scene.build(spec)


def test_an_object_of_two_bodies_is_not_asked_for_a_field_that_it_has_not(tmp_path):
    model = tmp_path / "two.xml"
    bodies = '<body name="x"><geom size="1"/></body><body name="y"><geom size="1"/></body>'
    model.write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    spec = cell()
    spec.objects = [rc.SceneObject(name="o", mjcf_path=str(model))]
    with pytest.raises(rc.SpecError, match="2 root bodies: x, y; only one can be placed: put the"):
        rc.Scene.build(spec)


def test_a_robot_file_is_no_model():
    file = rc.models.robot_file("rc7")
    with pytest.raises(rc.SpecError, match=r"is YAML, and models are MJCF\. .*RobotConfig\.load"):
        rc.Scene.build(cell(path=str(file)))


def test_a_teleport_beyond_the_limits_is_told_once(capfd):
    robot = rc.Scene.build(cell()).robot("a")
    q = robot.arm.joint_pos.copy()
    q[3] = robot.joint_limits[3][1] + 1
    robot.set_joint_pos(q)
    robot.set_joint_pos(q)
    assert capfd.readouterr().err.count("joint 'joint4' is put at ") == 1
    assert robot.arm.joint_pos[3] == q[3]


def test_a_link_of_the_chain_is_no_tool():
    scene = rc.Scene.build(cell())
    with pytest.raises(
        rc.ArgumentError, match="tool body 'link3' is a link of the chain itself, at or before"
    ):
        rc.Robot.from_scene(
            scene,
            "base_link",
            "link7",
            tool=rc.robots.ToolFrameSpec(tool_body="link3", tcp_site="tcp"),
        )
