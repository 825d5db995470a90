"""Arms that programs drive, by name; the public names are in robocell.hardware."""
