"""Pages in a browser: a live scene, an episode, a dataset. docs/viewer.md describes them.

The server is `web_server`; `live_scene`, `episode_page` and `dataset_page` are what it shows, and
`html_file` puts a page into one file for notebooks. The page itself is in `page/`.
"""
