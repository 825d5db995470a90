"""Scenes from Python: real mujoco objects that are shared, lifetimes, hooks, threads."""

import gc
import sys
import threading
import time
import weakref
from types import MappingProxyType

import mujoco
import numpy as np
import pytest

import robocell as rc


def small_spec(**fields) -> rc.SceneSpec:
    spec = rc.SceneSpec(name="small", timestep=0.002, add_floor=True, add_skybox=False, **fields)
    spec.objects.append(
        rc.SceneObject(
            name="cube", shape="box", size=[0.02, 0.02, 0.02], pos=[0, 0, 0.5],
            rgba=[1, 0, 0, 1], mass=0.1, friction=[1, 0.01, 0.001],
        )
    )  # fmt: skip
    return spec


def arm_spec() -> rc.SceneSpec:
    spec = small_spec()
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    return spec


@pytest.fixture
def scene() -> rc.Scene:
    return rc.Scene.build(small_spec())


class TestSharing:
    def test_model_and_data_are_mujoco_objects_and_stay_identical(self, scene):
        assert isinstance(scene.model, mujoco.MjModel)
        assert isinstance(scene.data, mujoco.MjData)
        assert scene.model is scene.model
        assert scene.data is scene.data
        assert scene.data.model is scene.model

    def test_nothing_is_copied(self, scene):
        scene.data.qpos[2] = 0.7
        scene.forward()
        assert scene.body_pose("cube").translation[2] == 0.7
        scene.step_n(10)
        assert scene.data.time == scene.time() == pytest.approx(0.02)
        scene.model.opt.gravity[2] = 0
        scene.reset()
        scene.step_n(100)
        assert scene.body_pose("cube").translation[2] == 0.5

    def test_mujoco_can_step_it(self, scene):
        other = rc.Scene.build(small_spec())
        for _ in range(50):
            mujoco.mj_step(scene.model, scene.data)
        other.step_n(50)
        np.testing.assert_array_equal(scene.data.qpos, other.data.qpos)

    def test_data_outlives_its_scene(self):
        scene = rc.Scene.build(small_spec())
        scene.step_n(5)
        data, model = scene.data, scene.model
        ref = weakref.ref(scene)
        del scene
        gc.collect()
        assert ref() is None
        assert data.time == pytest.approx(0.01)
        mujoco.mj_step(model, data)
        assert data.time == pytest.approx(0.012)

    def test_data_kept_after_close_is_still_alive(self, scene):
        data = scene.data
        scene.step()
        before = data.time
        scene.close()
        gc.collect()
        mujoco.mj_step(data.model, data)
        assert data.time == pytest.approx(before + data.model.opt.timestep)

    def test_the_scene_outlives_the_objects_taken_from_it(self, scene):
        address = scene.data._address
        gc.collect()
        scene.step()
        assert scene.data._address == address

    def test_many_scenes_can_be_created_and_freed(self):
        for _ in range(30):
            scene = rc.Scene.build(small_spec())
            scene.model, scene.data.qpos[0]
            scene.step()
            assert scene.time() == scene.timestep()

    def test_scenes_on_one_frozen_model_are_independent(self):
        compiled = rc.scene.compile_scene(small_spec())
        compiled.freeze()
        a, b = rc.Scene.from_compiled(compiled), rc.Scene.from_compiled(compiled)
        assert a.model is b.model is compiled.model
        assert a.data is not b.data
        a.step_n(10)
        assert b.time() == 0
        assert a != b
        del a, compiled
        gc.collect()
        b.step()

    @pytest.mark.parametrize("by", ["folder", "environment"])
    def test_a_compiled_scene_is_kept_on_the_disk(self, by, tmp_path, monkeypatch):
        monkeypatch.setenv("ROBOCELL_CACHE_DIR", str(tmp_path))
        cache = tmp_path / "scenes" if by == "folder" else True
        first = rc.scene.compile_scene(small_spec(), cache=cache)
        (entry,) = (tmp_path / "scenes").iterdir()
        inode = entry.stat().st_ino
        second = rc.scene.compile_scene(small_spec(), cache=str(cache) if by == "folder" else True)
        assert entry.stat().st_ino == inode, "written again instead of read"
        scenes = [rc.Scene.from_compiled(compiled) for compiled in (first, second)]
        for scene in scenes:
            scene.reset()
            scene.step_n(50)
        np.testing.assert_array_equal(scenes[0].data.qpos, scenes[1].data.qpos)

    def test_rejects_two_scenes_on_an_unfrozen_model(self):
        compiled = rc.scene.compile_scene(small_spec())
        first = rc.Scene.from_compiled(compiled)
        message = "scene 'small': its compiled scene is used by another scene.*freeze.*compile"
        with pytest.raises(rc.Error, match=message):
            rc.Scene.from_compiled(compiled)
        first.model.opt.timestep = 0.001  # its own, so it may
        compiled.freeze()
        second = rc.Scene.from_compiled(compiled)
        assert second.timestep() == 0.001

    def test_the_next_scene_on_a_model_has_the_pool_of_the_spec(self):
        spec = small_spec()
        for name, parked in (("outside", True), ("inside", False)):
            spec.objects.append(
                rc.SceneObject(name=name, mjcf_path="mug", fixed=False, parked=parked)
            )
        compiled = rc.scene.compile_scene(spec)
        first = rc.Scene.from_compiled(compiled)
        masks = first.model.geom_contype.copy()
        first.add_object("outside")
        first.remove_object("inside")
        changed = r"frozen.*: object 'outside' was added, object 'inside' was removed"
        with pytest.raises(rc.Error, match=changed):
            compiled.freeze()
        first.close()
        second = rc.Scene.from_compiled(compiled)
        np.testing.assert_array_equal(second.model.geom_contype, masks)
        assert second.parked_objects == ["outside"]
        second.close()
        compiled.freeze()

    def test_a_scene_holds_no_reference_to_its_compiled_scene(self):
        """Letting go of one would need the interpreter, on whatever thread the scene dies."""
        compiled = rc.scene.compile_scene(small_spec())
        references = sys.getrefcount(compiled)
        scene = rc.Scene.from_compiled(compiled)
        assert sys.getrefcount(compiled) == references
        del compiled
        gc.collect()
        assert scene.step()

    def test_closing_or_freeing_a_scene_releases_its_model(self):
        compiled = rc.scene.compile_scene(small_spec())
        rc.Scene.from_compiled(compiled).step()
        gc.collect()
        rc.Scene.from_compiled(compiled).close()
        held = rc.Scene.from_compiled(compiled)
        held.step()
        assert held.time() == held.timestep(), "the third scene on a model for one"

    @pytest.mark.parametrize("first", ["model", "freeze"])
    def test_a_frozen_model_is_read_only(self, first):
        compiled = rc.scene.compile_scene(small_spec())
        model = compiled.model if first == "model" else None
        compiled.freeze()
        model = compiled.model
        assert rc.Scene.from_compiled(compiled).model is model
        arrays = [model.geom_rgba, model.qpos0, model.actuator_gainprm, model.key_qpos]
        parts = [model.opt.gravity, model.stat.center, model.vis.headlight.ambient]
        for array in [*arrays, *parts]:
            with pytest.raises(ValueError, match="read-only"):
                array[:] = 0.5
        with pytest.raises(ValueError, match="read-only"):
            model.body_mass = 2.0
        mujoco.mj_step(model, mujoco.MjData(model))

    def test_a_model_that_is_not_frozen_is_writable(self, scene):
        scene.model.geom_rgba[:] = 0.5
        scene.model.opt.gravity[:] = 0
        assert np.all(scene.model.geom_rgba == 0.5)
        scene.model.dof_damping[:] = 0
        scene.data.qfrc_applied[:] = 0
        mujoco.mj_forward(scene.model, scene.data)
        assert np.allclose(scene.data.qfrc_bias, 0), "gravity is off and nothing moves"

    def test_a_copy_of_a_compiled_scene_has_its_own_model(self):
        compiled = rc.scene.compile_scene(small_spec())
        compiled.freeze()
        copy = compiled.copy()
        assert not copy.frozen
        assert copy.generation > compiled.generation
        copy.model.body_mass[1] += 1
        assert compiled.model.body_mass[1] != copy.model.body_mass[1]
        scene = rc.Scene.from_compiled(copy)
        del copy, compiled
        gc.collect()
        assert scene.step().ok
        assert "<mujoco" in scene.to_xml()

    def test_a_compiled_scene_lists_its_robots_and_objects(self):
        spec = arm_spec()
        spec.objects[0].parked = True
        compiled = rc.scene.compile_scene(spec)
        copy = compiled.copy_spec()
        assert copy == spec
        copy.name = "other"
        assert compiled.copy_spec().name == spec.name
        (robot,) = compiled.robots
        assert (robot.name, robot.root_body) == ("a", "base_link")
        assert robot.copy_config() == spec.robots[0].config
        assert robot.copy_base() == spec.robots[0].config.base
        assert (robot.mocap_body, robot.tcp_site) == ("mocap_base", None)
        (cube,) = compiled.objects
        assert (cube.name, cube.root_body, cube.parked) == ("cube", "cube", True)
        assert compiled.model.joint(cube.free_joint).type == mujoco.mjtJoint.mjJNT_FREE
        assert compiled.robot("a").name == compiled.object("cube").name.replace("cube", "a")
        with pytest.raises(rc.NotFoundError, match="Did you mean 'cube'"):
            compiled.object("cub")
        assert compiled.notes == rc.Scene.from_compiled(compiled).notes

    def test_the_configuration_of_a_robot_is_a_copy(self):
        spec = arm_spec()
        robot = rc.Scene.build(spec).robot("a")
        config = robot.copy_config()
        assert config == spec.robots[0].config
        config.name = "other"
        assert robot.copy_config() == spec.robots[0].config

    def test_concurrent_threads_get_the_same_model(self, monkeypatch):
        """Python may change threads at any line of the hand-over."""
        version = mujoco.mj_versionString
        monkeypatch.setattr(mujoco, "mj_versionString", lambda: (time.sleep(0.05), version())[1])
        compiled = rc.scene.compile_scene(small_spec())
        models = []
        ask = lambda: models.append(compiled.model)  # noqa: E731
        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(models) == 4
        assert len({id(model) for model in models}) == 1


class TestThreads:
    def test_a_scene_can_be_freed_on_another_thread(self):
        scenes = [rc.Scene.build(small_spec()) for _ in range(3)]
        data = scenes[0].data
        thread = threading.Thread(target=scenes.clear)
        thread.start()
        thread.join()
        gc.collect()
        assert data.time == 0

    def test_collection_on_a_foreign_thread(self):
        class Holder:
            pass

        holder = Holder()
        holder.scene = rc.Scene.build(small_spec())
        holder.self = holder
        ref = weakref.ref(holder)
        del holder
        thread = threading.Thread(target=gc.collect)
        thread.start()
        thread.join()
        assert ref() is None

    def test_two_scenes_step_at_the_same_time(self):
        """Stepping releases the interpreter; each scene has its own thread."""
        results = {}

        def run(name: str) -> None:
            scene = rc.Scene.build(small_spec())
            scene.step_n(500)
            results[name] = scene.state()

        threads = [threading.Thread(target=run, args=(name,)) for name in "ab"]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        np.testing.assert_array_equal(results["a"], results["b"])

    def test_other_threads_run_while_it_steps(self, scene):
        ticks = []
        stop = threading.Event()

        def tick() -> None:
            while not stop.wait(0.001):
                ticks.append(1)

        thread = threading.Thread(target=tick)
        thread.start()
        scene.step_n(30_000)
        stop.set()
        thread.join()
        assert len(ticks) > 3


class TestReset:
    def test_a_reset_forgets_everything(self, scene):
        first = scene.state()
        scene.step_n(100)
        scene.data.qvel[:] = 5
        info = scene.reset()
        np.testing.assert_array_equal(scene.state(), first)
        assert info.used_keyframe
        assert not scene.reset(use_keyframe=False).used_keyframe

    @pytest.mark.parametrize("wrong", [True, False, {"cube": True}, 1.0, {"cube": 0.5}, ["home"]])
    def test_rejects_keyframes_of_a_wrong_type(self, scene, wrong):
        for call in (
            lambda: scene.reset(keyframe=wrong),
            lambda: rc.scene.ResetOptions(keyframe=wrong),
            lambda: setattr(rc.scene.ResetOptions(), "keyframe", wrong),
        ):
            with pytest.raises(TypeError, match="keyframe"):
                call()

    def test_a_keyframe_of_a_part_has_a_number_or_a_name(self, scene):
        for good in (0, np.int64(0), "home", {"cube": 0}, {"cube": "home"}, {"cube": np.int32(0)}):
            assert scene.reset(keyframe=good).keyframe == 0
            scene.reset(rc.scene.ResetOptions(keyframe=good))
        assert rc.scene.ResetOptions(keyframe={"cube": 0}).keyframe == {"cube": 0}
        with pytest.raises(rc.ArgumentError, match="there is no keyframe 1; its model has 1: home"):
            scene.reset(keyframe={"cube": 1})

    def test_hooks_are_called_with_the_scene(self, scene):
        seen = []

        def lift(reset: rc.scene.ResetContext) -> None:
            seen.append((reset.options.seed, reset.info.used_keyframe))
            reset.scene.set_body_pose("cube", [0, 0, 1], [0, 0, 0, 1])

        hook = scene.on_reset(lift)
        scene.reset(seed=5)
        assert scene.body_pose("cube").translation.tolist() == [0, 0, 1]
        scene.remove_reset_hook(hook)
        scene.reset(rc.scene.ResetOptions(seed=6))
        assert scene.body_pose("cube").translation.tolist() == [0, 0, 0.5]
        assert seen == [(5, True)]

    def test_all_hooks_can_be_removed(self, scene):
        called = []
        for i in range(3):
            scene.on_reset(lambda reset, i=i: called.append(i))
        scene.reset()
        scene.clear_reset_hooks()
        scene.reset()
        assert called == [0, 1, 2]

    def test_bodies_start_at_the_poses_of_the_reset(self, scene):
        there = rc.Pose(translation=[0.1, 0, 1], rpy=[0, 0, 1])
        scene.reset(body_poses={"cube": there})
        assert scene.body_pose("cube").is_close(there, 1e-12, 1e-12)
        scene.reset()
        assert scene.body_pose("cube").translation.tolist() == [0, 0, 0.5]
        scene.reset(body_poses=MappingProxyType({"cube": there}))
        assert scene.body_pose("cube").is_close(there, 1e-12, 1e-12)
        for nothing in ([("cube", there)], "cube", 3):
            with pytest.raises(TypeError, match="body_poses must be a dict of names of bodies to"):
                scene.reset(body_poses=nothing)
        with pytest.raises(TypeError, match="body_poses must be keyed by names, got int"):
            scene.reset(body_poses={3: there})
        options = rc.scene.ResetOptions(seed=3, body_poses={"cube": there})
        assert options.body_poses["cube"] == there
        assert repr(options).endswith(f"seed=3, body_poses={{'cube': {there!r}}})")
        scene.reset(options)
        assert scene.body_pose("cube").is_close(there, 1e-12, 1e-12)
        with pytest.raises(rc.ArgumentError, match="give either options or keyframe"):
            scene.reset(options, body_poses={})
        with pytest.raises(TypeError, match=r"body_poses\.cube must be a Pose, got int"):
            scene.reset(body_poses={"cube": 3})
        options.body_poses = None
        assert options.body_poses == {}

    def test_an_error_in_a_hook_propagates_from_reset(self, scene):
        def fail(reset: rc.scene.ResetContext) -> None:
            raise KeyError("mine")

        scene.on_reset(fail)
        with pytest.raises(KeyError, match="mine"):
            scene.reset()

    def test_a_context_that_is_kept_is_harmless(self, scene):
        kept = []
        scene.on_reset(kept.append)
        scene.reset(seed=1)
        assert kept[0].options.seed == 1
        assert kept[0].scene == scene

    def test_a_hook_that_refers_to_its_scene_is_collected(self):
        class Cell:
            def __init__(self) -> None:
                self.scene = rc.Scene.build(small_spec())
                self.scene.on_reset(self.prepare)

            def prepare(self, reset: rc.scene.ResetContext) -> None:
                reset.scene.time()

        cell = Cell()
        cell.scene.reset()
        ref = weakref.ref(cell)
        del cell
        gc.collect()
        assert ref() is None

    def test_options_exclude_each_other(self, scene):
        with pytest.raises(rc.ArgumentError, match="give either options or"):
            scene.reset(rc.scene.ResetOptions(), seed=1)


class TestCalls:
    def test_divergence_is_a_value(self, scene):
        scene.data.qvel[0] = np.nan
        result = scene.step_n(10)
        assert not result
        assert result.diverged
        assert result.steps == 1
        assert "cube_joint" in result.message
        scene.reset()
        assert scene.step()

    def test_unknown_names_suggest_the_nearest(self, scene):
        with pytest.raises(rc.NotFoundError, match=r"scene 'small'.*no body 'cub'.*mean 'cube'"):
            scene.body_pose("cub")
        with pytest.raises(rc.NotFoundError, match="no robot 'left'"):
            scene.robot("left")
        assert scene.robots == []

    def test_poses_are_set_by_pose_or_by_numbers(self, scene):
        scene.set_body_pose("cube", rc.Pose(translation=[1, 2, 3]))
        assert scene.body_pose("cube").translation.tolist() == [1, 2, 3]
        with pytest.raises(rc.ArgumentError, match="pos must be 3 numbers, got 2"):
            scene.set_body_pose("cube", [1, 2])
        with pytest.raises(rc.Error, match="world"):
            scene.set_body_pose("world", [1, 2, 3])

    def test_a_state_can_be_saved_and_restored(self, scene):
        scene.step_n(20)
        state = scene.state()
        scene.step_n(20)
        later = scene.state()
        scene.set_state(state)
        scene.step_n(20)
        np.testing.assert_array_equal(scene.state(), later)
        with pytest.raises(rc.ArgumentError):
            scene.set_state([1, 2, 3])

    def test_contacts_have_names_and_forces(self, scene):
        scene.set_body_pose("cube", [0, 0, 0.02])
        scene.step_n(300)
        contacts = scene.contacts("cube")
        assert {c.geom1 for c in contacts} | {c.geom2 for c in contacts} == {"floor", "cube_geom"}
        weight = sum(abs(c.force[2]) for c in contacts)
        assert weight == pytest.approx(0.1 * 9.81, rel=0.02)

    def test_wrenches_push(self, scene):
        scene.set_body_wrench("cube", [0, 0, 0.1 * 9.81])
        scene.step_n(100)
        assert scene.body_pose("cube").translation[2] == pytest.approx(0.5, abs=1e-6)

    def test_saved_files_are_loaded_by_mujoco(self, scene, tmp_path):
        scene.model.opt.gravity[2] = -1.625
        scene.model.geom("cube_geom").friction[0] = 0.125
        scene.save_xml(tmp_path / "scene.xml")
        scene.save_binary(tmp_path / "scene.mjb")
        for model in (
            mujoco.MjModel.from_xml_path(str(tmp_path / "scene.xml")),
            mujoco.MjModel.from_binary_path(str(tmp_path / "scene.mjb")),
            mujoco.MjModel.from_xml_string(scene.to_xml()),
        ):
            assert model.body("cube").mass == pytest.approx(0.1)
            assert model.opt.gravity[2] == -1.625, "what was changed in the model since"
            assert model.geom("cube_geom").friction[0] == 0.125
        with pytest.raises(rc.IoError, match="nowhere"):
            scene.save_binary(tmp_path / "nowhere" / "scene.mjb")

    def test_frames_are_those_of_kdl(self, scene):
        pytest.importorskip("PyKDL")
        assert rc.Pose(scene.body_frame("cube")) == scene.body_pose("cube")

    def test_every_call_fails_after_close(self, scene):
        data = weakref.ref(scene.data)
        with scene:
            pass
        scene.close()
        assert scene.closed
        gc.collect()
        assert data() is None
        assert repr(scene) == "<Scene 'small', closed>"
        for call in (
            scene.step, scene.reset, scene.time, scene.state, scene.contacts,
            lambda: scene.model, lambda: scene.data, lambda: scene.robot("a"),
            lambda: scene.on_reset(print), lambda: scene.body_pose("cube"),
        ):  # fmt: skip
            with pytest.raises(rc.ClosedError, match="scene 'small' is closed"):
                call()

    def test_the_spec_is_a_copy(self, scene):
        scene.copy_spec().objects.clear()
        assert len(scene.copy_spec().objects) == 1

    def test_a_change_of_its_spec_is_never_lost_silently(self, scene):
        with pytest.raises(
            AttributeError, match=r"copy_spec\(\) gives a copy of what it was built"
        ):
            scene.spec.timestep = 0.1
        changed = scene.copy_spec()
        changed.timestep = 0.001
        assert rc.Scene.build(changed).timestep() == 0.001

    def test_editing_the_spec_later_changes_no_scene(self):
        spec = small_spec()
        scene = rc.Scene.build(spec)
        spec.objects.clear()
        scene.reset()
        assert "cube" in scene.body_names()

    def test_an_invalid_spec_error_lists_all_problems(self):
        spec = small_spec()
        spec.timestep = None
        spec.objects[0].mass = -1
        with pytest.raises(rc.SpecError, match="2 problems"):
            rc.Scene.build(spec)

    def test_handles_are_equal_and_hash_alike(self, scene):
        kept = []
        scene.on_reset(kept.append)
        scene.reset()
        assert {scene, kept[0].scene} == {scene}
        assert scene != rc.Scene.build(small_spec())


def test_rejects_another_mujoco_version(monkeypatch):
    monkeypatch.setattr(mujoco, "mj_versionString", lambda: "3.9.9")
    with pytest.raises(rc.EngineError, match=r"version 3\.9\.9, robocell was built for 4\.0\.0"):
        rc.Scene.build(small_spec())
