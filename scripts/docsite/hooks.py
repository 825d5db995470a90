"""Hooks of MkDocs: pages that are made from sources, and the repository's Markdown as it is.

mkdocs.yml names this file. Nothing here needs a network.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cpp_reference
import notebook_pages
import python_reference
from markdown_dialect import for_python_markdown
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from repository import Repository

BUILD = Path(__file__).resolve().parents[2] / "build" / "site"
# By folder: what a reader wants to do comes before the reference.
SEARCH_BOOST = {"howto": 4, "tutorials": 2, "troubleshooting.md": 2, "reference": 0.5, "files": 0.2}
repository = Repository()


def slug(heading: str, separator: str = "-") -> str:
    """The anchor of a heading, as web views of the repository make it."""
    from check_docs import anchor

    return anchor(heading)


def on_startup(**_: Any) -> None:
    """Puts the package together before its reference is read."""
    python_reference.link_package(BUILD / "package")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Gives headings the anchors that links between pages use."""
    config.mdx_configs.setdefault("toc", {})["slugify"] = slug
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that are made from the repository's files."""
    repository.add_pages(files, config)
    for uri, content in {**cpp_reference.pages(), **python_reference.pages()}.items():
        files.append(File.generated(config, uri, content=content))
    for uri, page in notebook_pages.pages().items():
        files.append(File.generated(config, uri, content=page))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Links and lists as the site needs them; which pages the search shows first."""
    folder = page.file.src_uri.split("/")[0]
    page.meta.setdefault("search", {"boost": SEARCH_BOOST.get(folder, 1)})
    if page.file.src_uri.startswith(("reference/python", "files/")):
        return markdown
    return for_python_markdown(repository.rewritten(markdown, page.file.src_uri))
