"""Tries poses of a hand at an object with MuJoCo: the oracle of `grasps` in object.yaml."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

MODELS = Path(__file__).resolve().parents[2] / "models"
HAND = MODELS / "equipment" / "parallel_hand" / "parallel_hand.xml"
TCP_M = 0.14  # from its flange, as its file says
OPEN_M = 0.075  # of the fingers; the hand itself opens wider
CLOSED_M = 0.002
PAD_M = 0.0125  # half the height of a pad, and what keeps it off the floor
STEP_M = 0.0015  # of a finger that closes
MOST_TURN = np.radians(45)  # between what a finger touches and the way it closes
YAWS = 24


class HandOverObject:
    """An object on a floor, and a hand that is put anywhere."""

    def __init__(self, path: Path):
        spec = mujoco.MjSpec.from_file(str(path))
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[2, 2, 0.1])
        hand = mujoco.MjSpec.from_file(str(HAND))
        for option in ("impratio", "integrator", "cone"):
            setattr(spec.option, option, getattr(hand.option, option))
        holder = spec.worldbody.add_body(mocap=True)
        holder.add_frame().attach_body(hand.body("parallel_hand"), "hand_", "")
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.root = self.model.body(path.stem).id
        self.geoms = [
            geom
            for geom in np.flatnonzero(self.model.geom_contype)
            if self.model.geom_bodyid[geom] == self.root
        ]
        bodies = [self.model.body(i).name for i in range(self.model.nbody)]
        self.is_hand = np.array([name.startswith("hand_") for name in bodies])
        sides = ("left", "right")
        self.fingers = [bodies.index(f"hand_{side}_finger") for side in sides]
        self.addresses = [
            self.model.joint(f"hand_{side}_finger_joint").qposadr[0] for side in sides
        ]
        mujoco.mj_forward(self.model, self.data)
        self.data.qpos[2] -= self._bounds()[0][2]
        mujoco.mj_forward(self.model, self.data)
        self.low, self.high = self._bounds()

    def find(self, kind: str, trials: int, seed: int) -> bool:
        """Whether two fingers take it in one of the poses that are tried."""
        rng = np.random.default_rng(seed)
        named = set()
        if kind in ("rim", "handle"):
            named = {geom for geom in self.geoms if kind in self.model.geom(geom).name}
        return any(self._holds(*self._pose(kind, sorted(named), rng), named) for _ in range(trials))

    def _pose(
        self, kind: str, named: list[int], rng: np.random.Generator
    ) -> tuple[np.ndarray, np.ndarray]:
        """A point between the pads, and the hand's axes: it comes along z and closes along y."""
        yaw = rng.integers(YAWS) * 2 * np.pi / YAWS
        is_level = kind == "side" or (kind == "handle" and rng.integers(2) == 1)
        ahead = np.array([np.cos(yaw), np.sin(yaw), 0])
        z = ahead if is_level else np.array([0, 0, -1.0])
        y = np.array([-ahead[1], ahead[0], 0])
        if kind in ("rim", "handle"):
            geom = named[rng.integers(len(named))]
            local = self.model.geom_aabb[geom, :3] + self.model.geom_aabb[geom, 3:] * rng.uniform(
                -1, 1, 3
            )
            point = self.data.geom_xmat[geom].reshape(3, 3) @ local + self.data.geom_xpos[geom]
        else:
            share = np.array([*rng.uniform(0.25, 0.75, 2), rng.uniform(0, 1)])
            point = self.low + share * (self.high - self.low)
        point[2] = max(point[2], PAD_M)
        return point, np.column_stack([np.cross(y, z), y, z])

    def _holds(self, point: np.ndarray, turn: np.ndarray, named: set[int]) -> bool:
        """Whether nothing is in the way, and each finger meets the object flat as it closes."""
        open_at = (OPEN_M - CLOSED_M) / 2
        if self._contacts(point, turn, [open_at, open_at]):
            return False
        for i, inwards in enumerate((-turn[:, 1], turn[:, 1])):
            hits = []
            at = open_at
            while not hits and at > 0:
                at = max(at - STEP_M, 0)
                places = [open_at, open_at]
                places[i] = at
                hits = self._contacts(point, turn, places)
            if not hits or any(body != self.root for body, _, _ in hits):
                return False
            normal = np.mean([normal for _, normal, _ in hits], axis=0)
            if normal @ inwards < np.cos(MOST_TURN) * np.linalg.norm(normal):
                return False
            if named and not any(geom in named for _, _, geom in hits):
                return False
        return True

    def _contacts(
        self, point: np.ndarray, turn: np.ndarray, places: list[float]
    ) -> list[tuple[int, np.ndarray, int]]:
        """What the hand touches: bodies, normals out of the hand and geoms."""
        data = self.data
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, turn.ravel())
        data.mocap_pos[0], data.mocap_quat[0] = point - TCP_M * turn[:, 2], quat
        data.qpos[self.addresses] = places
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_collision(self.model, data)
        found = []
        for contact in data.contact:
            first, second = self.model.geom_bodyid[[contact.geom1, contact.geom2]]
            if self.is_hand[first] == self.is_hand[second] or contact.dist >= 0:
                continue
            if self.is_hand[first]:
                found.append((second, contact.frame[:3].copy(), contact.geom2))
            else:
                found.append((first, -contact.frame[:3], contact.geom1))
        return found

    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        points = []
        for geom in self.geoms:
            local = self.model.geom_aabb[geom, :3] + corners * self.model.geom_aabb[geom, 3:]
            if self.model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
                mesh = self.model.geom_dataid[geom]
                first = self.model.mesh_vertadr[mesh]
                local = self.model.mesh_vert[first : first + self.model.mesh_vertnum[mesh]]
            turn = self.data.geom_xmat[geom].reshape(3, 3)
            points.append(local @ turn.T + self.data.geom_xpos[geom])
        return np.vstack(points).min(0), np.vstack(points).max(0)
