"""Generating datasets with worker processes: supervisor, workers, their messages and reports.

The supervisor hands the items of a plan to worker processes one at a time and knows nothing of
simulation; a worker makes episodes and knows nothing of the others. They talk in JSON lines over
pipes (`protocol`). What is done is read from the disk, so everything can be killed at any instant.
`robocell._cli.generate` puts the parts together.
"""
