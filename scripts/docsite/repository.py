"""Brings pages and files from outside docs/ into the site, and rewrites links to match.

A page keeps the links that work in a checkout: ``../examples/README.md``, ``../models/rc7.yaml``.
Pages of `PAGES` become pages of the site. Each other file of the repository that a page links to
becomes a page that shows its text, a picture is copied, and a folder becomes a list of its files.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[2]
# Pages outside docs/, and where they are in the site.
PAGES = {
    "README.md": "overview.md",
    "CHANGELOG.md": "changes.md",
    "CONTRIBUTING.md": "contributing.md",
    "examples/README.md": "gallery/examples.md",
    "models/README.md": "gallery/models.md",
    "benchmarks/README.md": "benchmarks/method.md",
    "benchmarks/RESULTS.md": "benchmarks/results.md",
}
LINK = re.compile(r"(!?\[[^\]]*\]\()([^)\s]+)((?:\s+\"[^\"]*\")?\))")
IMAGE_TAG = re.compile(r'(<img\s[^>]*?src=")([^"]+)(")')
FENCE = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
PICTURES = {".png", ".jpg", ".svg", ".gif", ".webp", ".mp4"}
LANGUAGES = {
    ".py": "python", ".cc": "cpp", ".h": "cpp", ".yaml": "yaml", ".xml": "xml", ".sh": "bash",
    ".txt": "text", ".toml": "toml", ".json": "json", ".md": "markdown",
}  # fmt: skip


class Repository:
    """Knows for each file of the repository which file of the site it is."""

    def __init__(self) -> None:
        self.in_site: dict[str, str] = {}  # path in the repository -> src_uri in the site
        self.in_repository: dict[str, str] = {}

    def add_pages(self, files: Files, config: MkDocsConfig) -> None:
        """Adds `PAGES` and everything that pages link to."""
        self.in_site.clear()  # `mkdocs serve` builds several times
        self.in_repository.clear()
        for file in files:
            self._know(f"docs/{file.src_uri}", file.src_uri)
        for notebook in sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")):
            self.in_site[f"docs/notebooks/{notebook.name}"] = f"notebooks/{notebook.stem}.md"
        self.in_site["docs/notebooks"] = "notebooks/01_scene_and_control.md"
        for path, uri in PAGES.items():
            self._know(path, uri)
            files.append(File.generated(config, uri, content=(ROOT / path).read_text()))
        for path in [path for path in self.in_site if path.endswith(".md")]:
            for target in sorted(linked_files(path)):
                if target not in self.in_site:
                    self._add_file(target, files, config)

    def rewritten(self, markdown: str, uri: str) -> str:
        """The page with links that work in the site; unchanged for pages made from no file."""
        path = self.in_repository.get(uri)
        if path is None:
            return markdown

        def new(match: re.Match[str]) -> str:
            target, _, heading = match[2].partition("#")
            found = self.in_site.get(resolved(path, target)) if target else None
            if re.match(r"[a-z]+:", match[2]) or not found:
                return match[0]
            link = os.path.relpath(found, os.path.dirname(uri) or ".")
            return f"{match[1]}{link}{'#' + heading if heading else ''}{match[3]}"

        return outside_fences(markdown, lambda text: IMAGE_TAG.sub(new, LINK.sub(new, text)))

    def _know(self, path: str, uri: str) -> None:
        self.in_site[path] = uri
        self.in_repository[uri] = path

    def _add_file(self, path: str, files: Files, config: MkDocsConfig) -> None:
        source = ROOT / path
        if source.suffix in PICTURES:
            self.in_site[path] = f"files/{path}"
            files.append(File.generated(config, f"files/{path}", abs_src_path=str(source)))
        elif source.exists():
            self.in_site[path] = f"files/{path}.md"
            content = folder_page(path) if source.is_dir() else file_page(path)
            files.append(File.generated(config, f"files/{path}.md", content=content))


def outside_fences(markdown: str, change: Callable[[str], str]) -> str:
    """The page with `change` applied to everything but code blocks."""
    parts, end = [], 0
    for fence in FENCE.finditer(markdown):
        parts += [change(markdown[end : fence.start()]), fence[0]]
        end = fence.end()
    return "".join([*parts, change(markdown[end:])])


def resolved(page: str, target: str) -> str:
    """The path in the repository that a page's relative link leads to."""
    return os.path.normpath(os.path.join(os.path.dirname(page), target))


def linked_files(page: str) -> set[str]:
    """Paths in the repository that a page links to."""
    text = FENCE.sub("", (ROOT / page).read_text())
    targets = [match[2] for match in [*LINK.finditer(text), *IMAGE_TAG.finditer(text)]]
    paths = [target.partition("#")[0] for target in targets if not re.match(r"[a-z]+:", target)]
    return {resolved(page, path) for path in paths if path}


def file_page(path: str) -> str:
    """A page that shows a text file."""
    text = (ROOT / path).read_text()
    language = LANGUAGES.get(Path(path).suffix, "text")
    return f"# {path}\n````{language}\n{text}\n````\n"


def folder_page(path: str) -> str:
    """A page that shows the files of a folder, those that git knows."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", path]
    listing = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    parts = [f"# {path}"]
    for name in listing.splitlines():
        if Path(name).suffix in LANGUAGES:
            language = LANGUAGES[Path(name).suffix]
            parts.append(f"## {name}\n````{language}\n{(ROOT / name).read_text()}\n````")
    return "\n\n".join(parts) + "\n"
