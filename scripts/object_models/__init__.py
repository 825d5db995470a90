"""The built-in objects and the articulated equipment, described in Python.

`shapes` makes meshes, `parts` writes models, and each other module describes some kinds.
`scripts/make_objects.py` and `scripts/make_equipment.py` write them to `models/`.
"""
