"""`robocell view`: a window or a page of a robot, a scene, a cell, or a start of a run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from robocell import EnvConfig, Robot, RobotConfig, RobotSpec, RunConfig, Scene, SceneSpec
from robocell._cli.common import fail, fail_missing, is_dataset, is_yaml
from robocell._stored_files import is_stored
from robocell.control import CtrlMode
from robocell.viewer import Viewer

MODELS = (".xml", ".mjb", ".urdf")


@dataclass(frozen=True)
class Shown:
    """A scene, and what keeps it alive."""

    scene: Scene
    owner: Any = None
    start: Any = None  # state

    def restart(self) -> None:
        """Brings the scene to its start: that of a run, or of a cell, is not the scene's home."""
        self.scene.reset()
        if self.start is not None:
            self.scene.set_state(self.start)
            for robot in self.scene.robots:
                if _has_arm(robot):
                    robot.set_joint_pos(robot.arm.joint_pos)


def view(
    target: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="ROBOT.yaml, SCENE.yaml, CELL.yaml, RUN.yaml, a model, or DATASET/EPISODE.",
        ),
    ],
    index: Annotated[int, typer.Option(min=0, help="With a run: which start of its plan.")] = 0,
    worker: Annotated[
        int | None,
        typer.Option(
            min=0, help="With a DATASET that is being generated: which worker to watch, from 0."
        ),
    ] = None,
    imports: Annotated[
        list[str] | None,
        typer.Option(
            "--import", metavar="MODULE", help="With --worker: a module that the run needs."
        ),
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0, help="Speed: 1 is real time, 0 as fast as possible.")
    ] = 1.0,
    screenshot: Annotated[
        Path | None, typer.Option(help="Write the window's picture into this PNG, and end.")
    ] = None,
    web: Annotated[
        bool, typer.Option("--web", help="Show it in a browser; prints the page's address.")
    ] = False,
    host: Annotated[
        str, typer.Option(help="With --web: address to listen at, such as 0.0.0.0.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="With --web: the port; 0 is a free one.")] = 0,
) -> None:
    """Show a robot, a scene, a start of a run or an episode in a window or in a browser.

    Drag the handle at a robot's TCP, and the arm follows by inverse kinematics;
    the sliders at the right move joints and controls. Press F1 in the window
    for the keys. Of an episode, Space stops and goes on, the arrows scrub.

    With --web the command prints the address of a page, which also lists the
    episodes of a DATASET. Only this machine reaches it unless --host says more.

    With --worker the window shows the present episode of a worker of a running
    generation. It makes the same episode in this process, so no worker waits.
    """
    if worker is not None:
        from robocell._cli.watch_worker import watch

        if web or screenshot:
            fail("--worker shows a window: leave out --web and --screenshot")
        if not is_dataset(target):
            fail(f"'{target}' is no dataset: --worker watches the workers that write into one")
        watch(target, worker, speed, imports or [])
        return
    if web:
        from robocell._cli.web_view import view_in_browser

        if screenshot:
            fail("--screenshot is of the window: leave out --web")
        view_in_browser(target, index, speed, host, port)
        return
    if is_stored(target / "episode.json"):
        from robocell._cli.episode_player import play

        play(target.parent, target.name, speed, screenshot)
        return
    if is_dataset(target):
        fail(f"'{target}' is a dataset: give one of its episodes, {target}/EPISODE, or --web")
    shown = load(target, index)
    show(shown.scene, target.stem, speed, screenshot)


def show(scene: Scene, title: str, speed: float = 1.0, screenshot: Path | None = None) -> None:
    """Shows a scene with its robots until the user closes the window."""
    robots = [robot for robot in scene.robots if _has_arm(robot)]
    with Viewer.open(robots[0] if robots else scene, title, on_screen=screenshot is None) as viewer:
        viewer.realtime_factor = speed
        for robot in robots:
            viewer.drag_tcp(robot, robot.ctrl_mode == CtrlMode.POSITION)
        viewer.show_panels("Run", "Joints")
        if screenshot:
            viewer.save_screenshot(str(screenshot))
            return
        while viewer.step():
            for robot in scene.robots:
                robot.update()


def _has_arm(robot: Robot) -> bool:
    return any(robot.group(name).kind == "arm" for name in robot.group_names)


def load(path: Path, index: int) -> Shown:
    """Builds the scene of a file; robocell's errors end the command."""
    if not path.exists():
        fail_missing(path, "file", lambda each: is_yaml(each) or each.suffix in MODELS)
    if path.suffix in MODELS:
        spec = SceneSpec(name=path.stem, timestep=0.002, add_floor=True, add_skybox=True)
        spec.robots.append(RobotSpec(path=str(path)))
        return Shown(Scene.build(spec))
    if not is_yaml(path):
        fail(
            f"'{path}' is no file to show. Give a robot file, a scene, a cell or a run (YAML), or "
            "a model (.xml, .mjb, .urdf)"
        )
    kind = kind_of(path)
    if kind is RobotConfig:
        from robocell._cli.robot_scene import load_robot

        return Shown(load_robot(path, needs_arm=False).scene)
    if kind is RunConfig:
        from robocell._core import RunEnv

        env = RunEnv(RunConfig.load(path))
        env.reset(index)
        return Shown(env.scene, env, start=env.scene.state())
    if kind is EnvConfig:
        from robocell import Env

        cell = Env(EnvConfig.load(path))
        cell.reset(0)
        return Shown(cell.scene, cell, start=cell.scene.state())
    return Shown(Scene.build(SceneSpec.load(path)))


def kind_of(path: Path) -> type:
    """Returns the kind of specification that the file has most fields of.

    Fields that only one kind has decide; the others count among equals.
    """
    import yaml

    from robocell._spec_fields import fields_in

    try:
        content = yaml.safe_load(path.read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        fail(f"'{path}' cannot be read: {error}")
    if not isinstance(content, dict):
        fail(f"'{path}' is no specification: it has no fields")
    kinds = (RobotConfig, RunConfig, EnvConfig, SceneSpec)
    fields: dict[type, set[str]] = {kind: fields_in(kind) for kind in kinds}

    def fit(kind: type) -> tuple[int, int]:
        others = set[str]().union(*(fields[other] for other in kinds if other is not kind))
        known = fields[kind] & set(map(str, content))
        return len(known - others), len(known)

    best = max(kinds, key=fit)
    if fit(best) == (0, 0):
        own = {kind: ", ".join(sorted(fields[kind])[:6]) for kind in kinds}
        lines = "".join(f"\n  {kind.__name__}: {names}, ..." for kind, names in own.items())
        fail(f"'{path}' has no field of any specification. Fields are, among others:{lines}")
    return best
