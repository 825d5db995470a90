"""Poses, and frames of a model."""
