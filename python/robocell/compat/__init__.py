"""Thin packages with the names of other projects, for programs that were written for those."""
