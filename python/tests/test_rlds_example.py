"""The recipe for RLDS, examples/learning/rlds.py, beside a stand-in for tensorflow_datasets.

The stand-in holds every step against the features that the recipe declares, as TFDS does when it
encodes them. The soak test runs TFDS itself.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robocell
from exported import three_episodes

EXAMPLE = Path(__file__).parents[2] / "examples" / "learning" / "rlds.py"
ROBOT = "robots/rc7"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


def require(feature: Any, value: Any, place: str = "") -> None:
    """Raises AssertionError unless a value is what a feature declares."""
    kind, options = feature
    if kind == "FeaturesDict":
        assert set(value) == set(options["features"]), place
        for name, inner in options["features"].items():
            require(inner, value[name], f"{place}/{name}")
    elif kind == "Dataset":
        for index, step in enumerate(value):
            require(("FeaturesDict", {"features": options["feature"]}), step, f"{place}[{index}]")
    elif kind == "Image":
        assert value.dtype == np.uint8, place
        assert value.shape == options["shape"], place
    elif kind == "Text":
        assert isinstance(value, str), place
    else:
        assert np.shape(value) == options.get("shape", ()), place
        assert np.can_cast(np.asarray(value).dtype, options["dtype"], "equiv"), place


@pytest.fixture
def recipe(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    def feature(kind: str, first: str = "") -> Any:
        def make(*given: Any, **options: Any) -> Any:
            return kind, options | ({first: given[0]} if given else {})

        return make

    class Builder:
        name = "robocell_picks"

        def __init__(self, data_dir: str) -> None:
            self.data_dir = data_dir
            self.written: dict[str, Any] = {}

        def download_and_prepare(self) -> None:
            features = self._info().features  # type: ignore[attr-defined]
            for name, examples in self._split_generators(None).items():  # type: ignore[attr-defined]
                assert name == "train"
                for key, example in examples:
                    assert key not in self.written
                    require(features, example)
                    self.written[key] = example

    tfds = ModuleType("tensorflow_datasets")
    tfds.core = SimpleNamespace(  # type: ignore[attr-defined]
        GeneratorBasedBuilder=Builder,
        Version=str,
        DatasetInfo=lambda builder, features: SimpleNamespace(features=features),
    )
    tfds.features = SimpleNamespace(  # type: ignore[attr-defined]
        FeaturesDict=feature("FeaturesDict", "features"),
        Dataset=feature("Dataset", "feature"),
        Image=feature("Image"),
        Tensor=feature("Tensor"),
        Scalar=feature("Scalar"),
        Text=feature("Text"),
    )
    monkeypatch.setitem(sys.modules, "tensorflow_datasets", tfds)
    spec = importlib.util.spec_from_file_location("rlds_recipe", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.proof
def test_steps_are_the_rows_of_the_episodes(
    dataset: robocell.Dataset, recipe: ModuleType, tmp_path: Path
):
    builder = recipe.RobocellPicks(dataset=str(dataset.folder), data_dir=str(tmp_path))
    builder.download_and_prepare()
    assert list(builder.written) == dataset.ids
    for name, episode in zip(dataset.ids, dataset, strict=True):
        steps = builder.written[name]["steps"]
        assert len(steps) == len(episode)
        assert [step["is_first"] for step in steps] == [True] + [False] * (len(steps) - 1)
        assert [step["is_last"] for step in steps] == [False] * (len(steps) - 1) + [True]
        actions = np.array([step["action"] for step in steps])
        moved = episode[f"{ROBOT}/action/tcp_displacement"].astype(np.float32)
        assert np.array_equal(actions[:, :6], moved)
        opening = episode[f"{ROBOT}/action/gripper"][:, 0].astype(np.float32)
        assert np.array_equal(actions[:, 6], opening)
        state = np.array([step["observation"]["state"] for step in steps])
        assert np.array_equal(state[:, :7], episode[f"{ROBOT}/arm/qpos"].astype(np.float32))
        images = np.array([step["observation"]["wrist"] for step in steps])
        assert np.array_equal(images, episode.frames("wrist"))
        assert {step["language_instruction"] for step in steps} == {episode.metadata["instruction"]}
        assert sum(step["reward"] for step in steps) == float(episode.success)


def test_the_program_says_where_the_result_is(
    dataset: robocell.Dataset, recipe: ModuleType, tmp_path: Path, capsys: Any
):
    recipe.main(str(dataset.folder), str(tmp_path / "rlds"))
    assert capsys.readouterr().out == f"3 episodes: {tmp_path / 'rlds' / 'robocell_picks'}\n"


@pytest.mark.soak
def test_tensorflow_datasets_writes_and_reads_it(dataset: robocell.Dataset, tmp_path: Path):
    """In an environment of its own, with gigabytes of TensorFlow."""
    python = tmp_path / "venv" / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", python.parents[1]], check=True)
    packages = ["tensorflow-cpu", "tensorflow-datasets", "protobuf", "typer"]
    packages += ["mujoco==4.0.0", "mujoco-menagerie"]
    subprocess.run([python, "-m", "pip", "install", "-q", *packages], check=True)
    path = {**os.environ, "PYTHONPATH": str(EXAMPLE.parents[2] / "python")}
    out = tmp_path / "rlds"
    subprocess.run([python, EXAMPLE, dataset.folder, out], check=True, env=path)
    reader = (
        "import sys, tensorflow_datasets as tfds\n"
        "builder = tfds.builder_from_directory(sys.argv[1])\n"
        "for episode in builder.as_dataset(split='train'):\n"
        "    print(sum(1 for _ in episode['steps']))\n"
    )
    [place] = out.glob("robocell_picks/*")
    read = [python, "-c", reader, place]
    said = subprocess.run(read, check=True, env=path, capture_output=True, text=True).stdout
    assert sorted(map(int, said.split())) == sorted(len(episode) for episode in dataset)
