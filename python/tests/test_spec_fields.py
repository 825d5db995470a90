"""Fields of specs from Python: edited in place, and what is said of wrong names and values."""

import pathlib

import pytest

import robocell as rc
from robocell import _core


def cube(name: str = "cube") -> rc.SceneObject:
    return rc.SceneObject(
        name=name, shape=rc.Shape.BOX, size=[0.02, 0.02, 0.02], rgba=[1, 0.5, 0, 1], mass=0.1,
        friction=[0.8, 0.02, 0.001],
    )  # fmt: skip


def arm_config() -> rc.RobotConfig:
    return rc.RobotConfig(
        name="arm",
        model="arm.xml",
        move_groups={"arm": {"kind": "arm", "joints": "joint1..joint3", "leaf": {"site": "tcp"}}},
        home={"arm": [0, 1, 2]},
    )


ALL = [v for v in vars(_core).values() if isinstance(v, type) and hasattr(v, "to_yaml")]


class TestFields:
    def test_vectors_are_views_that_write_through(self):
        gripper = rc.robots.AttachmentSpec()
        pos = gripper.pos
        gripper.pos[2] = 0.005
        gripper.euler[2] = 15
        pos[0] = 1
        assert gripper.pos.tolist() == [1, 0, 0.005]
        assert gripper.euler.tolist() == [0, 0, 15]
        gripper.pos += 1
        assert pos.tolist() == [2, 1, 1.005]

    def test_optional_vectors_are_views_once_set(self):
        spec = rc.SceneObject()
        assert spec.size is None
        spec.size = (1, 2, 3)
        spec.size[0] = 5
        assert spec.size.tolist() == [5, 2, 3]
        spec.size = None
        assert spec.size is None

    def test_views_outlive_their_spec(self):
        view = rc.SceneSpec().gravity
        assert view.tolist() == [0, 0, -9.81]
        numbers = arm_config().home["arm"]
        assert numbers.tolist() == [0, 1, 2]

    def test_nested_specs_are_edited_in_place(self):
        spec = rc.SceneSpec()
        options = spec.options
        options.impratio = 3
        spec.options.integrator = "euler"
        assert spec.options.impratio == 3
        assert options.integrator == rc.scene.Integrator.EULER

    def test_optional_specs_keep_their_identity(self):
        config = arm_config()
        robot = rc.RobotSpec(config=config)
        assert robot.config is config
        config.reach = 1.0
        assert robot.config.reach == 1.0
        robot.config = None
        assert robot.config is None
        assert config.name == "arm"

    def test_values_that_cannot_be_edited_are_immutable(self):
        spec = rc.SceneSpec()
        assert spec.options.disable == ()
        spec.options.disable = ["contact"]
        assert spec.options.disable == ("contact",)
        with pytest.raises(AttributeError):
            rc.RobotSpec().attach_to.name = "x"

    def test_names_and_ranges(self):
        group = rc.robots.MoveGroupConfig(joints="joint1..joint7", actuators="servo")
        assert group.joints == tuple(f"joint{i}" for i in range(1, 8))
        assert group.actuators == ("servo",)
        group.joints = (name for name in ("a", "b"))
        assert group.joints == ("a", "b")
        assert rc.scenes.SceneSourceSpec(houses=range(4)).houses == (0, 1, 2, 3)

    def test_enums_accept_values_and_names(self):
        spec = cube()
        spec.shape = "sphere"
        assert spec.shape is rc.Shape.SPHERE
        assert spec.condim is None
        spec.condim = rc.scene.Condim.ROLLING
        assert spec.condim.value == 6
        assert [kind.name for kind in rc.robots.AttachKind] == [
            "World", "Root", "SharedBase", "Body", "Site", "Frame", "RobotBase", "Attachment",
        ]  # fmt: skip

    def test_targets(self):
        spec = cube()
        assert spec.attach_to == rc.robots.AttachTarget()
        spec.attach_to = rc.robots.AttachTarget(rc.robots.AttachKind.Site, "pinch_site")
        assert spec.attach_to.kind is rc.robots.AttachKind.Site
        spec.attach_to = {"body": "table"}
        assert spec.attach_to == rc.robots.AttachTarget("body", "table")
        assert hash(spec.attach_to) == hash(rc.robots.AttachTarget("body", "table"))
        assert repr(spec.attach_to) == "AttachTarget(AttachKind.Body, 'table')"

    def test_elements(self):
        group = rc.robots.MoveGroupConfig(leaf={"geom": {"body": "finger", "index": 2}})
        assert group.leaf == rc.scene.ElementRef(
            kind=rc.scene.ElementKind.GEOM, body="finger", index=2
        )
        group.fingers = ["left", {"site": "right"}]
        assert group.fingers == (
            rc.scene.ElementRef("left"),
            rc.scene.ElementRef("right", kind="site"),
        )

    def test_paths_are_stored_as_strings(self):
        assert rc.RobotSpec(path=pathlib.Path("a") / "b.xml").path == "a/b.xml"

    def test_gravity_z_is_the_third_component(self):
        spec = rc.SceneSpec()
        spec.gravity_z = -1.62
        assert spec.gravity[2] == spec.gravity_z == -1.62

    def test_a_runs_robot_is_a_config_or_a_file(self):
        file = rc.models.robot_file("rc7")
        run = rc.RunConfig(run="r", robot=file, output="o")
        assert run.robot.name == "rc7"
        run.robot.reach = 0.5
        assert run.robot.reach == 0.5
        run.robot = arm_config()
        assert run.robot.name == "arm"

    def test_every_field_is_documented(self):
        for cls in ALL:
            for name, value in vars(cls).items():
                if isinstance(value, property):
                    assert value.__doc__, f"{cls.__name__}.{name}"


class TestMessages:
    def test_an_unknown_field_suggests_the_nearest(self):
        with pytest.raises(TypeError, match=r"a SceneSpec: no field 'gravty'.*mean 'gravity'"):
            rc.SceneSpec(gravty=[0, 0, 0])
        with pytest.raises(TypeError, match=r"robots\[0\]: a RobotSpec: no field 'pth'"):
            rc.SceneSpec(robots=[{"pth": "a.xml"}])
        with pytest.raises(AttributeError):
            rc.SceneSpec().gravty = 1

    @pytest.mark.parametrize(
        ("field", "value", "message"),
        [
            ("robots", ["x"], r"robots\[0\] must be a RobotSpec, got str"),
            ("robots", [rc.RobotSpec(), None], r"robots\[1\] must be a RobotSpec, got None"),
            ("robots", rc.RobotSpec(), "robots must be a list of RobotSpec, got"),
            ("robots", "x", "robots must be a list of RobotSpec, got str"),
            ("robots", [{"attachments": [3]}], r"robots\[0\]\.attachments\[0\] must be an Attach"),
            ("timestep", "fast", "timestep must be a number, got str"),
            ("add_floor", 1, "add_floor must be True or False, got int"),
            ("name", 3, "name must be a text, got int"),
            ("name", None, "name must be a text, got None"),
            ("options", 3, "options must be a SimOptions, got int"),
            ("root_frame_to_world", [0, 0, 0], "root_frame_to_world must be a Pose, got list"),
        ],
    )
    def test_wrong_type_errors_name_field_and_type(self, field, value, message):
        spec = rc.SceneSpec()
        with pytest.raises(TypeError, match=message):
            setattr(spec, field, value)
        assert spec == rc.SceneSpec()

    @pytest.mark.parametrize(
        ("field", "value", "message"),
        [
            ("gravity", [0, 0], "gravity must be 3 numbers, got 2"),
            ("options", {"integrator": "eulr"}, "options.integrator must be one of.*mean 'euler'"),
            ("options", {"iterations": 2**40}, "options.iterations must lie between"),
        ],
    )
    def test_wrong_value_errors_name_field_and_value(self, field, value, message):
        with pytest.raises(rc.ArgumentError, match=message):
            setattr(rc.SceneSpec(), field, value)

    def test_validation_reports_everything(self):
        spec = rc.SceneSpec(timestep=-1, robots=[rc.RobotSpec()])
        with pytest.raises(rc.SpecError) as error:
            spec.validate("scene 'lab'")
        assert str(error.value).splitlines() == [
            "scene 'lab' is not valid, 4 problems:",
            "  timestep: -1 must be greater than 0",
            "  robots[0].path: is empty: give the robot's model file, or a config",
            "  add_floor: is required without a base scene: true or false",
            "  add_skybox: is required without a base scene: true or false",
        ]

    def test_yaml_errors_carry_the_place(self):
        with pytest.raises(rc.SpecError, match=r"lab\.yaml:2:1: timstep: .*mean 'timestep'"):
            rc.SceneSpec.from_yaml("name: lab\ntimstep: 1\n", "lab.yaml")
