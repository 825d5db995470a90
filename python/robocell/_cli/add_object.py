"""`robocell add-object`: a user's models as kinds of the catalogue."""

from __future__ import annotations

import os
import re
import tempfile
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from robocell import Error, models
from robocell._cli.common import ExitCode, fail, print_error, print_warning, print_wide
from robocell._durable import flush_folder, flush_path, make_folders
from robocell._extras import needed_by
from robocell._suggestions import counted
from robocell.tasks import object_categories

SUFFIXES = (".xml", ".obj", ".stl", ".glb")
DENSITY = 600.0  # kg/m^3: wood, and hollow plastic
FRICTION = 0.8  # sliding
TILTED = 10.0  # degrees
DEEPEST = 1e-3  # m


class Up(StrEnum):
    """Axes of a file that may point up."""

    Y = "y"
    Z = "z"


def add_object(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE_OR_FOLDER...",
            help="MJCF, OBJ, STL or GLB files; a folder stands for the models in it.",
        ),
    ],
    into: Annotated[
        Path | None,
        typer.Option(
            help="Folder of models; entries go to its `objects`. Default: the first of "
            "ROBOCELL_MODEL_PATH."
        ),
    ] = None,
    name: Annotated[
        str, typer.Option(help="Name of the kind, for a single file. Default: that of the file.")
    ] = "",
    scale: Annotated[
        float, typer.Option(help="From the units of a mesh file to metres: 0.001 for millimetres.")
    ] = 1.0,
    up: Annotated[
        Up | None, typer.Option(help="Axis of a mesh file that points up. Default: y for GLB.")
    ] = None,
    mass: Annotated[float | None, typer.Option(help="Mass, kg. Default: from the density.")] = None,
    density: Annotated[
        float | None, typer.Option(help=f"Density of a mesh, kg/m^3. Default: {DENSITY:.0f}.")
    ] = None,
    friction: Annotated[
        float | None, typer.Option(help=f"Sliding friction of a mesh. Default: {FRICTION}.")
    ] = None,
    one_hull: Annotated[
        bool, typer.Option("--one-hull", help="One convex hull instead of convex parts.")
    ] = False,
    category: Annotated[str, typer.Option(help="Its category, in the plural.")] = "own",
    colour: Annotated[str, typer.Option(help="Its colour. Default: from the mesh.")] = "",
    material: Annotated[str, typer.Option(help="Its material.")] = "",
    synonym: Annotated[
        list[str] | None, typer.Option(help="Another name. May be given several times.")
    ] = None,
    replace: Annotated[bool, typer.Option("--replace", help="Replace entries.")] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Check and report, and write nothing.")
    ] = False,
) -> None:
    """Add objects to the catalogue, so that tasks draw them by name.

    Each file becomes a folder with an MJCF model, convex parts for
    collisions, words and a picture. It is dropped on a floor, and
    rejected if it does not come to rest or sinks in. Exit code 1 if an
    object was rejected, 2 if an option is wrong.
    """
    _require_positive(scale=scale, density=density, friction=friction, mass=mass)
    sources = [file for given in files for file in _files_of(given)]
    meshes_only = {
        "scale": scale != 1,
        "up": up is not None,
        "mass": mass is not None,
        "density": density is not None,
        "friction": friction is not None,
        "one-hull": one_hull,
    }
    for option in [option for option, given in meshes_only.items() if given]:
        if model := next((file for file in sources if file.suffix.lower() == ".xml"), None):
            fail(f"--{option} is for mesh files; {model} has its own: change it there")
    if name and len(sources) > 1:
        fail(f"--name is for one file, and there are {len(sources)}: leave it out")
    root = _root(into)
    if not re.fullmatch(r"[\w-]+", category):
        fail(f"--category '{category}' is no single word; write it like fruit or power_tools")
    names = [name or _name_of(file) for file in sources]
    for file, kind in zip(sources, names, strict=True):
        _require_name(kind, file, names, root, replace=replace)
    table = Table("kind", "size, mm", "mass, g", "convex parts", "watertight", "rests", box=None)
    rejected = 0
    if any(file.suffix.lower() != ".xml" for file in sources):
        with needed_by("robocell add-object", "objects"):
            import coacd  # noqa: F401
            import trimesh  # noqa: F401
    from robocell._adding.entry import Words

    words = Words(category, colour, material, synonym or [])
    for file, kind in zip(sources, names, strict=True):
        try:
            table.add_row(
                kind,
                *_add(
                    file, kind, root, words,
                    scale=scale, up=up.value if up else "", mass=mass,
                    density=density or DENSITY, friction=friction or FRICTION,
                    split=not one_hull, dry_run=dry_run,
                ),
            )  # fmt: skip
        except Error as error:
            print_error(str(error))
            rejected += 1
        except OSError as error:
            print_error(f"{file}: its entry in {root / 'objects'} cannot be written: {error}")
            rejected += 1
    if table.row_count:
        print_wide(table)
    if table.row_count and not dry_run and str(root) not in models_path():
        print(f"use them with ROBOCELL_MODEL_PATH={root}")
    if rejected:
        fail(f"{counted(rejected, 'object')} rejected", ExitCode.INCOMPLETE)


def models_path() -> list[str]:
    """The absolute folders of ROBOCELL_MODEL_PATH."""
    given = os.environ.get("ROBOCELL_MODEL_PATH", "")
    return [str(Path(folder).resolve()) for folder in given.split(":") if folder]


def _add(
    file: Path,
    kind: str,
    root: Path,
    words: object,
    *,
    scale: float,
    up: str,
    mass: float | None,
    density: float,
    friction: float,
    split: bool,
    dry_run: bool,
) -> list[str]:
    """Makes one entry; returns the cells of its row."""
    from dataclasses import replace as changed

    from robocell._adding.convex import convex_parts
    from robocell._adding.entry import Words, colour_word, write_mesh_entry, write_words
    from robocell._adding.errors import AddObjectError
    from robocell._adding.meshes import read_shape
    from robocell._adding.mjcf import copy_model
    from robocell._adding.settle import settle

    assert isinstance(words, Words)
    objects = root / "objects"
    if not dry_run:
        make_folders(objects)
    with tempfile.TemporaryDirectory(
        prefix=".adding-", dir=None if dry_run else objects
    ) as temporary:
        folder = Path(temporary) / kind
        folder.mkdir()
        parts = watertight = "as in the file"
        if file.suffix.lower() == ".xml":
            copy_model(file, folder, kind)
        else:
            shape = read_shape(file, scale=scale, up=up)
            for lost in shape.lost:
                print_warning(f"{file}: without its {lost}")
            hulls = convex_parts(shape, str(file), split=split)
            words = changed(words, colour=words.colour or colour_word(shape))
            write_mesh_entry(folder, kind, shape, hulls, mass or density * shape.volume, friction)
            parts, watertight = str(len(hulls)), "yes" if shape.is_watertight else "no"
            if not shape.is_watertight and mass is None:
                print_warning(
                    f"{file}: is not watertight: its mass is that of its convex hull; give --mass"
                )
        rest = settle(folder / f"{kind}.xml", folder / f"{kind}.png", str(file))
        if not rest.is_still:
            raise AddObjectError(
                f"{file}: does not come to rest on a floor. Give it a flat foot, or condim 6"
            )
        if rest.penetration > DEEPEST:
            raise AddObjectError(
                f"{file}: sinks {1000 * rest.penetration:.1f} mm into a floor. Is its mass of "
                f"{rest.mass:.3g} kg right? Give --mass or --density"
            )
        write_words(folder, words, rest.size)
        if not dry_run:
            _put(folder, objects / kind)
    stands = "as it is" if rest.tilt < TILTED else f"turned by {rest.tilt:.0f} degrees"
    size = " x ".join(f"{1000 * value:.0f}" for value in rest.size)
    return [size, f"{1000 * rest.mass:.0f}", parts, watertight, stands]


def _put(folder: Path, target: Path) -> None:
    """Renames a new entry; the one that it replaces is deleted after that, with `folder`'s."""
    flush_folder(folder)
    former = folder.parent / ".former"
    is_replaced = target.exists()
    if is_replaced:
        target.rename(former)
    try:
        folder.rename(target)
    except OSError:
        if is_replaced:
            former.rename(target)
        raise
    flush_path(target.parent)


def _files_of(given: Path) -> list[Path]:
    if given.is_dir():
        entries = sorted(given.iterdir())
        found = [file for file in entries if file.suffix.lower() == ".xml"]
        found = found or [file for file in entries if file.suffix.lower() in SUFFIXES]
        if not found:
            fail(f"'{given}' has no model: {', '.join(SUFFIXES)}")
        return found
    if not given.is_file():
        fail(f"no file '{given}'")
    return [given]


def _root(into: Path | None) -> Path:
    if into is not None:
        if into.exists() and not into.is_dir():
            fail(f"--into {into} is no folder")
        return into.resolve()
    if not models_path():
        fail(
            "no folder for objects: give --into FOLDER, or set ROBOCELL_MODEL_PATH to your folder "
            "of models"
        )
    return Path(models_path()[0])


def _name_of(file: Path) -> str:
    return re.sub(r"\W+", "_", file.stem.lower(), flags=re.ASCII).strip("_")


def _require_name(kind: str, file: Path, names: list[str], root: Path, *, replace: bool) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9_]*", kind):
        fail(f"'{kind}' is no name for {file}: it starts with a letter; give --name")
    if names.count(kind) > 1:
        fail(f"two files are called '{kind}': add them one by one, with --name")
    taken = {*models.objects(), *models.equipment(), *models.robots(), *models.scenes()}
    if kind in {*taken, "box", "cylinder", "sphere"}:
        fail(f"'{kind}' is a built-in model: give {file} another --name, such as my_{kind}")
    if kind in object_categories():
        fail(f"'{kind}' is a category of objects: give {file} another --name")
    if (root / "objects" / kind).exists() and not replace:
        fail(f"there is an object '{kind}' in {root / 'objects'}: give --replace, or --name")


def _require_positive(**numbers: float | None) -> None:
    for option, value in numbers.items():
        if value is not None and not 0 < value < float("inf"):
            fail(f"--{option} is {value:g}; it is a number above 0")
