"""`robocell convert`: from URDF to MJCF."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import _core
from robocell._cli.common import PACKAGE_OPTION, ExitCode, declare_packages, fail


def convert(
    model: Annotated[Path, typer.Argument(metavar="MODEL.urdf", help="The robot's URDF.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The MJCF. Default: the name of the URDF, here."),
    ] = None,
    package: Annotated[list[str] | None, PACKAGE_OPTION] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
) -> None:
    """Write the MJCF of a URDF.

    Fixed links stay bodies, mimic joints become equalities, efforts become force limits, and every
    joint that nothing else moves gets a position servo. Robot files read URDFs too: convert one to
    change what `edits` cannot.
    """
    declare_packages(package)
    if not model.is_file():
        near = ", ".join(sorted(str(file) for file in model.parent.glob("*.urdf"))[:8])
        fail(f"no URDF '{model}'.{' There: ' + near if near else ''}")
    file = output or Path(f"{model.stem}.xml")
    if not file.parent.is_dir():
        fail(f"cannot write '{file}': there is no folder '{file.parent}'", ExitCode.OUTPUT)
    if file.exists() and not force:
        fail(f"'{file}' exists. Replace it with --force, or give another name with -o")
    text, notes = _core.urdf_to_mjcf(str(model), str(file.absolute().parent))
    _core.atomic_write(file, text.encode())
    for note in notes:
        print(f"note: {note}")
    print(f"wrote {file}. Next: robocell init {file}")
