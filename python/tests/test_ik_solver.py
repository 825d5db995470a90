"""Prepared inverse kinematics: `ik_solver` of a robot, its kinematics and a chain."""

import gc
import tracemalloc
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import robocell as rc
from robocell.models import robot_file


def build() -> rc.Scene:
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="a", config=rc.RobotConfig.load(robot_file("rc7"))))
    return rc.Scene.build(spec)


@pytest.fixture(scope="module")
def robot() -> rc.Robot:
    return build().robot("a")


def reachable(robot: rc.Robot, count: int, seed: int = 0) -> np.ndarray:
    """(count, n) joint values in the limits."""
    low, high = np.array(robot.joint_limits).T
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


class TestAnswers:
    @pytest.mark.parametrize(
        "options",
        [
            {},
            {"tolerance": 1e-9},
            {"position_only": True},
            {"axis": [0, 0, 1], "cone": 0.1},
            {"prefer": "limits", "max_restarts": 20},
            {"prefer": "seed"},
            {"position_weights": [1, 0, 1], "max_iterations": 20},
            {"filter": lambda q: q[:, 0] > -1},
        ],
    )
    def test_the_solver_matches_ik(self, robot, options):
        solvers = [each.ik_solver(**options) for each in (robot, robot.kinematics, robot.chain)]
        for q in reachable(robot, 20, seed=5):
            target, seed = robot.kinematics.fk(q), np.clip(q + 0.1, *np.array(robot.joint_limits).T)
            expected = robot.ik(target, seed, **options)
            for solver in solvers:
                out = np.full(7, 9.0)
                assert solver.solve(target, seed, out) == expected.success
                found = solver.result
                np.testing.assert_array_equal(found.q, expected.q)
                np.testing.assert_array_equal(out, expected.q if expected else np.full(7, 9.0))
                assert found.success == expected.success
                assert found.position_error == expected.position_error
                assert found.iterations == expected.iterations
                assert found.restarts == expected.restarts

    def test_accepts_poses_and_seeds_of_every_kind(self, robot):
        q = reachable(robot, 1)[0]
        pose, seed = robot.kinematics.fk(q), robot.arm.joint_pos
        solver = robot.ik_solver()
        assert solver.solve(pose, seed)
        expected = solver.result.q
        columns_first = np.asfortranarray(pose.matrix)
        for target in (pose.matrix, pose.matrix.tolist(), columns_first):
            assert solver.solve(target, seed)
            np.testing.assert_allclose(solver.result.q, expected, atol=1e-9)
        for same in (list(seed), tuple(seed), np.repeat(seed, 2)[::2], memoryview(seed)):
            assert solver.solve(pose, same)
            np.testing.assert_array_equal(solver.result.q, expected)
        kdl = pytest.importorskip("PyKDL")
        assert isinstance(pose.to_kdl(), kdl.Frame)
        assert solver.solve(pose.to_kdl(), seed)
        np.testing.assert_allclose(solver.result.q, expected, atol=1e-9)

    def test_lock_joints(self, robot):
        seed = np.array(robot.arm.joint_pos)
        target = robot.kinematics.fk(seed)
        assert robot.ik_solver(locked_groups=["arm"]).solve(target, seed)
        far = target * rc.Pose(translation=[0, 0, 0.1])
        assert not robot.ik_solver(locked_groups=["arm"]).solve(far, seed)
        name = robot.chain.joint_names[0]
        solver = robot.chain.ik_solver(locked_joints=[name])
        assert solver.solve(robot.kinematics.fk(np.r_[seed[0], seed[1:] + 0.1]), seed)
        assert solver.result.q[0] == seed[0]

    def test_a_closed_filter_keeps_configurations_out(self, robot):
        free = rc.kinematics.CollisionFilter(robot)
        solver = robot.ik_solver(filter=free)
        q = next(q for q in reachable(robot, 50) if free(q[None])[0])
        assert solver.solve(robot.kinematics.fk(q), q)
        assert free(solver.result.q[None])[0]


class TestOut:
    def test_the_output_can_be_the_seed_and_is_kept_without_a_solution(self, robot):
        solver = robot.ik_solver()
        q = np.array(robot.arm.joint_pos)
        target = robot.kinematics.fk(q + 0.1)
        assert solver.solve(target, q, out=q)
        assert robot.kinematics.fk(q).is_close(target, 1e-5, 1e-5)
        before = q.copy()
        assert not solver.solve(rc.Pose(translation=[9, 0, 0]), q, out=q)
        np.testing.assert_array_equal(q, before)
        assert not solver.result
        assert solver.result.position_error > 1

    def test_rejects_a_read_only_output(self, robot):
        solver = robot.ik_solver()
        seed = np.array(robot.arm.joint_pos)
        target = robot.kinematics.fk(seed)
        sealed = seed.copy()
        sealed.flags.writeable = False
        outs = [np.zeros(6), np.zeros((7, 1)), np.zeros(14)[::2], seed.astype("f4"), [0.0] * 7]
        for out in [*outs, sealed, seed.astype(">f8")]:
            with pytest.raises(rc.ArgumentError, match=r"out must be a contiguous.*\(7,\)"):
                solver.solve(target, seed, out)

    def test_nothing_is_allocated(self, robot):
        solver = robot.ik_solver(tolerance=1e-6)
        q = np.array(robot.arm.joint_pos)
        pose = robot.kinematics.fk(q + 0.1)
        for target in (pose, pose.matrix):
            out = q.copy()
            solver.solve(target, q, out)
            tracemalloc.start()
            try:
                begin = tracemalloc.get_traced_memory()[0]
                tracemalloc.reset_peak()
                for _ in range(100):
                    solver.solve(target, q, out)
                peak = tracemalloc.get_traced_memory()[1]
            finally:
                tracemalloc.stop()
            assert peak - begin < 100  # bytes: an array of seven numbers has more


class TestErrors:
    def test_rejects_invalid_options_at_construction(self, robot):
        for options, text in (
            ({"tolerance": -1.0}, "tolerance is -1"),
            ({"max_restarts": -1}, "max_restarts"),
            ({"prefer": "sed"}, "Did you mean 'seed'"),
            ({"cone": 0.1}, "cone"),
        ):
            for each in (robot, robot.kinematics, robot.chain):
                with pytest.raises(rc.ArgumentError, match=text):
                    each.ik_solver(**options)
        with pytest.raises(TypeError, match="seed"):
            robot.ik_solver(seed=robot.arm.joint_pos)

    def test_rejects_the_queries_that_ik_rejects(self, robot):
        solver, seed = robot.ik_solver(), np.array(robot.arm.joint_pos)
        pose = robot.kinematics.fk(seed)
        for target, start in (
            (pose, seed[:6]),
            (pose, seed * np.nan),
            (pose, np.zeros(13)),
            (pose, np.zeros(0)),
            (pose, seed[None]),
            (np.zeros((4, 4)), seed),
            (np.zeros((3, 3)), seed),
            (pose.matrix * np.nan, seed),
        ):
            with pytest.raises((rc.ArgumentError, TypeError)) as ours:
                solver.solve(target, start)
            with pytest.raises((rc.ArgumentError, TypeError)) as theirs:
                robot.ik(target, start)
            assert str(ours.value) == str(theirs.value)
        with pytest.raises(TypeError, match="`seed` must be a value, got None"):
            solver.solve(pose, None)
        assert solver.solve(pose, seed)


class TestLife:
    def test_a_solver_uses_the_chain_of_its_construction(self):
        scene = build()
        robot = scene.robot("a")
        seed = np.array(robot.arm.joint_pos)
        target = robot.kinematics.fk(seed + 0.1)
        solver = robot.ik_solver()
        assert solver.chain.joint_names == robot.chain.joint_names
        assert "IkSolver of chain" in repr(solver)
        scene.close()
        assert solver.solve(target, seed)
        with pytest.raises(rc.ClosedError):
            robot.ik_solver()

    def test_the_solver_owns_its_filter_and_cycles_are_collected(self, robot):
        class Keep:
            solver: object = None

            def __call__(self, q: np.ndarray) -> np.ndarray:
                return q[:, 0] > -9

        keep = Keep()
        solver = keep.solver = robot.ik_solver(filter=keep)
        watched = weakref.ref(keep)
        del keep
        gc.collect()
        seed = np.array(robot.arm.joint_pos)
        assert solver.solve(robot.kinematics.fk(seed + 0.1), seed)
        del solver
        gc.collect()
        assert watched() is None

    def test_an_error_in_the_filter_propagates(self, robot):
        def fail(q: np.ndarray) -> np.ndarray:
            raise KeyError("mine")

        seed = np.array(robot.arm.joint_pos)
        with pytest.raises(KeyError, match="mine"):
            robot.ik_solver(filter=fail).solve(robot.kinematics.fk(seed), seed)

    def test_threads_can_share_a_solver_that_releases_the_gil(self, robot):
        solver = robot.ik_solver(prefer="limits")
        questions = [(robot.kinematics.fk(q), q) for q in reachable(robot, 40, seed=7)]
        alone = []
        for target, seed in questions:
            out = np.empty(7)
            assert solver.solve(target, seed, out)
            alone.append(out)

        def answer(k: int) -> np.ndarray:
            out = np.empty(7)
            assert solver.solve(*questions[k], out)
            return out

        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(answer, range(len(questions))))
        np.testing.assert_array_equal(together, alone)
