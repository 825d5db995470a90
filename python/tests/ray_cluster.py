"""A Ray cluster of two machines on this one; one of them is killed while a command uses it.

    python ray_cluster.py generate run.yaml --output out

Runs `robocell ... --engine ray --address ADDRESS --progress jsonl` and prints its events. After the
second episode it kills one machine, and another one joins.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys

# Ray's workers are nice; beside other work they would hardly run.
os.environ |= {"RAY_USAGE_STATS_ENABLED": "0", "RAY_worker_niceness": "0"}

KILLED_AFTER = 2  # episodes


def main() -> int:
    """Returns the exit code of the command."""
    from ray.cluster_utils import Cluster

    head = {"num_cpus": 1, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    try:
        other = cluster.add_node(num_cpus=1)
        options = ["--engine", "ray", "--address", cluster.address, "--progress", "jsonl"]
        command = [sys.executable, "-m", "robocell", *sys.argv[1:], *options]
        episodes = 0
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                print(line, end="", flush=True)
                episodes += json.loads(line)["event"] == "episode"
                if other is not None and episodes == KILLED_AFTER:
                    cluster.remove_node(other, allow_graceful=False)
                    cluster.add_node(num_cpus=1)
                    other = None
        return process.returncode
    finally:
        cluster.shutdown()


if __name__ == "__main__":
    sys.exit(main())
