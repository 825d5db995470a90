"""Exports to Rerun, read with the reader of Rerun's own package in an environment of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sysconfig
from pathlib import Path

import numpy as np
import pytest

from command_line import REPOSITORY
from exported import three_episodes
from reader_venvs import reader_python, run_reader

EXPORT = """
import sys
from robocell.export import export_dataset
result = export_dataset(sys.argv[1], sys.argv[2], "rerun", depth=True)
assert result.encoded == {}, result.encoded
"""
READ = """
import json, sys
import numpy as np
from rerun.chunk import RrdReader

reader = RrdReader(sys.argv[1])
[entry] = reader.recordings()
found = {}
for chunk in reader.store().stream().to_chunks():
    batch = chunk.to_record_batch()
    for name, column in zip(batch.schema.names, batch.columns):
        key = name.rpartition(":")[2]
        if key == "scalars":
            found[chunk.entity_path] = np.concatenate(
                [np.asarray(row, float) for row in column.to_pylist()]
            ).tolist()
        elif key in ("buffer", "meter", "format") and chunk.entity_path.endswith("/depth"):
            found.setdefault(chunk.entity_path + " " + key, []).extend(column.to_pylist())
        elif key in ("sample", "text", "translation"):
            rows = column.to_pylist()
            found.setdefault(chunk.entity_path + " " + key, []).extend(
                [len(row) for row in rows] if key == "sample" else rows
            )
print(json.dumps(found))
"""


@pytest.mark.soak
def test_rerun_reads_columns_frames_events_and_videos(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    dataset = three_episodes(tmp_path_factory)
    python = reader_python("rerun", ["rerun-sdk==0.41.0", "numpy==2.4.6", "pyarrow==26.0.1"])
    # robocell, and what it needs, are where this interpreter has them.
    paths = [str(REPOSITORY / "python"), sysconfig.get_path("platlib")]
    subprocess.run(
        [python, "-c", EXPORT, dataset.folder, tmp_path / "out"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        check=True,
    )
    episode = dataset[0]
    found = json.loads(run_reader(python, READ, tmp_path / "out" / f"{episode.id}.rrd"))
    for name in ("robots/rc7/arm/qpos", "reward", "control/ctrl"):
        assert np.array_equal(found[f"/{name}"], np.ravel(episode[name])), name
    poses = np.reshape(found["/world/TCP\\ of\\ rc7 translation"], (-1, 3))
    assert np.allclose(poses, episode["robots/rc7/tcp_pose"][:, :3], atol=1e-6)
    for camera in ("wrist", "exo"):
        assert len(found[f"/cameras/{camera} sample"]) == len(episode)
    # Depth is stored as it was recorded: uint16, thousandths of a metre.
    depth = [np.array(row[0], np.uint8).view("<u2") for row in found["/cameras/wrist/depth buffer"]]
    assert np.array_equal(np.reshape(depth, (len(episode), 48, 64)), episode.frames("wrist.depth"))
    assert {float(row[0]) for row in found["/cameras/wrist/depth meter"]} == {1000.0}
    assert "/cameras/exo/depth buffer" not in found
    assert episode.metadata["instruction"] in str(found["/events text"])
