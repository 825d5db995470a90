"""Packages that parts of robocell need and `pip install robocell` does not install.

Each belongs to an extra of pyproject.toml; an error about a missing one names the command.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

# extra -> module -> package
EXTRAS = {
    "envs": {"gymnasium": "gymnasium"},
    "export": {
        "pyarrow": "pyarrow",
        "yaml": "PyYAML",
        "h5py": "h5py",
        "zarr": "zarr",
        "numcodecs": "numcodecs",
    },
    "mcap": {
        "mcap": "mcap",
        "mcap_protobuf": "mcap-protobuf-support",
        "foxglove_schemas_protobuf": "foxglove-schemas-protobuf",
        "google": "protobuf",
        "yaml": "PyYAML",
    },
    "umi": {
        "imagecodecs": "imagecodecs",
        "numcodecs": "numcodecs",
        "zarr": "zarr",
        "yaml": "PyYAML",
    },
    "rerun": {"rerun": "rerun-sdk", "yaml": "PyYAML"},
    "identify": {"scipy": "scipy", "plotly": "plotly"},
    "plots": {"matplotlib": "matplotlib", "plotly": "plotly"},
    "report": {"PIL": "pillow", "jinja2": "Jinja2", "plotly": "plotly", "yaml": "PyYAML"},
    "policy": {"msgpack": "msgpack", "websockets": "websockets", "yaml": "PyYAML"},
    "web": {"websockets": "websockets"},
    "teleop": {
        "websockets": "websockets",
        "evdev": "evdev",
        "hid": "hidapi",
        "yaml": "PyYAML",
    },
    "sb3": {"gymnasium": "gymnasium", "stable_baselines3": "stable-baselines3"},
    "torch": {"torch": "torch"},
    "ray": {"ray": "ray"},
    "molmo-spaces": {"pydantic": "pydantic"},
    "objects": {"coacd": "coacd", "trimesh": "trimesh"},
}

# module -> package, of those that robocell always comes with
REQUIRED = {
    "mujoco": "mujoco",
    "mujoco_menagerie": "mujoco-menagerie",
    "numpy": "numpy",
    "rich": "rich",
    "typer": "typer",
}


def needed_modules() -> set[str]:
    """Returns the names of all modules that robocell, or a part of it, imports."""
    return {*REQUIRED, *(module for modules in EXTRAS.values() for module in modules)}


def install_command(extra: str) -> str:
    """Returns the command that installs an extra's packages.

    A checkout is not installed, so pip would look for robocell itself, which no index has.
    """
    import importlib.metadata  # takes as long as a tenth of robocell

    try:
        importlib.metadata.distribution("robocell")
    except importlib.metadata.PackageNotFoundError:
        return f"pip install {' '.join(EXTRAS[extra].values())}"
    return f"pip install 'robocell[{extra}]'"


@contextmanager
def needed_by(user: str, extra: str, otherwise: str = "") -> Iterator[None]:
    """Context manager for imports of an extra's packages: the error names the pip command.

    Args:
        user: The module that needs them, such as "robocell.gym".
        extra: A key of `EXTRAS`.
        otherwise: A sentence on what works without them.

    Raises:
        ModuleNotFoundError: A package of the extra is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = EXTRAS[extra].get((error.name or "").partition(".")[0])
        if package is None:
            raise
        message = (
            f"{user} needs the package {package}, which is not installed: {install_command(extra)}"
        )
        if otherwise:
            message += f". {otherwise}"
        raise ModuleNotFoundError(message, name=error.name) from None
