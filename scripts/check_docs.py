"""Check that links and pictures in the Markdown pages lead somewhere.

Looks at relative links ``[text](target)`` and ``![text](target)`` of every page git knows: the file
must exist, and for ``page.md#heading`` the heading too. Links into the web are not followed. The
picture of the layers must be that of the rules in check_includes.py.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)")
FENCE = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)


def anchor(heading: str) -> str:
    """The anchor that web views of Markdown give a heading."""
    text = re.sub(r"[`*]|(?<!\w)_|_(?!\w)", "", heading.strip().lower())
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(page: Path) -> set[str]:
    """All anchors of a page."""
    text = FENCE.sub("", page.read_text())
    return {anchor(match) for match in re.findall(r"^#+ (.+)$", text, re.MULTILINE)}


def broken_links(page: Path) -> Iterator[str]:
    """Links of one page that lead nowhere, each with the reason."""
    for target in LINK.findall(FENCE.sub("", page.read_text())):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, heading = target.partition("#")
        file = page.parent / name if name else page
        if not file.exists():
            yield f"{target}: no such file"
        elif heading and file.suffix == ".md" and heading not in anchors(file):
            yield f"{target}: no such heading"


def check(root: Path) -> list[str]:
    """Broken links of all pages under root, as ``page: reason``."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"]
    listing = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout
    pages = [root / name for name in listing.splitlines()]
    return [
        f"{page.relative_to(root)}: {reason}"
        for page in pages
        if page.is_file()
        for reason in broken_links(page)
    ]


def outdated_pictures(root: Path) -> list[str]:
    """Pictures that follow from rules of the repository and differ from them."""
    command = [sys.executable, str(root / "docs" / "make_layers_figure.py"), "--check"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    return (done.stdout + done.stderr).splitlines() if done.returncode else []


def main() -> int:
    """Check the repository this script belongs to."""
    root = Path(__file__).resolve().parents[1]
    findings = check(root)
    for finding in findings:
        print(finding)
    print(f"docs: {len(findings)} broken links" if findings else "docs: every link leads somewhere")
    outdated = outdated_pictures(root)
    for finding in outdated:
        print(finding)
    return 1 if findings or outdated else 0


if __name__ == "__main__":
    sys.exit(main())
