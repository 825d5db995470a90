"""Where robots start in houses: clear of everything, in reach, all over the ranges."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell as rc
from robocell.scenes import HouseOptions, make_house, prepare_house_folder
from test_houses import run_of


def clearance(scene: rc.Scene) -> float:
    """The smallest distance of the robot to everything but floors, at most 5 cm."""
    model, data = scene.model, scene.data
    touching = (model.geom_contype | model.geom_conaffinity) != 0
    of_robot = np.array(
        [model.body(body).name.startswith("robot_0/") for body in model.geom_bodyid]
    )
    solid = touching & (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE)
    others = np.flatnonzero(solid & ~of_robot)
    least = 0.05
    for geom in np.flatnonzero(touching & of_robot):
        apart = np.linalg.norm(data.geom_xpos[others] - data.geom_xpos[geom], axis=1)
        near = apart < model.geom_rbound[others] + model.geom_rbound[geom] + least
        for other in others[near]:
            least = min(least, mujoco.mj_geomDistance(model, data, geom, other, least, None))
    return least


def check_placements(run: rc.RunConfig, houses: list[int], starts: int) -> None:
    """Starts in houses keep clear, are in reach and on the floor, and span the ranges."""
    run.start.base_distance, run.start.base_height_offset = [0.35, 0.6], -0.25
    run.start.base_height_noise = [-0.15, 0.1]
    sampler, source = rc.tasks.StartSampler(run), rc.scenes.make_scene_source(run)
    distances, heights = [], []
    for item in range(starts):
        house = houses[item % len(houses)]
        for attempt in range(60):
            request = rc.tasks.SampleRequest(
                scene=house, episode=item // len(houses), attempt=attempt
            )
            start = sampler.sample(request, rc.tasks.Rng.stream(house, f"{item} {attempt}"))
            if not isinstance(start, rc.tasks.Refusal):
                break
        else:
            continue
        scene = start.scene
        assert clearance(scene) > 1e-3, house
        robot = scene.robot(run.robot.name)
        target = scene.body_pose(
            next(n for n in scene.body_names() if n.split("_")[0] == start.target_object)
        )
        away = target.translation - start.base_in_world.translation
        assert np.linalg.norm(target.translation - robot.base_in_world.translation) < robot.reach
        at = start.base_in_world.translation
        on = [
            a.frame_to_world.inverse().transform(at) for a in source.annotations(house).free_floor
        ]
        areas = source.annotations(house).free_floor
        assert any(
            abs(point[0]) <= area.half_x and abs(point[1]) <= area.half_y
            for point, area in zip(on, areas, strict=True)
        )
        distances.append(np.linalg.norm(away[:2]))
        heights.append(-away[2])
    assert len(distances) > 0.8 * starts
    assert np.ptp(distances) > 0.8 * 0.25
    assert np.ptp(heights) > 0.8 * 0.25


@pytest.mark.proof
def test_starts_in_built_in_houses_are_sound():
    check_placements(run_of(), list(range(20)), 40)


@pytest.mark.soak
def test_starts_in_a_hundred_houses_are_sound(tmp_path: Path):
    options = HouseOptions(seed=12)
    prepare_house_folder(tmp_path, options)
    for index in range(100):
        make_house(tmp_path, options, index)
    check_placements(run_of(root=str(tmp_path)), list(range(100)), 200)
