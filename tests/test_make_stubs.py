"""The stubs of the extension: what stubgen gets wrong is put right."""

from __future__ import annotations

from make_stubs import without_false_imports


def test_false_imports_are_removed_from_stubs():
    text = "import enum\nimport Kind\nimport Kinder\n\nclass Kind(enum.Enum): ...\n"
    assert without_false_imports(text) == (
        "import enum\nimport Kinder\n\nclass Kind(enum.Enum): ...\n"
    )
