"""Fetches robots of the MuJoCo Menagerie, and pins their versions.

Robots come through the package ``mujoco-menagerie`` into its cache, where ``menagerie:`` names find
them. What was fetched is written down in a record: the Menagerie's commit, the robot's version, the
package's, and a hash of every file. A robot that is in the record stays at that version until it is
asked to be updated, and a file that has changed is an error.
"""

from __future__ import annotations

import contextlib
import dataclasses
import fcntl
import hashlib
import json
import os
import pwd
import shutil
import tarfile
import threading
import uuid
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from robocell._core import ArgumentError, IoError, NotFoundError, atomic_write

RECORD = "menagerie.json"
# Those that the examples use.
EXAMPLE_ROBOTS = (
    "ufactory_xarm7",
    "kinova_gen3",
    "robotiq_2f85",
    "franka_fr3",
    "franka_emika_panda",
)
VERSION_DIGITS = 16  # of the tree's id, in the names of the cache's folders
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Pin:
    """One version of a robot.

    Attributes:
        commit: Commit of the Menagerie from which the package's registry was made.
        tree: The git tree id of the robot's folder: its version.
        package: Version of mujoco-menagerie that fetched it.
        files: Path in the robot's folder -> SHA-256.
    """

    commit: str
    tree: str
    package: str
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Fetched:
    """A robot that is on this machine.

    Attributes:
        folder: Where its files are.
        pin: Its version.
        newer: The installed package has another version than the record.
    """

    robot: str
    folder: Path
    pin: Pin
    newer: bool = False


def record_path() -> Path:
    """Returns the path of the cache's record, which is not in the package's own folder."""
    return _user_cache() / "robocell" / RECORD


def read_record(path: Path) -> dict[str, Pin]:
    """Returns robot -> Pin, empty without a fetch. Raises IoError if the file is not a record."""
    try:
        entries = json.loads(path.read_text())["robots"]
        return {robot: Pin(**pin) for robot, pin in entries.items()}
    except FileNotFoundError:
        return {}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise IoError(
            f"{path} is not a record of fetched robots ({error}); move it away and fetch again"
        ) from error


def write_record(path: Path, record: dict[str, Pin]) -> None:
    """Writes the record atomically, robots in the order of their names."""
    robots = {robot: dataclasses.asdict(pin) for robot, pin in sorted(record.items())}
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(path, (json.dumps({"robots": robots}, indent=1) + "\n").encode())


@contextlib.contextmanager
def _changing(path: Path) -> Iterator[None]:
    """Locks a record and its files against other processes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_name(f".{path.name}.lock").open("ab") as lock:
        with contextlib.suppress(OSError):  # a file system without locks: as well as it goes
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _pin(path: Path, robot: str, pin: Pin) -> None:
    """Adds a robot to the present record, which others may have changed. The caller locks it."""
    record = read_record(path)
    if record.get(robot) != pin:
        write_record(path, {**record, robot: pin})


def main_file(robot: str) -> str:
    """Returns a robot's main model file. Raises NotFoundError without the package or robot."""
    try:
        entry = _package().get(robot)
    except _package().MenagerieError as error:
        raise NotFoundError(str(error)) from None
    file: str = entry.entry(entry.default_model).file
    return file


def printed_progress() -> Progress:
    """Returns the progress bar of downloads. Raises NotFoundError without the package."""
    draw: Progress = _package().print_progress
    return draw


def fetch(robot: str, *, update: bool = False, progress: Progress | None = None) -> Fetched:
    """Downloads a robot into the cache unless it exists, and records it.

    Args:
        robot: Its name in the Menagerie, such as ``"kinova_gen3"``.
        update: Use the installed package's version if the record has another.
        progress: Called with (robot, bytes done, bytes in all).

    Raises:
        NotFoundError: There is no such robot, or the recorded version is not available.
        IoError: The download failed, or its files differ from the recorded ones.
    """
    known = _package().get
    try:
        entry = known(robot)
    except _package().MenagerieError as error:
        raise NotFoundError(
            f"{error}{_with_in_name(robot)} `robocell fetch --list` lists all robots."
        ) from None
    pin = read_record(record_path()).get(robot)
    if pin and pin.tree != entry.oid and not update:
        return _as_recorded(robot, pin)
    folder = _download(entry, progress)
    pin = Pin(_package().commit(), entry.oid, _package().__version__, _hashes(folder))
    require_unchanged(robot, folder, _published(folder))
    with _changing(record_path()):
        _pin(record_path(), robot, pin)
    return Fetched(robot, folder, pin)


def copy_to(fetched: Fetched, root: Path, *, update: bool = False) -> Path:
    """Copies a fetched robot to ``root/<robot>``, which is then a MENAGERIE_ROOT, with a record.

    An identical copy stays. Raises ArgumentError for a different one, unless `update`.
    """
    target = root / fetched.robot
    with _changing(root / RECORD):
        if not _is_same(fetched, target, update=update):
            _replace(target, fetched.folder)
        _pin(root / RECORD, fetched.robot, fetched.pin)
    return target


def _is_same(fetched: Fetched, target: Path, *, update: bool) -> bool:
    """Returns True if there is nothing to copy. Raises ArgumentError like `copy_to`."""
    if not target.exists():
        return False
    same = _hashes(target) == fetched.pin.files
    if not same and not update:
        raise ArgumentError(
            f"{target} exists and holds other files; fetch with --update to replace it"
        )
    return same


def _replace(target: Path, source: Path) -> None:
    """Puts a copy of a folder there. An existing folder is moved aside first and deleted last."""
    part, old = (target.with_name(f".{target.name}.{uuid.uuid4().hex}") for _ in range(2))
    try:
        shutil.copytree(source, part, ignore=shutil.ignore_patterns(".complete"))
        if target.exists():
            target.rename(old)
        part.rename(target)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        if old.exists() and not target.exists():
            old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)


def require_unchanged(robot: str, folder: Path, files: dict[str, str]) -> None:
    """Raises IoError with the files that differ from the record."""
    have = _hashes(folder)
    wrong = sorted(file for file in files if have.get(file) != files[file])
    if wrong:
        more = f" and {len(wrong) - 3} more" if len(wrong) > 3 else ""
        raise IoError(
            f"robot '{robot}' is not what was fetched: {', '.join(wrong[:3])}{more} changed in "
            f"{folder}; delete that folder and fetch it again"
        )


def known_robots() -> list[Any]:
    """Returns all robots of the installed registry, without network."""
    robots: list[Any] = _package().robots()
    return robots


def robots_like(words: Sequence[str]) -> list[Any]:
    """Returns the `known_robots` with one of the words in their names; without words all."""
    return [
        robot
        for robot in known_robots()
        if not words or any(word.lower() in robot.name.lower() for word in words)
    ]


def _with_in_name(word: str) -> str:
    """Returns ' With 'kuka' in the name: kuka_iiwa_14.', or ""."""
    names = [robot.name for robot in robots_like([word])] if word else []
    return f" With '{word}' in the name: {', '.join(names)}." if names else ""


def cached_folder(robot: str, tree: str) -> Path:
    """Returns the folder of a version of a robot in the cache, which need not exist."""
    return Path(_cache().dir) / "models" / f"{robot}-{tree[:VERSION_DIGITS]}"


def is_here(robot: str, tree: str) -> bool:
    """Returns True if the cache has a version of a robot."""
    return (cached_folder(robot, tree) / ".complete").is_file()


def _as_recorded(robot: str, pin: Pin) -> Fetched:
    """Returns the version of the record, which the installed package does not have."""
    if not is_here(robot, pin.tree):
        package = "mujoco-menagerie"
        raise NotFoundError(
            f"robot '{robot}' is pinned to its version of Menagerie commit {pin.commit[:12]}, "
            f"which is not in the cache, and {package} {_package().__version__} has another; get "
            f"the pinned one with `pip install {package}=={pin.package}`, or this one with --update"
        )
    folder = cached_folder(robot, pin.tree)
    require_unchanged(robot, folder, pin.files)
    return Fetched(robot, folder, pin, newer=True)


def _download(entry: Any, progress: Progress | None) -> Path:
    cache = _cache()
    try:
        with _extraction():
            return Path(entry.path(cache, progress))
    except (_package().MenagerieError, OSError) as error:
        raise IoError(
            f"robot '{entry.name}' could not be fetched: {error}. Without a network: copy "
            f"{cache.dir} from a machine that has it, or set MENAGERIE_ROOT to a checkout of "
            "mujoco_menagerie"
        ) from error


_EXTRACTING = threading.Lock()


@contextlib.contextmanager
def _extraction() -> Iterator[None]:
    """Lets Python unpack archives if it has no filters for that (before 3.11.4).

    The package requests the filter `data`. Like that filter, this function rejects links, devices
    and names outside the folder, which the archives do not need.
    """
    if hasattr(tarfile, "data_filter"):
        yield
        return
    with _EXTRACTING:  # threads share what is put in its place
        yield from _extraction_without_filters()


def _extraction_without_filters() -> Iterator[None]:
    plain = tarfile.TarFile.extractall

    def extractall(tar: tarfile.TarFile, path: str | Path = ".", **_: Any) -> None:
        for member in tar:
            parts = PurePosixPath(member.name)
            inside = not parts.is_absolute() and ".." not in parts.parts
            if not inside or not (member.isfile() or member.isdir()):
                raise OSError(f"the archive holds '{member.name}', which is not a plain file in it")
        plain(tar, path)

    tarfile.TarFile.extractall = extractall  # type: ignore[method-assign,assignment]
    try:
        yield
    finally:
        tarfile.TarFile.extractall = plain  # type: ignore[method-assign]


def _published(folder: Path) -> dict[str, str]:
    """Returns the hashes that the package wrote down when it unpacked a robot."""
    files: dict[str, str] = json.loads((folder / ".complete").read_text())["files"]
    return files


def _hashes(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".complete"
    }


def _cache() -> Any:
    """Returns the package's cache, the target of fetching, also if MENAGERIE_ROOT is set."""
    cache = _package().Cache()
    cache.root = None
    return cache


def _package() -> Any:
    try:
        import mujoco_menagerie
    except ImportError:
        raise NotFoundError(
            "robots are fetched by the package mujoco-menagerie, which is not installed: "
            "pip install mujoco-menagerie"
        ) from None
    return mujoco_menagerie


def _user_cache() -> Path:
    if cache := os.environ.get("XDG_CACHE_HOME"):
        return Path(cache)
    home = os.environ.get("HOME", "")
    if not home:  # as the library looks it up
        with contextlib.suppress(KeyError):  # a user of a container may be in no list
            home = pwd.getpwuid(os.getuid()).pw_dir
    return Path(home or "/") / ".cache"
