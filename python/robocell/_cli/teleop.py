"""`robocell teleop`: records episodes as a person performs them. See docs/teleop.md."""

from __future__ import annotations

import contextlib
import dataclasses
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from robocell import EnvConfig, RobotConfig, RunConfig
from robocell._cli.common import ExitCode, fail, require_spec_file
from robocell._generation.run_source import RunSource
from robocell._suggestions import counted

if TYPE_CHECKING:
    from robocell._teleop.device import Device
    from robocell._teleop.real_arms import RealArms

LONGEST_S = 86400.0  # an episode, or a countdown
WITHOUT_CLUTCH = ("keyboard", "spacemouse", "leader", "lerobot")
ARM_SPEED, ARM_WATCHDOG_S = 0.5, 0.2


def teleop(
    target: Annotated[
        str,
        typer.Argument(
            metavar="FILE", help="RUN.yaml, with its task and starts; CELL.yaml; or ROBOT.yaml."
        ),
    ],
    device: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[ARM=]DEVICE",
            help="web, keyboard, gamepad, spacemouse, leader:FILE.yaml, lerobot:module:Class, "
            "replay:FILE, or your own module:Class. Default: web. Give one for each arm as "
            "left=gamepad.",
        ),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(metavar="PATH", help="Folder of the dataset. Default: RUN_teleop."),
    ] = None,
    episodes: Annotated[
        int | None,
        typer.Option(
            "--episodes",
            "-n",
            min=1,
            help="Number of episodes in the dataset. Default: the run's, else until you quit.",
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the starts.")] = None,
    imports: Annotated[
        list[str] | None,
        typer.Option("--import", metavar="MODULE", help="A module to import first."),
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="FIELD=VALUE", help="Replace a field.")
    ] = None,
    robot: Annotated[
        str, typer.Option(help="The robot or arm to move first. Default: the first one.")
    ] = "",
    mode: Annotated[
        str, typer.Option(help="sim, or real: the arms of --arm follow with those of the scene.")
    ] = "sim",
    arm: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[ARM=]REAL",
            help="With --mode real: udp:HOST:PORT, lerobot:Class, file:FILE.yaml, or your own "
            "module:Class.",
        ),
    ] = None,
    arm_config: Annotated[
        Path | None, typer.Option(metavar="FILE.yaml", help="Options of the real arm's class.")
    ] = None,
    arm_speed: Annotated[
        float, typer.Option(help="Share of the real arm's speed limits, to 1.")
    ] = ARM_SPEED,
    arm_watchdog: Annotated[
        float, typer.Option(help="A real arm stops so many seconds after its last measurement.")
    ] = ARM_WATCHDOG_S,
    dead_man: Annotated[
        float,
        typer.Option(min=0, help="A real arm holds so many seconds after the clutch is let go."),
    ] = 0,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Send nothing to the real arms; show where they are.")
    ] = False,
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
    """Record episodes of a run, a cell or a robot by moving the arm yourself.

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
    from robocell._teleop.cell_session import record_cell
    from robocell._teleop.devices import by_arm
    from robocell._teleop.follower import FollowOptions
    from robocell._teleop.operator import OperatorOptions
    from robocell._teleop.recorded import RecordedDevice
    from robocell._teleop.session import Recorded, record
    from robocell._teleop.several import DeviceForEach
    from robocell._web.teleop_page import PageDevice, TeleopPage, WithPage

    run = _run(target, imports or [], set_ or [], output, episodes, seed, max_seconds)
    cell = None if isinstance(run, RunConfig) else run
    devices = {
        name: _device(each, device_config)
        for name, each in by_arm(device or ["web"], "--device").items()
    }
    for name, each in devices.items():
        if name and isinstance(each, RecordedDevice):
            fail(f"--device {name}=replay: a session moves all its arms; give replay:FILE alone")
    chosen = devices[""] if "" in devices else DeviceForEach(devices)
    follow = FollowOptions(
        scale=scale,
        frame=frame,
        max_speed=max_speed,
        clearance=clearance,
        stops_at_collisions=not no_collision_stop,
    )
    options = OperatorOptions(robot, follow, countdown, not go_on, not keep_all, seed=seed or 0)
    if isinstance(chosen, RecordedDevice):
        options = chosen.options()
    elif cell is not None:
        most = max(1, round(max_seconds * cell.sim.frequency))
        options = dataclasses.replace(options, max_steps=most)
    if dead_man:
        for given in by_arm(device or ["web"], "--device").values():
            if given.partition(":")[0] in WITHOUT_CLUTCH:
                fail(
                    f"--dead-man: {given} cannot be let go of; use web, gamepad or a device of "
                    "yours, or leave out --dead-man"
                )
    real = _real_arms(
        mode,
        arm or [],
        arm_config,
        {
            "speed": arm_speed,
            "watchdog": arm_watchdog,
            "dead_man": dead_man,
            "dry_run": dry_run,
        },
    )
    pages = [each for each in devices.values() if isinstance(each, PageDevice)]
    if len(pages) > 1:
        fail("--device: the page moves one arm at a time; give it to one, or leave out the arms")
    title = run.name if isinstance(run, EnvConfig) else run.run
    site = TeleopPage(
        f"Teleoperation, {title}",
        pages[0] if pages else None,
        [stream.name for stream in run.cameras.streams],
        chosen.help,
    )
    if pages:
        pages[0].site = site
    moved = chosen if pages else WithPage(chosen, site)
    folder = str(run.output) if isinstance(run, RunConfig) else output or f"{title}_teleop"

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
            made = (
                record(run, moved, options, site, say, real)
                if isinstance(run, RunConfig)
                else record_cell(
                    run,
                    folder,
                    moved,
                    options,
                    site,
                    say,
                    episodes=episodes,
                    real_arms=real,
                )
            )
    except KeyboardInterrupt:
        raise typer.Exit(ExitCode.INTERRUPTED) from None
    print(f"{counted(len(made), 'episode')} in {folder}")


def _device(name: str, config: Path | None) -> Device:
    from robocell._teleop.devices import make_device

    return make_device(name, config)


def _real_arms(
    mode: str,
    arms: list[str],
    config: Path | None,
    safety: dict[str, Any],
) -> RealArms | None:
    """Returns the real arms of the options; None for those of a simulation."""
    from robocell._core import SafetyOptions
    from robocell._hardware.connecting import MODES
    from robocell._teleop.devices import by_arm
    from robocell._teleop.real_arms import RealArms

    if mode not in MODES:
        fail(f"--mode is {mode}; there are {' and '.join(MODES)}")
    if mode == "sim":
        usual = {"speed": ARM_SPEED, "watchdog": ARM_WATCHDOG_S, "dead_man": 0, "dry_run": False}
        if arms or config or safety != usual:
            fail(
                "--arm, --arm-config, --arm-speed, --arm-watchdog, --dead-man and --dry-run are of "
                "real arms: add --mode real"
            )
        return None
    return RealArms(by_arm(arms, "--arm"), config, SafetyOptions(**safety))


def _run(
    target: str,
    imports: list[str],
    replaced: list[str],
    output: str | None,
    episodes: int | None,
    seed: int | None,
    max_seconds: float,
) -> RunConfig | EnvConfig:
    """Reads a run, or a cell, or makes the cell of a robot."""
    source = RunSource(target, tuple(imports))
    if source.in_python:
        return _config(source, replaced, output, episodes, seed, max_seconds)
    from robocell._cli.view import kind_of

    require_spec_file(Path(target), RunConfig)
    kind = kind_of(Path(target))
    if kind is RunConfig:
        return _config(source, replaced, output, episodes, seed, max_seconds)
    if kind not in (EnvConfig, RobotConfig):
        fail(f"'{target}' is a scene; give a run, a cell or a robot")
    if imports:
        fail("--import is of a run, whose tasks a module registers")
    if kind is EnvConfig:
        return EnvConfig.load(target, replaced)
    from robocell._teleop.cell_session import cell_of

    cell = cell_of(RobotConfig.load(target, replaced))
    cell.name = Path(target).stem
    return cell


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
