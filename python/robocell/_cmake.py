"""Locates robocell's CMake files for C++ users of the Python package."""

from __future__ import annotations

from pathlib import Path

from robocell._build_tree import build_folder


def cmake_dir() -> str:
    """Returns the folder with robocellConfig.cmake.

    In a wheel it is in the package; in a checkout it is the build folder, ``build/release`` unless
    the variable ``ROBOCELL_BUILD`` names another. ``find_package(robocell)`` of CMake takes it as
    ``robocell_DIR``::

        cmake -B build -Drobocell_DIR="$(python -c 'import robocell; print(robocell.cmake_dir())')"

    Raises:
        FileNotFoundError: The package was installed without CMake files, or the checkout is not
            built.
    """
    package = Path(__file__).resolve().parent
    places = [package / "lib" / "cmake" / "robocell"]
    if folder := build_folder():
        places = [folder]
    for place in places:
        if (place / "robocellConfig.cmake").is_file():
            return str(place)
    looked = ", ".join(str(place) for place in places)
    raise FileNotFoundError(
        f"no robocellConfig.cmake. Looked in: {looked}. In a checkout, run `make build`."
    )
