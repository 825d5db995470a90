"""A worker without simulation, for tests of the supervisor.

    python fake_worker.py FOLDER '{"e1": ["kill", "make"], "e2": ["hang"]}'

An item does what its list says, one entry per try, the last one again and again; `make` when it is
not listed. An episode is a folder of its id. FOLDER/tries has a line per try, `<id> <pid> <turn>`,
FOLDER/hangs one for each item that hangs.
"""

from __future__ import annotations

import asyncio
import ctypes
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from robocell import IoError, SpecError
from robocell._generation.items import Item, ItemRecord
from robocell._generation.supervisor import TURN_VARIABLE
from robocell._generation.worker import serve


class Stop:
    """Stands in for robocell.generate.StopFlag."""

    def __init__(self) -> None:
        self.event = threading.Event()

    def set(self) -> None:
        """Asks the present episode to end."""
        self.event.set()


def tries_of(folder: Path) -> list[str]:
    """The ids tried, in order."""
    path = folder / "tries"
    return [line.split()[0] for line in path.read_text().splitlines()] if path.exists() else []


def hangs_of(folder: Path) -> int:
    """How many items hang, or hung."""
    path = folder / "hangs"
    return len(path.read_text().splitlines()) if path.exists() else 0


def made(folder: Path, item: Item, **values: object) -> ItemRecord:
    """Commits the episode; FileExistsError when there is one."""
    (folder / item.id).mkdir()
    return result_of(item.id)


def result_of(name: str) -> ItemRecord:
    """Of an item that was made."""
    return ItemRecord(name, success=True, attempts=2, accepted=1, refusals={"too far": 1}, rows=9)


class Maker:
    """Makes the episodes of a folder as the script says."""

    FORKED_S = 60.0  # how long a forked child lives

    def __init__(self, folder: Path, script: dict[str, list[str]], stop: Stop) -> None:
        self.folder, self.script, self.stop = folder, script, stop

    def __call__(self, item: Item) -> ItemRecord:
        """One item."""
        before = tries_of(self.folder).count(item.id)
        with (self.folder / "tries").open("a") as file:
            file.write(f"{item.id} {os.getpid()} {os.environ.get(TURN_VARIABLE)}\n")
        acts = self.script.get(item.id, self.script.get("*", ["make"]))
        return self.act(acts[min(before, len(acts) - 1)], item)

    def act(self, what: str, item: Item) -> ItemRecord:
        """One behaviour."""
        match what:
            case "kill":
                print("about to die", flush=True)
                os.kill(os.getpid(), signal.SIGKILL)
            case "commit, kill":
                made(self.folder, item)
                os.kill(os.getpid(), signal.SIGKILL)
            case "commit, io":  # as when the folder of the dataset cannot be flushed
                made(self.folder, item)
                raise IoError(f"'{item.id}' is in place, but a power cut may still undo that")
            case "hang":
                with (self.folder / "hangs").open("a") as file:
                    file.write(f"{item.id}\n")
                time.sleep(1000)
            case "crash":
                print("about to crash", flush=True)
                ctypes.string_at(0)
            case "patient":  # works until it is stopped
                self.stop.event.wait(1000)
                failures = {"dropped": 3}
                return ItemRecord(
                    item.id, stopped=True, undecided=1, attempts=3, accepted=3, failures=failures
                )
            case "slow":
                time.sleep(0.3)
            case "fail":
                failures = {"dropped": 3, "not lifted": 2}
                return ItemRecord(item.id, attempts=6, accepted=5, failures=failures)
            case "raise":
                raise ValueError("a bug")
            case "exit":
                sys.exit(0)
            case "fork, kill":
                if os.fork() == 0:
                    time.sleep(self.FORKED_S)
                    os._exit(0)
                os.kill(os.getpid(), signal.SIGKILL)
            case "fork in C, kill":  # where Python cannot close the pipe in the child
                if ctypes.PyDLL(None).fork() == 0:
                    time.sleep(self.FORKED_S)
                    os._exit(0)
                os.kill(os.getpid(), signal.SIGKILL)
            case "spec":
                raise SpecError("camera 'wirst': no such camera. Did you mean 'wrist'?")
            case "io":
                raise IoError("cannot write 'steps.h5': No space left on device")
            case "read":
                assert sys.stdin.read() == ""
                subprocess.run(["cat"], check=True, timeout=self.FORKED_S)
            case "cancel":
                raise asyncio.CancelledError("late")
            case "print":
                print("chatter of a library", flush=True)
                os.system("echo chatter of a child")
        return made(self.folder, item)


def main() -> int:
    """As a worker process."""
    folder, script, stop = Path(sys.argv[1]), json.loads(sys.argv[2]), Stop()

    def open_maker() -> Maker:
        if "refuse" in script:
            raise SpecError("run.yaml:3:1: no field 'tsak'. Did you mean 'task'?")
        if "crash" in script:
            print("libGL is missing", file=sys.stderr)
            os._exit(7)
        return Maker(folder, script, stop)

    return serve(open_maker, stop)


if __name__ == "__main__":
    sys.exit(main())
