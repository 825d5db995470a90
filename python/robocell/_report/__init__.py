"""The report of a dataset: what `robocell report` prints, and the page that it writes.

`facts` reads every episode.json, `rollouts` counts attempts, `variation` finds what was random,
`motion` reads a sample of the time series, and `pictures` the videos of a few episodes. `charts`
and `page` make one HTML file of them.
"""
