"""Plays a recorded episode in the viewer: scrub, play, phases."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import robocell
from robocell.viewer import Viewer

RIGHT, LEFT, HOME, END = 262, 263, 268, 269  # keys, by GLFW's numbers


class Player:
    """An episode at one of its rows.

    Attributes:
        row: The row that is shown.
        playing: True while time goes on; False at the end.
    """

    def __init__(self, episode: robocell.data.Episode) -> None:
        """Simulates the recorded controls again, for the states in every row."""
        from robocell.export._states import full_states_of

        self.states = full_states_of(episode)
        self.times = episode["time"] - episode["time"][0]
        self.scene = robocell.Scene.build(robocell.data.recorded_scene(episode))
        self.name = episode.id
        self.row = 0
        self.playing = True
        self._time = 0.0
        self._phases = _phases(episode)

    @property
    def text(self) -> str:
        """What the viewer shows beside the picture."""
        last = len(self.times) - 1
        lines = [self.name, f"row {self.row} of {last}", f"{self.times[self.row]:.2f} s"]
        if self._phases:
            lines.append(self._phases[self.row])
        return "\n".join(lines)

    def show_row(self, row: int) -> None:
        """Goes to a row, or the nearest one."""
        self.row = int(np.clip(row, 0, len(self.states) - 1))
        self._time = float(self.times[self.row])
        self.scene.set_state(self.states[self.row])
        self.scene.forward()

    def press(self, key: int) -> None:
        """Acts on a key: the arrows go a row or, while playing, a second on or back."""
        rows, seconds = len(self.times) - 1, float(self.times[-1])
        second = max(1, round(rows / seconds)) if seconds > 0 else 1
        by = second if self.playing else 1
        to = {RIGHT: self.row + by, LEFT: self.row - by, HOME: 0, END: len(self.states) - 1}
        if key in to:
            self.show_row(to[key])

    def advance(self, seconds: float, speed: float = 1.0) -> None:
        """Goes on by so many seconds of the clock, at a speed; at speed 0 by one row."""
        if not self.playing:
            return
        if speed == 0:
            self.show_row(self.row + 1)
            return
        now = self._time + speed * seconds
        row = int(np.searchsorted(self.times, now + 1e-9, "right")) - 1
        if row != self.row:
            self.show_row(row)
        self._time = min(now, float(self.times[-1]))


def play(dataset: Path, episode: str, speed: float, screenshot: Path | None) -> None:
    """Shows an episode until the user closes the window."""
    player = Player(robocell.Dataset(dataset)[episode])
    # Nothing steps the scene: the player goes by the viewer's speed and pause.
    options = {"on_screen": screenshot is None, "draws_steps": False}
    with Viewer.open(player.scene, episode, **options) as viewer:
        viewer.realtime_factor = speed
        viewer.show_panels("Run", "Joints")
        player.show_row(0)
        viewer.text = player.text
        if screenshot:
            player.show_row(len(player.states) // 2)
            viewer.text = player.text
            viewer.save_screenshot(str(screenshot))
            return
        before = time.monotonic()
        while viewer.show():
            for key in viewer.take_keys():
                player.press(key)
            now = time.monotonic()
            player.playing = not viewer.paused
            player.advance(now - before, viewer.realtime_factor)
            before = now
            viewer.text = player.text
            time.sleep(max(0.0, 1 / 60 - (time.monotonic() - now)))


def _phases(episode: robocell.data.Episode) -> list[str]:
    """Returns the name of the phase of every row; empty if none is recorded."""
    if "phase" not in episode:
        return []
    names = episode.column("phase").values
    return [names[int(value)] if names else str(value) for value in episode["phase"]]
