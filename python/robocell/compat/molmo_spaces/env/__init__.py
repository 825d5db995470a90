"""The environment, its sensors, and bodies by name."""
