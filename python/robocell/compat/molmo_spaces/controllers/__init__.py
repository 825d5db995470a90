"""Controllers: from a target of a move group to the controls of its actuators."""
