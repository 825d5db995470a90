"""Views of a robot in a model: its move groups."""
