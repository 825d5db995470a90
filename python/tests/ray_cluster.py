"""A Ray cluster of two machines on this one; one of them is killed while a command uses it.

    python ray_cluster.py generate run.yaml --output out

Runs `robocell ... --engine ray --address ADDRESS --progress jsonl` and prints its events. When both
machines are at work, it kills one, and another one joins.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from robocell._generation.procfs import children

# Ray's workers are nice; beside other work they would hardly run.
os.environ |= {"RAY_USAGE_STATS_ENABLED": "0", "RAY_worker_niceness": "0"}


def raylet_of(node: Any) -> int:
    """The process that stands for a machine."""
    return int(node.all_processes["raylet"][0].process.pid)


def works(pid: int) -> bool:
    """Whether a worker process of robocell runs below a process."""
    command = Path(f"/proc/{pid}/cmdline").read_bytes()
    return b"robocell._generation.work" in command or any(map(works, children(pid)))


def main() -> int:
    """Returns the exit code of the command."""
    from ray.cluster_utils import Cluster

    head = {"num_cpus": 1, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    try:
        other = cluster.add_node(num_cpus=1)
        options = ["--engine", "ray", "--address", cluster.address, "--progress", "jsonl"]
        command = [sys.executable, "-m", "robocell", *sys.argv[1:], *options]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                print(line, end="", flush=True)
                made = json.loads(line)["event"] == "episode"
                if made and other is not None and works(raylet_of(other)):
                    cluster.remove_node(other, allow_graceful=False)
                    cluster.add_node(num_cpus=1)
                    other = None
        return process.returncode
    finally:
        cluster.shutdown()


if __name__ == "__main__":
    sys.exit(main())
