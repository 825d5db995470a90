"""scripts/setup on a machine made of stand-ins: what it installs, asks for, and leaves alone."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
COMMAND = "sudo apt-get update && sudo apt-get install -y --no-install-recommends "
STAND_INS = {
    "id": "echo $(cat user)",
    "sudo": """[ -e sudo-works ] || exit 1
        shift  # -n
        exec "$@" """,
    "dpkg-query": "sed 's/^/installed /' installed",
    "apt-cache": """case " $(cat unknown) " in
        *" $2 "*) echo '  Candidate: (none)';;
        *) echo '  Candidate: 1.0';;
        esac""",
    "apt-get": """echo "apt-get $*" >>calls
        [ ! -e broken ] || exit 100
        for word in "$@"; do
            case "$word" in
            -*|*=*|install|update) ;;
            *) echo "$word" >>installed;;
            esac
        done""",
    "python": f"""case "$*" in
        '-m pip --version') exit 0;;
        '-m pip config'*) cat index 2>/dev/null; exit;;
        '-m pip install'*) echo "pip $*" >>calls; exit 0;;
        -c*get_path*) echo "$PWD/site"; exit 0;;
        esac
        exec {sys.executable} "$@" """,
    "uv": """echo "uv $*" >>calls
        [ ! -e uv-broken ] || exit 2""",
}


def lines() -> list[str]:
    """Of the list of packages, without comments."""
    text = re.sub(r"#.*", "", (ROOT / "scripts/packages.txt").read_text())
    return [line.strip() for line in text.splitlines() if line.strip()]


# The first of each line's names.
REQUIRED = [line.split(" | ")[0] for line in lines() if not line.startswith("?")]
OPTIONAL = [line[1:].split(" | ")[0] for line in lines() if line.startswith("?")]


class Machine:
    """A checkout with only what scripts/setup reads, and stand-ins for what it calls."""

    def __init__(self, folder: Path):
        self.root = folder / "checkout"
        self.state = folder / "state"
        (self.root / "scripts").mkdir(parents=True)
        for file in ("setup", "packages.txt", "requirements.txt", "constraints.txt"):
            shutil.copy(ROOT / "scripts" / file, self.root / "scripts" / file)
        shutil.copy(ROOT / "pyproject.toml", self.root)
        (self.state / "site").mkdir(parents=True)
        for name, body in STAND_INS.items():
            place = folder / "bin" / name
            if name in ("python", "uv"):
                place = self.root / ".venv/bin" / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(f"#!/bin/sh\ncd {self.state}\n{body}\n")
            place.chmod(0o755)
        self.path = f"{folder / 'bin'}:/usr/bin:/bin"
        self.write("calls", "")
        self.write("unknown", "")
        self.write("user", "1000")
        self.has(*REQUIRED, *OPTIONAL)

    def write(self, name: str, text: str) -> None:
        (self.state / name).write_text(text)

    def has(self, *packages: str) -> None:
        """What is installed."""
        self.write("installed", "".join(f"{name}\n" for name in packages))

    def has_all_but(self, *packages: str) -> None:
        self.has(*(name for name in [*REQUIRED, *OPTIONAL] if name not in packages))

    def calls(self) -> list[str]:
        """Of apt-get, pip and uv, since the last time."""
        calls = (self.state / "calls").read_text().splitlines()
        self.write("calls", "")
        return calls

    def setup(self, *arguments: str) -> tuple[int, str, str]:
        """Exit code, standard output, standard error."""
        run = subprocess.run(
            [self.root / "scripts/setup", *arguments],
            env={"PATH": self.path, "HOME": str(self.state)},
            capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
        return run.returncode, run.stdout, run.stderr


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    return Machine(tmp_path)


def test_installs_python_packages_once(machine: Machine):
    code, out, err = machine.setup()
    assert (code, err) == (0, "")
    assert "setup: ready" in out
    pip, uv = machine.calls()
    assert re.fullmatch(r"pip -m pip install .* uv==[0-9.]+", pip)
    assert uv.startswith("uv pip install")
    assert "--requirement scripts/requirements.txt --constraint scripts/constraints.txt" in uv
    assert "index" not in uv
    in_place = machine.state / "site/robocell-in-place.pth"
    assert in_place.read_text().strip() == str(machine.root / "python")
    code, out, err = machine.setup()
    assert (code, machine.calls(), err) == (0, [], ""), "a second run installs nothing"
    assert re.fullmatch(r"(setup: note: no PyKDL.*\n)?setup: ready \(\d+ s\)\n", out)
    requirements = machine.root / "scripts/requirements.txt"
    requirements.write_text(requirements.read_text() + "another\n")
    assert machine.setup()[0] == 0
    assert len(machine.calls()) == 2, "until the list changes"


def test_each_command_of_the_package_can_be_called(machine: Machine):
    machine.setup()
    commands = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    assert set(commands) >= {"robocell", "mj-kdl-fetch-menagerie"}
    for command in commands:
        mine = machine.root / ".venv/bin" / command
        said = subprocess.run(
            [mine, "--help"], env={"PATH": machine.path, "PYTHONPATH": str(ROOT / "python")},
            capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
        assert said.returncode == 0, said.stderr
        assert "--dest" in said.stdout or "generate" in said.stdout


def test_uv_uses_the_package_index_of_pip(machine: Machine):
    machine.write("index", "https://mirror.example/simple\n")
    assert machine.setup()[0] == 0
    assert " --default-index https://mirror.example/simple " in machine.calls()[1]


def test_falls_back_to_pip_when_uv_fails(machine: Machine):
    machine.write("uv-broken", "")
    code, _out, err = machine.setup()
    assert (code, err) == (0, "")
    _, uv, pip = machine.calls()
    assert uv.startswith("uv pip install")
    assert pip.startswith("pip -m pip install")
    assert "--requirement scripts/requirements.txt --constraint scripts/constraints.txt" in pip


def test_without_permission_it_prints_the_command_and_stops(machine: Machine):
    machine.has_all_but("cmake", "libeigen3-dev", "libosmesa6")
    for _ in range(2):
        code, out, err = machine.setup()
        assert code == 3
        assert out == ""
        assert err.splitlines() == [
            "setup: system packages are missing, and this user may not install them. Run:",
            f"  {COMMAND}cmake libeigen3-dev libosmesa6",
            "then run the same command again.",
        ]
        assert machine.calls() == []
    machine.has(*REQUIRED, *OPTIONAL)  # as the command does
    assert machine.setup()[0] == 0


def test_installs_the_alternative_that_the_package_manager_knows(machine: Machine):
    alternatives = next(line for line in lines() if " | " in line).lstrip("?").split(" | ")
    machine.has_all_but("cmake", alternatives[0])
    machine.write("unknown", alternatives[0])
    assert f"  {COMMAND}cmake {alternatives[1]}\n" in machine.setup()[2]
    machine.write("unknown", " ".join(alternatives))
    assert f"  {COMMAND}cmake\n" in machine.setup()[2]


def test_optional_packages_are_reported_once(machine: Machine):
    machine.has_all_but("libosmesa6")
    code, out, err = machine.setup()
    assert (code, err) == (0, "")
    assert "setup: optional system packages are missing; what needs them will say so. To " in out
    assert f"setup:   {COMMAND}libosmesa6\n" in out
    code, out, err = machine.setup()
    assert code == 0
    assert "libosmesa6" not in out


@pytest.mark.parametrize("who", ["root", "sudo"])
def test_installs_missing_packages_with_permission(machine: Machine, who: str):
    if who == "root":
        machine.write("user", "0")
    else:
        machine.write("sudo-works", "")
    machine.has_all_but("cmake", "libeigen3-dev", "libosmesa6")
    code, out, err = machine.setup()
    assert (code, err) == (0, "")
    assert "setup: installing cmake libeigen3-dev\n" in out
    update, required, optional, *_ = machine.calls()
    assert update.endswith(" update")
    assert required.endswith(" install -y --no-install-recommends cmake libeigen3-dev")
    assert optional.endswith(" install -y --no-install-recommends libosmesa6")
    assert machine.setup()[0] == 0
    assert machine.calls() == []


def test_reports_a_failed_installation(machine: Machine):
    machine.write("user", "0")
    machine.write("broken", "")
    machine.has_all_but("cmake")
    code, _, err = machine.setup()
    assert (code, err) == (1, "setup: apt-get update failed; see its message above\n")


def test_check_lists_missing_packages_and_installs_nothing(machine: Machine):
    machine.write("user", "0")
    machine.has_all_but("cmake", "libeigen3-dev", "libosmesa6")
    code, out, err = machine.setup("--check")
    assert (code, err) == (1, "setup: not ready; run scripts/setup\n")
    assert "setup: system packages missing: cmake libeigen3-dev\n" in out
    assert "setup: optional system packages missing: ?libosmesa6\n" in out
    assert "setup: Python packages in .venv are missing or out of date\n" in out
    assert machine.calls() == []
    assert not (machine.root / "build").exists()
    shutil.rmtree(machine.root / ".venv")
    machine.has(*REQUIRED, *OPTIONAL)
    code, out, err = machine.setup("--check")
    assert (code, out) == (1, "setup: .venv is missing\n")
    assert not (machine.root / ".venv").exists()


def test_check_of_a_machine_that_is_ready_passes(machine: Machine):
    machine.setup()
    code, out, err = machine.setup("--check")
    assert (code, err) == (0, "")
    assert re.fullmatch(r"setup: ready \(\d+ s\)\n", out)


def test_rejects_unknown_arguments(machine: Machine):
    assert machine.setup("--chekc") == (2, "", "usage: scripts/setup [--check]\n")
    assert machine.calls() == []


def test_a_list_of_packages_has_names_that_apt_understands():
    names = [name for line in lines() for name in line.lstrip("?").split(" | ")]
    assert [name for name in names if not re.fullmatch(r"[a-z0-9][a-z0-9+.-]+", name)] == []
