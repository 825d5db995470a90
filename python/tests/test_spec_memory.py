"""Specs and Python's garbage collector: cycles are collected, live objects are not emptied."""

import gc
import weakref

import pytest

import robocell as rc


class Robot(rc.RobotSpec):
    """A subclass: it has attributes, so it can take part in cycles."""


class Group(rc.robots.MoveGroupConfig):
    pass


class Config(rc.RobotConfig):
    pass


@pytest.fixture(autouse=True)
def collected():
    gc.collect()
    yield
    gc.collect()


def test_a_cycle_through_a_list_is_collected():
    spec = rc.SceneSpec(robots=[Robot()])
    spec.robots[0].home = spec
    ref = weakref.ref(spec.robots[0])
    del spec
    gc.collect()
    assert ref() is None


def test_a_cycle_through_a_mapping_and_an_optional_spec_is_collected():
    config = Config(move_groups={"arm": Group()})
    robot = rc.RobotSpec(config=config)
    config.move_groups["arm"].owner = robot
    refs = [weakref.ref(config), weakref.ref(config.move_groups["arm"]), weakref.ref(robot)]
    del config, robot
    gc.collect()
    assert [ref() for ref in refs] == [None, None, None]


def test_a_cycle_through_a_view_is_collected():
    spec = rc.SceneSpec(robots=[Robot()])
    spec.robots[0].siblings = spec.robots
    ref = weakref.ref(spec.robots[0])
    del spec
    gc.collect()
    assert ref() is None


def test_a_cycle_below_an_element_made_in_c_plus_plus_is_collected():
    spec = rc.SceneSpec.from_yaml(
        "timestep: 0.1\nadd_floor: true\nadd_skybox: true\n"
        "robots: [{config: {name: a, model: b}}]\n"
    )
    group = Group()
    group.spec = spec
    spec.robots[0].config.move_groups["arm"] = group
    ref = weakref.ref(group)
    del spec, group
    gc.collect()
    assert ref() is None


def test_a_held_element_keeps_its_contents():
    """Its owner is garbage, it is not: nothing of it may be cleared."""
    spec = rc.SceneSpec.from_yaml(
        "timestep: 0.1\nadd_floor: true\nadd_skybox: true\nrobots: [{path: a.xml}]\n"
    )
    tool = rc.robots.AttachmentSpec(mjcf_path="hand.xml")
    held = spec.robots[0]
    held.attachments.append(tool)
    marker = Robot()
    marker.spec = spec
    spec.robots.append(marker)
    ref = weakref.ref(marker)
    del spec, marker
    gc.collect()
    assert ref() is None
    assert held.path == "a.xml"
    assert held.attachments[0] is tool


def test_a_held_element_of_a_collected_owner_is_whole():
    robot = Robot(path="a.xml", attachments=[rc.robots.AttachmentSpec(mjcf_path="hand.xml")])
    spec = rc.SceneSpec(robots=[robot, Robot()])
    spec.robots[1].spec = spec
    del spec
    gc.collect()
    assert robot.path == "a.xml"
    assert robot.attachments[0].mjcf_path == "hand.xml"


def test_a_nested_view_keeps_its_spec_whole():
    run = rc.RunConfig(cameras={"streams": [{"name": "a", "camera": "b"}]})
    cameras = run.cameras
    del run
    gc.collect()
    assert cameras.streams[0].name == "a"


def test_lists_survive_many_collections():
    spec = rc.SceneSpec(robots=[Robot() for _ in range(20)])
    for robot in spec.robots:
        robot.spec = spec
    for _ in range(5):
        gc.collect()
        assert len(spec.robots) == 20
        assert all(robot.spec is spec for robot in spec.robots)


def test_dropping_an_element_that_edits_the_list_in_its_finaliser_is_safe():
    class Meddler(rc.RobotSpec):
        def __del__(self):
            self.spec.robots.append(rc.RobotSpec(path="late.xml"))

    spec = rc.SceneSpec(robots=[Meddler()])
    spec.robots[0].spec = spec
    spec.robots.clear()
    gc.collect()
    assert [robot.path for robot in spec.robots] in ([], ["late.xml"])


def test_leaves_no_garbage():
    def count() -> int:
        gc.collect()
        return sum(isinstance(o, rc.SceneSpec | rc.RobotSpec) for o in gc.get_objects())

    before = count()
    for _ in range(200):
        spec = rc.SceneSpec(robots=[Robot(), rc.RobotSpec()])
        spec.robots[0].spec = spec
        spec.robots[1].pos[0] = 1
    del spec
    assert count() == before
