"""The stubs of the extension: what stubgen gets wrong is put right."""

from __future__ import annotations

from make_stubs import without_false_imports


def test_imports_of_the_stubs_own_classes_are_dropped_and_others_stay():
    text = "import enum\nimport Kind\nimport Kinder\n\nclass Kind(enum.Enum): ...\n"
    assert without_false_imports(text) == (
        "import enum\nimport Kinder\n\nclass Kind(enum.Enum): ...\n"
    )
