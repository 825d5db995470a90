"""LeRobot as a peer, in an environment of its own."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

PEER = "lerobot==0.4.4"


def peer_python(folder: Path) -> Path | None:
    """The interpreter of the peer's environment, made once; None where LeRobot does not install."""
    place = folder / "peers" / "lerobot"
    python, ready = place / "bin" / "python", place / "ready"
    if not ready.exists():
        shutil.rmtree(place, ignore_errors=True)
        subprocess.run([sys.executable, "-m", "venv", str(place)], check=True)
        command = [str(python), "-I", "-m", "pip", "install", "-q", PEER]
        if subprocess.run(command, check=False).returncode:
            print(f"left out: {PEER} does not install here", flush=True)
            return None
        ready.touch()
    return python
