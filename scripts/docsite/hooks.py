"""Hooks of MkDocs: pages that are made from sources, and the repository's Markdown as it is.

mkdocs.yml names this file. Nothing here needs a network.
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1]))  # for check_docs

import cpp_reference
import notebook_pages
import python_reference
import search_words
from markdown_dialect import for_python_markdown
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from repository import Repository

from check_docs import anchor

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "site"
EXTERNAL = re.compile(r"<(?:script|link|img|iframe|source)\b[^>]*?(?:src|href)=\"(https?:[^\"]+)")
# A page that a docstring names, in plain text or as code.
NAMED_PAGE = re.compile(r"(?<![\w/\">.])docs/([\w/]+\.md)")
repository = Repository()


def slug(heading: str, separator: str = "-") -> str:
    """The anchor of a heading, as web views of the repository make it."""
    return anchor(heading)


def on_startup(**_: Any) -> None:
    """Puts the package together before its reference is read."""
    python_reference.link_package(BUILD / "package")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Names the version; gives headings the anchors that links between pages use."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    config.site_name = f"robocell {project['version']}"
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
    page.meta.setdefault("search", {"boost": search_words.BOOST.get(folder, 1)})
    page.meta.setdefault("tags", search_words.WORDS.get(page.file.src_uri, []))
    if page.file.src_uri.startswith(("reference/python", "files/")):
        return markdown
    return for_python_markdown(repository.rewritten(markdown, page.file.src_uri))


def on_page_content(html: str, page: Page, files: Files, **_: Any) -> str:
    """Links the pages that docstrings name, `docs/scenes.md`."""
    if not page.file.src_uri.startswith("reference/python"):
        return html

    def link(match: re.Match[str]) -> str:
        target = files.get_file_from_path(match[1])
        if target is None:
            return match[0]
        return f'<a href="{target.url_relative_to(page.file)}">{match[0]}</a>'

    return NAMED_PAGE.sub(link, html)


def external_resources(html: str) -> list[str]:
    """Scripts, style sheets and pictures that a page loads from the web."""
    return EXTERNAL.findall(html)


def on_post_page(output: str, page: Page, **_: Any) -> str:
    """Rejects pages that need a network to be read."""
    if found := external_resources(output):
        raise PluginError(f"{page.file.src_uri} loads from the web: {', '.join(found)}")
    return output
