"""Where C++ users of the Python package find robocell's CMake files."""

from __future__ import annotations

from pathlib import Path


def cmake_dir() -> str:
    """The folder with robocellConfig.cmake.

    In a wheel it lies in the package; in a checkout it is ``build/release``. CMake's
    ``find_package(robocell)`` looks there when it is told so::

        cmake -B build -Drobocell_DIR="$(python -c 'import robocell; print(robocell.cmake_dir())')"

    Raises:
        FileNotFoundError: the package was installed without them, or the checkout is not built.
    """
    package = Path(__file__).resolve().parent
    places = [package / "lib" / "cmake" / "robocell", package.parents[1] / "build" / "release"]
    for place in places:
        if (place / "robocellConfig.cmake").is_file():
            return str(place)
    looked = ", ".join(str(place) for place in places)
    raise FileNotFoundError(
        f"no robocellConfig.cmake. Looked in: {looked}. In a checkout, run `make build`."
    )
