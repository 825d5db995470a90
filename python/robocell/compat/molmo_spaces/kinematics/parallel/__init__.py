"""Kinematics of many poses at once."""
