"""Makes entries of the catalogue from a user's models: `robocell add-object`."""
