"""Draws the pictures of the catalogue: one PNG beside each built-in model.

Plain mujoco, so that a picture shows the model and nothing of robocell. Each model stands on a
plain floor; robots take their keyframe `home`. Drawn at twice the size and scaled down.

    MUJOCO_GL=egl python scripts/make_pictures.py [NAME ...]
"""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np
from PIL import Image

MODELS = Path(__file__).resolve().parent.parent / "models"
SIZE = (480, 360)  # width, height in pixels
LARGEST = 60_000  # bytes of a picture
OPENED = 0.4  # how far doors and drawers are open


@dataclass
class View:
    """Where a kind of model is seen from; distance in sizes of the model, angles in degrees."""

    distance: float
    azimuth: float
    elevation: float


VIEWS = {
    "robots": View(1.5, 145, -18),
    "objects": View(2.0, 125, -28),
    "equipment": View(1.7, 150, -24),
    "scenes": View(1.4, 130, -24),
}


def models() -> dict[str, Path]:
    """The MJCF files of the catalogue by name; worlds with nothing to see are left out."""
    folders = ("robots/*", "objects/*", "equipment/*", "scenes")
    files = [file for folder in folders for file in MODELS.glob(f"{folder}/*.xml")]
    return {f.stem: f for f in sorted(files) if f.stem != "empty_world"}


def stage(path: Path) -> mujoco.MjModel:
    """The model on a floor, with a light and a pale sky."""
    spec = mujoco.MjSpec.from_file(str(path))
    world = spec.worldbody
    low, high = bounds(spec.copy().compile())
    size = float(np.linalg.norm(high - low))
    spec.add_texture(
        name="stage_sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, rgb1=[0.9, 0.93, 0.96], rgb2=[0.8, 0.84, 0.9],
    )  # fmt: skip
    world.add_geom(
        name="stage_floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[8 * size, 8 * size, 1],
        pos=[0, 0, low[2]], rgba=[0.80, 0.82, 0.84, 1],
    )  # fmt: skip
    if not spec.lights:
        spec.visual.headlight.ambient = [0.35, 0.35, 0.36]
        spec.visual.headlight.diffuse = [0.25, 0.25, 0.25]
        world.add_light(
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
            dir=[-0.35, -0.5, -1],
            diffuse=[0.45, 0.44, 0.42],
            specular=[0.2, 0.2, 0.2],
        )
    # The shadow map is as large as the model and starts just before it, else it shows stripes.
    for light in spec.lights:
        light.pos = (low + high) / 2 - size * np.array(light.dir) / np.linalg.norm(light.dir)
    return spec.compile()


def at_home(model: mujoco.MjModel) -> mujoco.MjData:
    """The state of keyframe 0, else with hinges and slides a little open; positions computed."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    else:
        for joint, kind in enumerate(model.jnt_type):
            if mujoco.mjtJoint(kind) in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
                low, high = model.jnt_range[joint]
                opened = low + OPENED * (high - low) if model.jnt_stiffness[joint] == 0 else 0
                data.qpos[model.jnt_qposadr[joint]] = opened
    mujoco.mj_forward(model, data)
    return data


def points(model: mujoco.MjModel, geom: int) -> np.ndarray:
    """A mesh's vertices, else the corners of the geom's box; (n, 3) in the geom's frame."""
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        first = model.mesh_vertadr[mesh]
        return model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return model.geom_aabb[geom, :3] + signs * model.geom_aabb[geom, 3:]


def bounds(model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of what is seen at home; metres, world."""
    data = at_home(model)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in range(model.ngeom):
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE or model.geom_group[geom] > 2:
            continue
        corners = points(model, geom) @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        low, high = np.minimum(low, corners.min(0)), np.maximum(high, corners.max(0))
    return low, high


def draw(model: mujoco.MjModel, view: View) -> Image.Image:
    """The model in the middle of the picture."""
    low, high = bounds(model)
    size = float(np.linalg.norm(high - low))
    model.stat.extent, model.vis.map.znear, model.vis.map.zfar = size, 0.05, 30
    model.vis.map.shadowclip = 4
    model.vis.quality.shadowsize = 8192
    model.vis.global_.offwidth, model.vis.global_.offheight = 2 * SIZE[0], 2 * SIZE[1]
    camera = mujoco.MjvCamera()
    camera.lookat[:] = (low + high) / 2
    camera.distance = view.distance * size
    camera.azimuth, camera.elevation = view.azimuth, view.elevation
    option = mujoco.MjvOption()
    option.sitegroup[:] = 0
    with mujoco.Renderer(model, 2 * SIZE[1], 2 * SIZE[0]) as renderer:
        renderer.update_scene(at_home(model), camera, option)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        large = Image.fromarray(renderer.render())
    return large.resize(SIZE, Image.Resampling.LANCZOS)


def main() -> None:
    """Draws the named models, or all."""
    catalogue = models()
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(catalogue))
    for name in parser.parse_args().names or catalogue:
        path = catalogue[name]
        view = VIEWS[path.relative_to(MODELS).parts[0]]
        picture = path.with_suffix(".png")
        draw(stage(path), view).quantize(256, dither=Image.Dither.NONE).save(picture, optimize=True)
        size = picture.stat().st_size
        assert size <= LARGEST, f"{picture}: {size} bytes, at most {LARGEST} wanted"
        print(f"{picture.relative_to(MODELS.parent)}: {size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
