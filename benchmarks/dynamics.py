"""P6: Jacobian, gravity torques and mass matrix beside KDL, the engine and Pinocchio.

Ours, KDL's and the engine's: dynamics_bench.cc. It writes the arms, configurations and answers for
Pinocchio's, in a process of its own: pinocchio_peer.cc, compiled here.
"""

from __future__ import annotations

import subprocess
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from bench_program import ROOT, scaled, seconds
from ik import PACKAGES, interpreter
from instruction_set import compiler_flags
from robots import robot_files
from table import Row

ROUNDS, REPETITIONS = 3, 3  # of both programs in turn, and in each of their runs
# The program of the peer, and what it includes.
SOURCES = [Path(__file__).with_name(name) for name in ("pinocchio_peer.cc", "sides.h", "numbers.h")]
# Those of the package's CMake target pinocchio::pinocchio_headers.
DEFINITIONS = (
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)


def flags() -> tuple[str, ...]:
    """What that program is compiled with."""
    return ("-O3", *compiler_flags(), "-DNDEBUG")


def pinocchio_peer(folder: Path) -> Path | None:
    """Pinocchio's program, compiled unless it is there; None, having said why, if it cannot be."""
    python = interpreter("Pinocchio")
    if python is None:
        return None
    environment = python.parents[1]
    program = folder / "".join(["pinocchio_peer", *compiler_flags()])
    made_from = (*SOURCES, Path(__file__), environment / "ready")
    newest = max(file.stat().st_mtime for file in made_from)
    if program.exists() and program.stat().st_mtime > newest:
        return program
    try:
        compile_peer(environment, program)
    except subprocess.CalledProcessError as error:
        print(f"left out: Pinocchio: `{error.cmd[0]}` failed for its program:\n{error.stderr}")
        return None
    return program


def compile_peer(environment: Path, program: Path) -> None:
    """Against the headers of the wheel that is installed there, and the system's Eigen."""
    [headers] = environment.glob("lib/python3*/site-packages/cmeel.prefix/include")
    eigen = command("pkg-config", "--cflags-only-I", "eigen3").split()
    words = ["-std=c++20", "-w", *flags(), *DEFINITIONS, *eigen]
    libraries = ["-lbenchmark", "-pthread"]
    command("c++", *words, "-isystem", headers, SOURCES[0], "-o", program, *libraries)


def command(*words: str | Path) -> str:
    """The standard output of a command that must succeed."""
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def asked(file: Path, folder: Path) -> Path:
    """What a peer in another process needs to know of a robot's arm; named as the rows have it."""
    into = folder / f"{file.stem}.arm"
    program = ROOT / "build" / "release" / "dynamics_bench"
    subprocess.run([program, "--ask", into, file], check=True)
    return into


def measure(folder: Path) -> dict[str, dict[str, list[float]]]:
    """Row -> side -> seconds of each repetition."""
    files = robot_files()
    programs: list[tuple[str | Path, Sequence[Path]]] = [("dynamics_bench", files)]
    if peer := pinocchio_peer(folder):
        programs.append((peer, [asked(file, folder) for file in files]))
    measured: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for _ in range(ROUNDS):
        for program, arguments in programs:
            once = seconds(program, arguments, folder, repetitions=REPETITIONS)
            for what, sides in once.items():
                for side, values in sides.items():
                    measured[what][side] += values
    return measured


def note(peer: str) -> str:
    """What a reader must know of a peer's numbers."""
    text = f"a configuration; peer: {peer}, one at a time"
    if peer == "Pinocchio":
        version = PACKAGES[peer].partition("==")[2]
        text += f"; {version} in C++, {' '.join(flags())}, Eigen of the system"
    return text


def rows(folder: Path) -> list[Row]:
    """One row per robot, quantity and peer, one configuration at a time and as a batch."""
    measured = measure(folder)
    result: list[Row] = []
    for what, sides in measured.items():
        # Pinocchio has no batch: what it needs for one.
        one = measured[what.replace(", batch", "")]
        for peer, values in {**one, **sides}.items():
            if peer != "robocell":
                ours, theirs = scaled(sides["robocell"], 1e9), scaled(values, 1e9)
                result.append(Row(what, "ns", ours, theirs, note=note(peer)))
    return result
