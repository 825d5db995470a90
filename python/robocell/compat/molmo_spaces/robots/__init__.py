"""Robots: the base class, the views of their parts, and a tool that measures grippers."""
