"""HTML of scenes, robots, episodes and datasets in notebooks: a picture and a table.

Notebooks call `_repr_html_` of the last value of a cell, and only then are pictures rendered and
episodes read. Without a renderer or a decoder, the table stands alone.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robocell import _core

if TYPE_CHECKING:
    import numpy as np

    from robocell._web.html_file import Shown

WIDTH, HEIGHT = 360, 270  # of pictures, pixels
MOST_ROWS = 12  # of a table; what is beyond is counted
METHOD = "_repr_html_"

Row = tuple[str, object]


def page(pictures: Iterable[str], rows: Iterable[Row], title: str) -> str:
    """Formats a title, pictures side by side, and a table of names and values."""
    cells = "".join(
        f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
        f"<td style='text-align:left'>{html.escape(str(value))}</td></tr>"
        for name, value in rows
    )
    return (
        f"<div class='robocell-repr'><strong>{html.escape(title)}</strong>"
        "<div style='display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start'>"
        f"{''.join(pictures)}<table>{cells}</table></div></div>"
    )


def picture(rgb: np.ndarray, label: str) -> str:
    """Returns an <img> tag that contains an image (height, width, 3), uint8."""
    import tempfile  # for notebooks alone

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        _core.write_png(file, rgb)
        encoded = base64.b64encode(file.read_bytes()).decode()
    text = html.escape(label, quote=True)
    return f"<img alt='{text}' title='{text}' src='data:image/png;base64,{encoded}'>"


def picture_of(make: Callable[[], np.ndarray], label: str) -> list[str]:
    """Returns the picture, or nothing if this machine cannot render."""
    try:
        return [picture(make(), label)]
    except _core.Error:
        return []


def listed(names: Iterable[str]) -> str:
    """Names in one line; the first ones if there are many."""
    names = list(names)
    more = len(names) - MOST_ROWS
    return ", ".join(names[:MOST_ROWS]) + (f" and {more} more" if more > 0 else "") or "none"


def numbers(values: Iterable[float], digits: int = 3) -> str:
    """Formats numbers in one line."""
    return " ".join(f"{value:.{digits}f}" for value in values)


def has_arm(robot: _core.Robot) -> bool:
    """Returns True if the robot has an arm with joints; a hand alone has none."""
    try:
        return robot.n_joints > 0
    except _core.NotFoundError:
        return False


def orbit_of(scene: _core.Scene, size: float | None = None) -> tuple[tuple[float, ...], float]:
    """Returns the point and the distance from which all arms are seen, or the model without arms.

    `size` replaces the distance.
    """
    robots = [robot for robot in scene.robots if has_arm(robot)]
    if not robots:
        model = scene.model
        return tuple(model.stat.center), size or 2 * model.stat.extent
    points = [
        point
        for robot in robots
        for point in (robot.base_in_world.translation, robot.tcp_in_world.translation)
    ]
    lowest = [min(point[i] for point in points) for i in range(3)]
    highest = [max(point[i] for point in points) for i in range(3)]
    middle = tuple((low + high) / 2 for low, high in zip(lowest, highest, strict=True))
    across = max(high - low for low, high in zip(lowest, highest, strict=True))
    return middle, size or across + 1.1 * max(robot.reach for robot in robots)


def view_of(scene: _core.Scene, size: float | None = None) -> _core.OrbitCamera:
    """Returns a camera that sees all arms, or the whole model without arms."""
    lookat, distance = orbit_of(scene, size)
    elevation = -20 if any(map(has_arm, scene.robots)) else -25
    return _core.OrbitCamera(lookat=lookat, distance=distance, azimuth=135, elevation=elevation)


def drawn(scene: _core.Scene) -> np.ndarray:
    """Renders the scene's present state."""
    renderer = _core.Renderer(scene)
    image: np.ndarray = renderer.render(view_of(scene), WIDTH, HEIGHT)["rgb"]
    return image


def scene_html(scene: _core.Scene) -> str:
    """Returns HTML with a picture of the scene, its robots, objects and cameras."""
    if scene.closed:
        return page([], [], f"Scene '{scene.name}', closed")
    rows: list[Row] = [
        ("time", f"{scene.time():.3f} s, in steps of {scene.timestep():g} s"),
        ("robots", listed(robot.name for robot in scene.robots)),
        ("objects", listed(scene.object_names)),
        ("cameras", listed(scene.camera_names())),
        ("joints", scene.model.njnt),
        ("bodies", scene.model.nbody - 1),
    ]
    shown = picture_of(lambda: drawn(scene), f"scene {scene.name}")
    return page(shown, rows, f"Scene '{scene.name}'")


def robot_html(robot: _core.Robot) -> str:
    """Returns HTML with a picture of the robot, its mode, TCP, opening and joints.

    A robot without an arm shows its groups and its gripper.
    """
    scene = robot.scene
    if scene.closed:
        return page([], [], f"Robot '{robot.name}', of a closed scene")
    rows: list[Row] = [("groups", listed(robot.group_names))]
    with_arm = has_arm(robot)
    if with_arm:
        tcp = robot.base_in_world.inverse() * robot.tcp_in_world
        rows += [
            ("mode", robot.ctrl_mode.name.lower()),
            ("reach", f"{robot.reach:.3f} m"),
            ("TCP in base, x y z", f"{numbers(tcp.translation)} m"),
            ("TCP in base, quaternion xyzw", numbers(tcp.quaternion)),
        ]
    if robot.has_gripper:
        distance = robot.gripper.inter_finger_dist
        rows.append(("gripper", f"opening {robot.gripper.opening:.2f}, {distance:.3f} m"))
    if with_arm:
        positions = list(robot.arm.joint_pos)
        for name, position in list(zip(robot.joint_names, positions, strict=False))[:MOST_ROWS]:
            rows.append((name, f"{position:.3f}"))
    shown = picture_of(lambda: drawn(scene), f"robot {robot.name}")
    return page(shown, rows, f"Robot '{robot.name}'")


def instruction_of(episode: _core.Episode) -> str:
    """Returns the sentence that a policy got; empty if there was none."""
    metadata: Any = episode.metadata
    return str(metadata.get("instruction", ""))


def episode_html(episode: _core.Episode) -> str:
    """Returns HTML with the middle image of each colour stream, the result and the columns."""
    rows: list[Row] = [
        ("result", "success" if episode.success else f"failure: {episode.end_reason}"),
        ("instruction", instruction_of(episode)),
        ("rows", episode.rows()),
        ("streams", listed(episode.streams)),
        ("columns", len(episode.columns)),
        ("files", listed(episode.files)),
    ]
    shown: list[str] = []
    for stream in episode.cameras:
        shown += picture_of(partial(episode.frame, stream, episode.rows() // 2), stream)
    return page(shown, [row for row in rows if row[1] != ""], f"Episode {episode.id}")


def dataset_html(dataset: _core.Dataset) -> str:
    """Returns HTML with one line for each of the first episodes."""
    rows: list[Row] = [("episodes", len(dataset))]
    for episode in dataset[:MOST_ROWS]:
        result = "success" if episode.success else f"failure: {episode.end_reason}"
        line = f"{episode.rows()} rows, {result}, {instruction_of(episode)}"
        rows.append((episode.id, line.rstrip(", ")))
    if len(dataset) > MOST_ROWS:
        rows.append(("…", f"{len(dataset) - MOST_ROWS} more"))
    return page([], rows, f"Dataset {dataset.folder}")


def show(what: Any) -> Shown:
    """Returns a page with a scene to look at from all sides, or with an episode to play.

    A notebook shows it as the value of a cell; `save` writes it into a file. The page needs no
    server: the shapes are in it, and of an episode also states, columns and videos.

    Args:
        what: A scene, a robot (its scene), an environment, or an episode.

    Raises:
        ArgumentError: `what` is nothing of these.

    Examples:
        >>> rc.show(scene).save("scene.html")
    """
    from robocell._web.html_file import page_of_episode, page_of_scene

    if isinstance(what, _core.Episode):
        return page_of_episode(what)
    scene = what if isinstance(what, _core.Scene) else getattr(what, "scene", None)
    if isinstance(scene, _core.Scene):
        return page_of_scene(scene)
    raise _core.ArgumentError(
        f"show() takes a scene, a robot, an environment or an episode, got {type(what).__name__}"
    )


def attach() -> None:
    """Gives the extension's classes their `_repr_html_`."""
    representations: dict[type, Callable[[Any], str]] = {
        _core.Scene: scene_html,
        _core.Robot: robot_html,
        _core.Episode: episode_html,
        _core.Dataset: dataset_html,
    }
    for kind, representation in representations.items():
        setattr(kind, METHOD, representation)


attach()
