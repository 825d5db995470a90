"""The simulation of a recorded episode, rebuilt from what the episode says. No test in itself."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np
import plain_replay
from generated_run import read_json
from numpy.typing import NDArray

import robocell as rc

ROBOT_PREFIX = "robot_0/"  # of the robot's elements in generated scenes


class RecordedScene:
    """The scene of one episode, and its state in any row.

    Args:
        episode: Folder of a committed episode.
        scratch: Folder for the scene saved as binary.
    """

    def __init__(self, episode: Path, scratch: Path) -> None:
        self.steps = h5py.File(episode / "steps.h5")
        self.metadata = read_json(episode)["metadata"]
        self.scene = rc.Scene.build(rc.SceneSpec.from_yaml(self.metadata["scene_spec"]))
        self.binary = scratch / f"{episode.name}.mjb"
        self.scene.save_binary(self.binary)
        self._states: list[NDArray[np.float64]] = []

    def states(self) -> list[NDArray[np.float64]]:
        """The engine's state in every row, by a replay in plain mujoco."""
        if not self._states:
            model, data = plain_replay.load(self.binary)
            size = plain_replay.mujoco.mj_stateSize(model, plain_replay.FULL_STATE)
            for _ in plain_replay.rows(model, data, self.steps):
                state = np.empty(size)
                plain_replay.mujoco.mj_getState(model, data, state, plain_replay.FULL_STATE)
                self._states.append(state)
        return self._states

    def go_to(self, row: int) -> None:
        """Sets the scene to the state of a row."""
        self.scene.set_state(self.states()[row])
        self.scene.forward()

    def bodies_of(self, name: str) -> Iterable[int]:
        """Ids of the bodies that an object consists of."""
        model = self.scene.model
        root = model.body_rootid[int(model.joint(f"{name}_joint").bodyid[0])]
        return np.flatnonzero(model.body_rootid == root)

    def renderer(self) -> rc.render.Renderer:
        """As the run's images were made."""
        run = rc.RunConfig.from_yaml(f"{self.metadata['identity']}\noutput: {self.binary.parent}")
        quality = run.cameras.renderer.quality
        return rc.render.Renderer(
            self.scene,
            shadows=quality.shadows,
            multisamples=quality.multisamples,
            reflections=quality.reflections,
            shadow_size=quality.shadow_size,
            backend=run.cameras.renderer.backend,
        )
