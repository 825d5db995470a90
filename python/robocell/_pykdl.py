"""Commands that make PyKDL importable on this system.

`remedy` is what the core prints when `import PyKDL` fails, and what `robocell doctor` prints.
"""

from __future__ import annotations

import re
import shutil
import sys
import sysconfig
from pathlib import Path

PACKAGE = "python3-pykdl"
SYSTEM_MODULES = Path("/usr/lib/python3/dist-packages")
# The library that the module needs; apt-get install brings it along, unpacking does not.
LIBRARY_PACKAGE = "liborocos-kdl1.5"
LIBRARY = "liborocos-kdl.so.1.5"
SYSTEM_LIBRARIES = Path("/usr/lib")
SYSTEM_PYTHON = Path("/usr/bin/python3")


def module_file() -> Path:
    """Returns the path where Debian and Ubuntu install PyKDL for this Python version."""
    return SYSTEM_MODULES / f"PyKDL{sysconfig.get_config_var('EXT_SUFFIX')}"


def system_version() -> str:
    """Returns the version of the system's Python, such as "3.11"; "" without one."""
    version = re.fullmatch(r"python(3\.\d+)", SYSTEM_PYTHON.resolve().name)
    return version[1] if version else ""


def remedy() -> str:
    """Returns the commands that make `import PyKDL` work in the running Python."""
    here = f"{sys.version_info.major}.{sys.version_info.minor}"
    file = module_file()
    in_venv = sys.prefix != sys.base_prefix
    site = sysconfig.get_path("platlib")
    if file.exists():
        return f"The system has it; link it into this environment: ln -s {file} {site}/"
    if not shutil.which("apt-get"):
        return (
            f"Build PyKDL (python_orocos_kdl of orocos_kinematics_dynamics) for Python {here} and "
            f"put the module into {site}"
        )
    if system_version() != here:
        return (
            f"The package {PACKAGE} is for the system's Python {system_version() or '3'}, and this "
            f"is Python {here}. Create the environment with {SYSTEM_PYTHON} -m venv and install "
            "robocell there"
        )
    link = f" && ln -s {file} {site}/" if in_venv else ""
    without_root = _unpacking(file, _writable_site(site, in_venv))
    return f"Install it: sudo apt-get install {PACKAGE}{link}\nWithout root: {without_root}"


def _unpacking(file: Path, site: str) -> str:
    """Returns the commands that put the module, and KDL's library if missing, into `site`."""
    library = f"pykdl{SYSTEM_LIBRARIES}/*/{LIBRARY}"
    if any(SYSTEM_LIBRARIES.glob(f"*/{LIBRARY}")):
        return (
            f"cd /tmp && apt-get download {PACKAGE} && dpkg-deb -x {PACKAGE}_*.deb pykdl "
            f"&& mkdir -p {site} && cp pykdl{file} {site}/"
        )
    return (
        f"cd /tmp && apt-get download {PACKAGE} {LIBRARY_PACKAGE} "
        f"&& dpkg-deb -x {PACKAGE}_*.deb pykdl && dpkg-deb -x {LIBRARY_PACKAGE}_*.deb pykdl "
        f"&& mkdir -p {site} && cp pykdl{file} {library} {site}/ "
        # Python runs that line as it starts, so that the module finds the library loaded.
        f"&& echo 'import ctypes; ctypes.CDLL(\"{site}/{LIBRARY}\")' > {site}/pykdl.pth"
    )


def _writable_site(site: str, in_venv: bool) -> str:
    if in_venv:
        return site
    return sysconfig.get_path("platlib", "posix_user")
