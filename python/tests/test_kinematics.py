"""What holds for kinematics of every chain, from Python: random chains, judged by the engine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

import robocell as rc

TOLERANCE = 1e-5
NEAR = 1.0001 * TOLERANCE
EXAMPLES = Path(__file__).parents[2] / "examples"


def numbers(values: Any) -> str:
    return " ".join(f"{v:.17g}" for v in values)


def random_xml(rng: np.random.Generator, joints: int, tiny: bool = False) -> str:
    """MJCF of a chain "base" -> site "tip": hinges and slides, offset, skew, some with limits."""

    def place(far: float) -> str:
        return f"pos='{numbers(rng.uniform(-far, far, 3))}' quat='{numbers(rng.normal(size=4))}'"

    links = ""
    for k in range(joints):
        slide = rng.random() < 0.25
        low = rng.uniform(*((-0.4, -0.1) if slide else (-3, -1.5)))
        high = rng.uniform(*((0.1, 0.4) if slide else (1.5, 3)))
        if tiny and rng.random() < 0.3:
            high = low + 1e-3
        limits = f"range='{low} {high}'" if slide or tiny or rng.random() < 0.7 else ""
        links += (
            f"<body name='link{k}' {place(0.3)}><joint name='j{k}' "
            f"type='{'slide' if slide else 'hinge'}' axis='{numbers(rng.normal(size=3))}' "
            f"pos='{numbers(rng.uniform(-0.1, 0.1, 3))}' ref='{rng.uniform(-0.3, 0.3)}' "
            f"armature='{rng.uniform(0, 0.2)}' {limits}/>"
            f"<inertial mass='{rng.uniform(0.1, 3)}' pos='{numbers(rng.uniform(-0.1, 0.1, 3))}' "
            f"diaginertia='{numbers(rng.uniform(0.01, 0.019, 3))}'/>"
        )
    return (
        "<mujoco><compiler angle='radian' autolimits='true'/><worldbody>"
        f"<body name='base' {place(1)}><geom size='0.01'/>{links}"
        f"<site name='tip' {place(0.2)}/>{'</body>' * joints}</body></worldbody></mujoco>"
    )


@dataclass
class Case:
    """A chain of robocell, and the engine's own model of the same file."""

    chain: rc.kinematics.Chain
    model: mujoco.MjModel
    data: mujoco.MjData
    rng: np.random.Generator

    @property
    def n(self) -> int:
        return self.chain.n_joints

    def anywhere(self, count: int) -> np.ndarray:
        low, high = np.clip(np.array(self.chain.joint_limits), -np.pi, np.pi).T
        return self.rng.uniform(low, high, (count, self.n))

    def stand(self, q: np.ndarray) -> None:
        self.data.qpos[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def tip(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Position and rotation in the base, by the engine."""
        self.stand(q)
        base, tip = self.data.body("base"), self.data.site("tip")
        axes = base.xmat.reshape(3, 3).T
        return axes @ (tip.xpos - base.xpos), axes @ tip.xmat.reshape(3, 3)

    def errors(self, target: np.ndarray, q: np.ndarray) -> tuple[float, float]:
        """Metres and radians that the engine's tip is off."""
        position, rotation = self.tip(q)
        turn = rotation @ target[:3, :3].T
        sine = [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        angle = np.arctan2(float(np.linalg.norm(sine)), float(np.trace(turn)) - 1)
        return float(np.linalg.norm(position - target[:3, 3])), float(angle)


def make_case(folder: Path, joints: int, tiny: bool = False) -> Case:
    rng = np.random.default_rng([joints, tiny])
    xml = random_xml(rng, joints, tiny)
    path = folder / "chain.xml"
    path.write_text(xml)
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(path=str(path)))
    chain = rc.kinematics.Chain.from_scene(rc.Scene.build(spec), "base", tip_site="tip")
    model = mujoco.MjModel.from_xml_string(xml)
    return Case(chain, model, mujoco.MjData(model), rng)


@pytest.fixture(params=range(2, 13))
def case(request: pytest.FixtureRequest, tmp_path: Path) -> Case:
    return make_case(tmp_path, request.param)


def test_kinematics_and_dynamics_are_the_engines(case: Case):
    chain, model, data, n = case.chain, case.model, case.data, case.n
    q, (qd, qdd) = case.anywhere(5), case.rng.normal(size=(2, 5, n))
    tips, jacobians = chain.fk(q), chain.jacobian(q)
    full, rows = np.zeros((n, n)), np.zeros((2, 3, n))
    for k in range(5):
        position, rotation = case.tip(q[k])
        np.testing.assert_allclose(tips[k, :3, 3], position, atol=1e-12)
        np.testing.assert_allclose(tips[k, :3, :3], rotation, atol=1e-12)
        axes = data.body("base").xmat.reshape(3, 3).T
        mujoco.mj_jacSite(model, data, rows[0], rows[1], model.site("tip").id)
        np.testing.assert_allclose(
            jacobians[k], np.vstack([axes @ rows[0], axes @ rows[1]]), atol=1e-11
        )
        volume = np.prod(np.linalg.svd(jacobians[k], compute_uv=False))
        assert chain.manipulability(q)[k] ** 2 == pytest.approx(volume**2, rel=1e-9, abs=1e-12)
        data.qvel[:], gravity = 0, axes @ model.opt.gravity
        mujoco.mj_forward(model, data)
        still = data.qfrc_bias.copy()
        np.testing.assert_allclose(chain.gravity_torques(q, gravity)[k], still, atol=1e-9)
        mujoco.mj_fullM(model, data, full)
        np.testing.assert_allclose(chain.mass_matrix(q)[k], full, atol=1e-10)
        data.qvel[:] = qd[k]
        mujoco.mj_forward(model, data)
        moving = data.qfrc_bias - still
        np.testing.assert_allclose(chain.coriolis_torques(q, qd)[k], moving, atol=1e-9)
        np.testing.assert_allclose(chain.coriolis_torques(q[k], qd[k]), moving, atol=1e-9)
        np.testing.assert_allclose(
            chain.inverse_dynamics(q, qd, qdd, gravity)[k],
            full @ qdd[k] + data.qfrc_bias,
            atol=1e-9,
        )


def test_jacobians_are_the_slopes_of_tips(case: Case):
    q, h = case.anywhere(4), 1e-6
    jacobians = case.chain.jacobian(q)
    for joint in range(case.n):
        step = np.zeros(case.n)
        step[joint] = h
        before, after = case.chain.fk(q - step), case.chain.fk(q + step)
        slope = (after - before)[:, :3, 3] / (2 * h)
        np.testing.assert_allclose(jacobians[:, :3, joint], slope, atol=1e-8)
        here = case.chain.fk(q)[:, :3, :3].transpose(0, 2, 1)
        spin = (after - before)[:, :3, :3] @ here / (2 * h)
        turn = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
        np.testing.assert_allclose(jacobians[:, 3:, joint], turn, atol=1e-8)


def questions(case: Case) -> SimpleNamespace:
    """Targets (B, 4, 4) that are reached, at limits, nearly singular and nowhere; and seeds."""
    low, high = np.array(case.chain.joint_limits).T
    inside = case.anywhere(8)
    corners = np.where(case.rng.random((8, case.n)) < 0.5, low, high)
    corners = np.where(np.isfinite(corners), corners, case.anywhere(8))
    many = case.anywhere(200)
    singular = many[np.argsort(case.chain.manipulability(many))[:4]]
    truth = np.vstack([inside, corners, singular])
    targets = case.chain.fk(np.vstack([truth, case.anywhere(6)]))
    away = 10.0 ** np.arange(2, 8)[:, None] * case.rng.normal(size=(6, 3))
    targets[20:, :3, 3] += away
    seeds = np.vstack([truth, case.anywhere(6)]) + case.rng.uniform(-1, 1, (26, case.n))
    seeds[::3] += case.rng.uniform(-30, 30, seeds[::3].shape)  # mostly outside the limits
    return SimpleNamespace(targets=targets, seeds=seeds, reachable=20)


def check_answers(case: Case, asked: SimpleNamespace, found: Any) -> None:
    """Limits are obeyed, and what is claimed is true."""
    low, high = np.array(case.chain.joint_limits).T
    assert np.all((found.q >= low) & (found.q <= high))
    for k, target in enumerate(asked.targets):
        position, rotation = case.errors(target, found.q[k])
        assert found.position_error[k] == pytest.approx(position, rel=1e-9, abs=1e-9)
        assert found.rotation_error[k] == pytest.approx(rotation, abs=1e-6)
        claimed = found.position_error[k] <= TOLERANCE and found.rotation_error[k] <= TOLERANCE
        assert found.success[k] == claimed
        if found.success[k]:
            assert position <= NEAR
            assert rotation <= NEAR
    assert found.success[: asked.reachable].sum() >= asked.reachable - 1
    assert not found.success[asked.reachable :].any()


@pytest.mark.parametrize("tiny", [False, True], ids=["wide", "tiny limits"])
@pytest.mark.parametrize("joints", range(2, 13))
def test_solutions_are_correct_and_independent(joints: int, tiny: bool, tmp_path: Path):
    case = make_case(tmp_path, joints, tiny)
    asked = questions(case)
    found = case.chain.ik_batch(asked.targets, seeds=asked.seeds)
    check_answers(case, asked, found)
    check_answers(case, asked, case.chain.ik_batch(asked.targets))
    singles = [
        case.chain.ik(target, seed=seed)
        for target, seed in zip(asked.targets, asked.seeds, strict=True)
    ]
    fields = ("q", "success", "position_error", "rotation_error")
    together = {name: np.array([getattr(one, name) for one in singles]) for name in fields}
    check_answers(case, asked, SimpleNamespace(**together))
    # To the bit: in any order, on threads, alone.
    order = case.rng.permutation(len(asked.targets))
    for threads in (1, 2):
        mixed = case.chain.ik_batch(asked.targets[order], seeds=asked.seeds[order], threads=threads)
        for name in (*fields, "iterations"):
            np.testing.assert_array_equal(getattr(mixed, name), getattr(found, name)[order])
    alone = case.chain.ik_batch(asked.targets[3:4], seeds=asked.seeds[3])
    np.testing.assert_array_equal(alone.q[0], found.q[3])


@pytest.mark.parametrize(
    ("robot", "least"), [("rc7", 19998), ("desk6", 19980)], ids=["seven joints", "six joints"]
)
def test_reachable_poses_are_solved(robot: str, least: int):
    path = EXAMPLES / "desk6" / "desk6.yaml" if robot == "desk6" else rc.models.robot_file(robot)
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="a", config=rc.RobotConfig.load(path)))
    arm = rc.Scene.build(spec).robot("a")
    kinematics = arm.kinematics
    low, high = np.array(arm.joint_limits).T
    truth = np.random.default_rng(9).uniform(low, high, (20000, len(low)))
    targets = kinematics.fk(truth)
    found = kinematics.ik_batch(targets, threads=2)
    assert found.success.sum() >= least
    assert np.all((found.q >= low) & (found.q <= high))
    off = kinematics.fk(found.q)[found.success] - targets[found.success]
    assert np.linalg.norm(off[:, :3, 3], axis=1).max() <= NEAR
    # A small angle is the norm of the difference of the rotations, over the root of 2.
    assert np.linalg.norm(off[:, :3, :3], axis=(1, 2)).max() <= np.sqrt(2) * NEAR
