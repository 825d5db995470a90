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
def test_every_error_is_a_robocell_error_and_a_builtin_error(error, also):
    assert issubclass(error, rc.Error)
    assert issubclass(error, also)
    assert error.__module__ == "robocell"
    assert error.__doc__


def test_cpp_errors_map_to_python_classes():
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


def test_a_chain_robot_error_names_the_robot_with_a_gripper():
    robot = rc.Robot.from_scene(rc.Scene.build(cell()), "base_link", "link7")
    with pytest.raises(
        rc.NotFoundError,
        match=r"It was made of a chain by Robot::FromScene \(in Python Robot.from_scene\), which "
        r"makes an arm only: .* with Scene::SetActuatorCtrl \(in Python Scene.set_actuator_ctrl\)",
    ):
        robot.gripper  # noqa: B018


def test_rejects_an_object_named_like_a_robot_body():
    spec = cell()
    spec.objects = [cube("cube"), cube("link3")]
    with pytest.raises(
        rc.SpecError,
        match=r"object 'link3': .*body 'link3' is in robot 'a' already, and the object would bring "
        "another one; give the object another name",
    ):
        rc.Scene.build(spec)


def test_rejects_an_object_model_with_two_root_bodies(tmp_path):
    model = tmp_path / "two.xml"
    bodies = '<body name="x"><geom size="1"/></body><body name="y"><geom size="1"/></body>'
    model.write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    spec = cell()
    spec.objects = [rc.SceneObject(name="o", mjcf_path=str(model))]
    with pytest.raises(rc.SpecError, match="2 root bodies: x, y; only one can be placed: put the"):
        rc.Scene.build(spec)


def test_rejects_a_robot_file_as_a_model():
    file = rc.models.robot_file("rc7")
    with pytest.raises(
        rc.SpecError, match=r"is YAML, and models are MJCF or URDF\. .*RobotConfig\.load"
    ):
        rc.Scene.build(cell(path=str(file)))


def test_warns_once_about_a_teleport_beyond_the_limits(capfd):
    robot = rc.Scene.build(cell()).robot("a")
    q = robot.arm.joint_pos.copy()
    q[3] = robot.joint_limits[3][1] + 1
    robot.set_joint_pos(q)
    robot.set_joint_pos(q)
    assert capfd.readouterr().err.count("joint 'joint4' is set to ") == 1
    assert robot.arm.joint_pos[3] == q[3]


def test_rejects_a_link_of_the_chain_as_the_tool():
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
