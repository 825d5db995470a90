"""`randomize:` from Python: values by name, pins, pictures, textures of the user's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc


def cell(**randomize: object) -> rc.EnvConfig:
    config = rc.EnvConfig.load(rc.models.cell_file("rc7"))
    config.root_frame_objects["cube"] = rc.envs.EnvObject(
        shape="box", size=[0.05, 0.05, 0.05], mass=0.1, offset=rc.Pose(translation=[0.5, 0, 0.05])
    )
    config.cameras.streams = []
    config.camera_adds = {}
    config.randomize = randomize
    return config


def picture(env: rc.Env) -> np.ndarray:
    renderer = rc.render.Renderer(env.scene, backend="soft")
    view = rc.render.OrbitCamera(lookat=(0.5, 0, 0.05), distance=0.6)
    return renderer.render(view, 64, 48)["rgb"]


def test_an_environment_shows_its_values_and_a_pin_fixes_one():
    ranges = {"lights": {"intensity": {"uniform": [0.1, 0.9]}}}
    env = rc.Env(cell(**ranges))
    assert env.randomized == {}
    env.reset(seed=1)
    drawn = env.randomized
    assert set(drawn) == {"light/0/intensity", "light/1/intensity"}
    assert all(0.1 <= value <= 0.9 for value in drawn.values())
    pinned = cell(**ranges)
    pinned.randomize.pin({"light/0/intensity": 0.25})
    env = rc.Env(pinned)
    env.reset(seed=1)
    assert env.randomized == drawn | {"light/0/intensity": 0.25}


def test_a_folder_of_textures_reaches_the_picture(tmp_path: Path):
    (tmp_path / "textures").mkdir()
    for name, colour in (("red", (255, 0, 0)), ("green", (0, 255, 0))):
        image = np.full((8, 8, 3), colour, dtype=np.uint8)
        rc.render.write_png(tmp_path / "textures" / f"{name}.png", image)
    looks = {"cube": {"texture": [f"{tmp_path}/textures/"], "specular": 0}}
    env = rc.Env(cell(appearance=looks))
    seen = set()
    for seed in range(6):
        env.reset(seed=seed)
        name = Path(env.randomized["cube/texture"]).stem
        pixels = picture(env).reshape(-1, 3).astype(int)
        others = {"red": pixels[:, 1], "green": pixels[:, 0]}[name]
        own = {"red": pixels[:, 0], "green": pixels[:, 1]}[name]
        assert (own > others + 60).sum() > 50, name
        assert (others > own + 60).sum() == 0, name
        seen.add(name)
    assert seen == {"red", "green"}


def test_mistakes_name_the_place_and_the_alternatives():
    with pytest.raises(rc.SpecError, match=r"randomize\.sky: sky is between 0 and 1"):
        rc.Env(cell(sky={"uniform": [0, 2]}))
    with pytest.raises(LookupError, match="Did you mean 'cube'"):
        rc.Env(cell(dynamics={"cubes": {"mass": {"value": 1}}}))


def test_the_blocks_of_runs_and_environments_are_read_and_described():
    text = "sky: {uniform: [0.3, 1]}\ndynamics: {cube: {friction: 0.4}}\n"
    run = rc.RunConfig.from_yaml(
        "run: r\nrobot: {name: a, model: a.xml}\ntask: {kind: pick}\noutput: o\nrandomize:\n  "
        + text.replace("\n", "\n  ")
    )
    assert run.randomize.describe() == ["sky: 0.3 to 1, uniform", "cube: friction: 0.4"]
    assert run.randomize.dynamics["cube"].friction.value == 0.4
