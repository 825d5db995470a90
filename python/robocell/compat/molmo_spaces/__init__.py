"""The names of MolmoSpaces that its tutorials on custom robots use, on real `mujoco` objects.

    from robocell.compat.molmo_spaces.robots.robot_views.abstract import MoveGroup, RobotView
    from robocell.compat.molmo_spaces.configs.base_pick_config import PickBaseConfig

Modules have the names of the original's, below this package. Views, groups and controllers read and
write `mujoco.MjData`; inverse kinematics, houses, picking and datasets are robocell's. It needs the
extra `molmo-spaces`. What is different: docs/compat_molmo_spaces.md.
"""
