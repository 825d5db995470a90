"""Teleoperation: devices, what follows them, and the recording of episodes. docs/teleop.md."""
