"""`robocell teleop`: records episodes of a run as a person performs them. See docs/teleop.md."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from robocell import RunConfig
from robocell._cli.common import ExitCode, fail, require_spec_file
from robocell._generation.run_source import RunSource
from robocell._suggestions import counted

LONGEST_S = 86400.0  # an episode, or a countdown


def teleop(
    run: Annotated[
        str,
        typer.Argument(metavar="RUN.yaml", help="The run: its cell, task, starts and cameras."),
    ],
    device: Annotated[
        str,
        typer.Option(
            help="web, keyboard, gamepad, spacemouse, leader:FILE.yaml, lerobot:module:Class, "
            "replay:FILE, or your own module:Class.",
        ),
    ] = "web",
    output: Annotated[
        str | None, typer.Option(metavar="PATH", help="Folder of the dataset. Default: RUN_teleop.")
    ] = None,
    episodes: Annotated[
        int | None, typer.Option("--episodes", "-n", min=1, help="Number of episodes.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the starts.")] = None,
    imports: Annotated[
        list[str] | None,
        typer.Option("--import", metavar="MODULE", help="A module to import first."),
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="FIELD=VALUE", help="Replace a field.")
    ] = None,
    robot: Annotated[str, typer.Option(help="The robot to move. Default: the first arm.")] = "",
    frame: Annotated[
        str, typer.Option(help="Axes of the device: base, world, tool or camera:NAME.")
    ] = "base",
    scale: Annotated[
        float, typer.Option(min=0, help="Metres of the TCP for one of the device.")
    ] = 1,
    max_speed: Annotated[float, typer.Option(help="Largest speed of the TCP, m/s.")] = 0.25,
    clearance: Annotated[
        float, typer.Option(min=0, help="Distance to keep from what stands still, m.")
    ] = 0,
    no_collision_stop: Annotated[
        bool, typer.Option("--no-collision-stop", help="Let the arm touch everything.")
    ] = False,
    countdown: Annotated[
        float, typer.Option(min=0, help="From record to the first action, s.")
    ] = 3,
    max_seconds: Annotated[float, typer.Option(min=1, help="Longest episode, s.")] = 120,
    go_on: Annotated[
        bool, typer.Option("--go-on", help="The task's success does not end an episode.")
    ] = False,
    keep_all: Annotated[
        bool, typer.Option("--keep-all", help="Keep each ended episode without asking.")
    ] = False,
    device_config: Annotated[
        Path | None, typer.Option(metavar="FILE.yaml", help="Options of a device's class.")
    ] = None,
    host: Annotated[str, typer.Option(help="Address of the page, such as 0.0.0.0.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Port of the page; 0 is a free one.")] = 0,
    tls: Annotated[
        bool, typer.Option("--tls", help="Serve the page by https, with a new certificate.")
    ] = False,
) -> None:
    """Record episodes of a run by moving the arm yourself.

    The command prints the address of a page, which shows the scene and has
    buttons for the commands: record, success, failure, re-sync, reset origin,
    keep, discard. With --device web the page moves the arm, too. Repeat the
    command to go on.

    Exit codes:
    0    episodes were recorded, or you quit
    2    wrong command, spec or device
    3    reading or writing failed
    130  interrupted
    """
    for name, value in (("--max-seconds", max_seconds), ("--countdown", countdown)):
        if not value <= LONGEST_S:
            fail(f"{name} is {value:g}; it must be at most {LONGEST_S:g} s")
    from robocell._cli.web_view import serving
    from robocell._teleop.devices import make_device
    from robocell._teleop.follower import FollowOptions
    from robocell._teleop.operator import OperatorOptions
    from robocell._teleop.recorded import RecordedDevice
    from robocell._teleop.session import Recorded, record
    from robocell._web.teleop_page import PageDevice, TeleopPage, WithPage

    source = RunSource(run, tuple(imports or ()))
    if not source.in_python:
        require_spec_file(Path(run), RunConfig)
    config = _config(source, set_ or [], output, episodes, seed, max_seconds)
    chosen = make_device(device, device_config)
    follow = FollowOptions(
        scale=scale,
        frame=frame,
        max_speed=max_speed,
        clearance=clearance,
        stops_at_collisions=not no_collision_stop,
    )
    options = OperatorOptions(robot, follow, countdown, not go_on, not keep_all)
    if isinstance(chosen, RecordedDevice):
        options = chosen.options()
    site = TeleopPage(
        f"Teleoperation, {config.run}",
        chosen if isinstance(chosen, PageDevice) else None,
        [stream.name for stream in config.cameras.streams],
        chosen.help,
    )
    if isinstance(chosen, PageDevice):
        chosen.site = site
    moved = chosen if isinstance(chosen, PageDevice) else WithPage(chosen, site)

    def say(recorded: Recorded) -> None:
        result = "success" if recorded.success else f"failure: {recorded.reason}"
        print(f"{recorded.id}: {result}, {counted(recorded.rows, 'action')}", flush=True)

    if chosen.help:
        print(chosen.help, flush=True)
    try:
        with (
            _certificate(tls, host) as certificate,
            serving(site, host, port, certificate, offers_tls=True),
        ):
            made = record(config, moved, options, site, say)
    except KeyboardInterrupt:
        raise typer.Exit(ExitCode.INTERRUPTED) from None
    print(f"{counted(len(made), 'episode')} in {config.output}")


def _config(
    source: RunSource,
    replaced: list[str],
    output: str | None,
    episodes: int | None,
    seed: int | None,
    max_seconds: float,
) -> RunConfig:
    """Reads the run; its dataset is not that of the run's own expert."""
    fields = [*replaced]
    if episodes is not None:
        fields.append(f"episodes_per_scene={episodes}")
    if seed is not None:
        fields.append(f"seed={seed}")
    config = source.load(fields)
    config.output = output or f"{str(config.output).rstrip('/')}_teleop"
    config.rates.max_steps = 1 + max(1, round(max_seconds / config.rates.policy_period()))
    return config


@contextlib.contextmanager
def _certificate(wanted: bool, host: str) -> Iterator[tuple[Path, Path] | None]:
    """Makes a certificate for as long as the page is served."""
    if not wanted:
        yield None
        return
    from robocell._web.certificate import make_certificate

    with tempfile.TemporaryDirectory() as folder:
        yield make_certificate(Path(folder), host)
