"""Links in the pages are checked, and the checker notices broken ones."""

from __future__ import annotations

from pathlib import Path

import check_docs

ROOT = Path(__file__).resolve().parents[1]


def test_every_link_of_this_repository_leads_somewhere():
    assert check_docs.check(ROOT) == []


def test_a_missing_file_and_a_missing_heading_are_found(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "# Top\n[a](gone.md) ![p](gone.png) [b](#nowhere) [c](#two-words)\n## Two words\n"
        "[web](https://example.org) [here](page.md#top)\n```\n[code](is-not.md)\n```\n"
    )
    assert list(check_docs.broken_links(page)) == [
        "gone.md: no such file",
        "gone.png: no such file",
        "#nowhere: no such heading",
    ]


def test_anchors_keep_underscores():
    assert check_docs.anchor(" `control_loop` ") == "control_loop"
    assert check_docs.anchor("_Two_ *Words*") == "two-words"


def test_the_diagram_of_layers_matches_the_rules():
    assert check_docs.outdated_pictures(ROOT) == []
