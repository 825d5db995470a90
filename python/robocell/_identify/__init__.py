"""System identification; the public names are in robocell.identify."""
