"""The built-in equipment, and files in the place of built-in models."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import robocell as rc

EQUIPMENT = [
    "button_panel",
    "cabinet",
    "cupboard",
    "d405",
    "drawer_unit",
    "faucet",
    "fr3_duo_mount",
    "ft_sensor",
    "green_cube",
    "laptop",
    "lid_box",
    "microwave",
    "open_bottle",
    "parallel_hand",
    "plug",
    "receiver",
    "region",
    "robotiq_d405_mount",
    "round_hole",
    "socket",
    "square_hole",
    "studio",
    "table",
    "tray",
    "wiping_area",
]


def cell(*objects: rc.SceneObject) -> rc.Scene:
    return rc.Scene.build(
        rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True, objects=list(objects))
    )


def test_equipment_is_found_by_name_and_loads_in_stock_mujoco():
    assert rc.models.equipment() == EQUIPMENT
    for name in EQUIPMENT:
        path = rc.models.resolve(name)
        assert path == str(Path(rc.models.root()) / "equipment" / name / f"{name}.xml")
        assert mujoco.MjModel.from_xml_path(path).nbody > 1
    assert not set(EQUIPMENT) & set(rc.tasks.object_kinds()), "nothing that tasks pick"


def test_a_door_and_a_drawer_are_pulled_open():
    scene = cell(rc.SceneObject(name="c", mjcf_path="cabinet", fixed=True))
    assert {"c_door_hinge", "c_drawer_slide"} <= set(scene.joint_names())
    scene.set_body_wrench("c_door", [0, 0, 0], [0, 0, 4])
    scene.set_body_wrench("c_drawer", [20, 0, 0], [0, 0, 0])
    scene.step_n(1500)
    assert scene.data.joint("c_door_hinge").qpos[0] == pytest.approx(2, abs=0.02)
    assert scene.data.joint("c_drawer_slide").qpos[0] == pytest.approx(0.28, abs=0.005)


def test_a_variable_overrides_a_model_file(tmp_path, monkeypatch):
    mine = tmp_path / "mine.xml"
    mine.write_text(
        Path(rc.models.resolve("table")).read_text().replace("0.6 0.4 0.02", "1 1 0.02")
    )
    monkeypatch.setenv("ROBOCELL_OVERRIDE_TABLE", str(mine))
    assert rc.models.resolve("table") == str(mine)
    scene = cell(rc.SceneObject(name="t", mjcf_path="table", fixed=True))
    assert scene.model.geom("t_top").size[0] == 1
    monkeypatch.setenv("ROBOCELL_OVERRIDE_KINOVA_GEN3", str(tmp_path / "none.xml"))
    with pytest.raises(rc.NotFoundError, match=r"^ROBOCELL_OVERRIDE_KINOVA_GEN3 is .* unset it$"):
        rc.menagerie.model_path("kinova_gen3")
