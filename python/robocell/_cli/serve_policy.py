"""`robocell serve-policy`: serves a policy over the openpi WebSocket protocol."""

from __future__ import annotations

import signal
import threading
from typing import Annotated

import typer

import robocell
from robocell._cli.common import (
    ExitCode,
    fail,
    print_warning,
    require_preset,
    require_run_source,
)

LOOPBACK = ("127.0.0.1", "localhost", "::1")


def serve_policy(
    policy: Annotated[
        str,
        typer.Argument(
            metavar="POLICY",
            help="module:Class or file.py:Class of a policy, or expert, replay, random.",
        ),
    ],
    run: Annotated[
        str | None,
        typer.Option(
            metavar="RUN.yaml|DATASET",
            help="The cell that the policy acts in; the dataset that replay takes actions from.",
        ),
    ] = None,
    preset: Annotated[
        str,
        typer.Option(
            metavar="NAME|FILE.yaml",
            help="Names and units that clients use: droid, libero, aloha, roboarena, or a file. "
            "Default: the names of a dataset's columns.",
        ),
    ] = "",
    host: Annotated[
        str, typer.Option(help="Address to listen at. Others than the default open the network.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0 for a free one.")] = 8000,
    imports: Annotated[
        list[str] | None,
        typer.Option("--import", metavar="MODULE", help="A module that registers tasks."),
    ] = None,
) -> None:
    """Serve a policy to `robocell evaluate`, or to any client of openpi's protocol.

    With the environment variable ROBOCELL_POLICY_API_KEY, clients must send that key. Ctrl-C ends
    the server.

    Exit codes:
    0  ended by Ctrl-C or SIGTERM
    2  wrong command, run, policy or preset
    3  the port cannot be used, or a file cannot be read
    """
    require_preset(preset)
    if run is not None:
        require_run_source(run)
    try:
        from robocell.policy_server import policy_server
    except ModuleNotFoundError as error:
        fail(str(error))
    try:
        server = policy_server(
            policy, run, preset=preset, imports=imports or (), host=host, port=port
        )
    except robocell.IoError as error:
        fail(str(error), ExitCode.OUTPUT)
    if host not in LOOPBACK and not server.has_key:
        print_warning(
            f"whoever reaches {server.url} may use the policy: set ROBOCELL_POLICY_API_KEY"
        )
    print(f"{policy}: {server.url}", flush=True)
    for number in (signal.SIGINT, signal.SIGTERM):
        # A thread closes it, because the handler may interrupt code that holds its lock.
        signal.signal(number, lambda *_: threading.Thread(target=server.close).start())
    server.serve()
