"""Samplers of tasks."""
