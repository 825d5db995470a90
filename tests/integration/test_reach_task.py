"""The task of docs/environments.md, which has no objects, in generated datasets too."""

from __future__ import annotations

from pathlib import Path

from commands import ROOT, generate
from test_docs_snippets import blocks

import robocell as rc

EXPERT = """

@rc.tasks.register_expert("reach")
class Straight(rc.tasks.Expert):
    def __init__(self, run, start):
        super().__init__()
        self.name, self.task = run.robot.name, start.task

    def begin(self, scene, rng):
        robot = scene.robot(self.name)
        self.tcp, self.base = robot.tcp_in_world, robot.base_in_world.inverse()

    def act(self, scene, rng):
        way = self.task.point - self.tcp.translation
        step = way * min(1.0, 0.02 / max(float(np.linalg.norm(way)), 1e-9))
        self.tcp = rc.Pose(
            translation=self.tcp.translation + step, quaternion=self.tcp.quaternion
        )
        return {self.name: {"arm": rc.control.GroupCommand.leaf_pose(self.base * self.tcp)}}

    def done(self):
        return self.task.distance() < 0.01

    def failure(self):
        return ""

    def phase(self):
        return 0

    def phase_names(self):
        return ["straight"]
"""


def test_a_task_without_objects_generates(tmp_path: Path):
    (page,) = [b for b in blocks(ROOT / "docs" / "environments.md", "python") if "Reach(" in b]
    (tmp_path / "reach.py").write_text(
        "import robocell as rc\n" + page[: page.index("\nenv = ")] + EXPERT
    )
    robot = ROOT / "models" / "robots" / "rc7" / "rc7.yaml"
    run = tmp_path / "run.yaml"
    run.write_text(
        f"run: reach\nimports: [reach.py]\nrobot: {robot}\ntask: {{kind: reach}}\n"
        "scenes: {source: tabletop}\nfeatures: []\nepisodes: 2\nworkers: 1\noutput: out\n"
    )
    generate(run, tmp_path / "out", "--workers", 1, "--episodes", 2)
    dataset = rc.Dataset(tmp_path / "out")
    assert len(dataset) == 2
    for episode in dataset:
        assert episode.success
        column = episode.column("task/point")
        assert (column.units, column.frame, column.names) == ("m", "world", ["x", "y", "z"])
        assert episode.metadata["target_object"] == ""
        assert rc.data.verify_replay(episode).ok
