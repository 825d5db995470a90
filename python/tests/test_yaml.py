"""YAML files of users: no key may be there twice, in mappings and presets of all commands."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from robocell import IoError, SpecError
from robocell._policy_presets import Preset
from robocell._yaml import read_yaml
from robocell.export._mapping import Mapping
from robocell.importer._column_names import Names


def read(file: Path) -> Any:
    return read_yaml(file, "mapping", "robocell.export", "export")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a: 1\nb: 2\na: 3\n", "'a' is there twice, in lines 1 and 3"),
        ("a: 1\nb:\n  - c: 1\n    'c': 2\n", "'c' is there twice, in lines 3 and 4"),
        ("a: {b: 1, b: 2}\n", "'b' is there twice, in line 1"),
        ("? a\n: 1\n? a\n: 2\n", "'a' is there twice, in lines 1 and 3"),
    ],
)
def test_a_key_that_is_there_twice_is_rejected_with_its_lines(tmp_path: Path, text: str, told: str):
    file = tmp_path / "own.yaml"
    file.write_text(text)
    with pytest.raises(SpecError) as raised:
        read(file)
    assert str(raised.value) == f"mapping '{file}': {told}. Keep one"


def test_keys_of_other_tables_and_anchors_may_be_the_same(tmp_path: Path):
    file = tmp_path / "own.yaml"
    file.write_text("a: &a {b: 1, c: 2}\nd: {<<: *a, b: 3}\ne: *a\n1: 0\n'1': 4\n")
    one = {"b": 1, "c": 2}
    assert read(file) == {"a": one, "d": {"b": 3, "c": 2}, "e": one, 1: 0, "1": 4}


def test_files_that_cannot_be_read_are_named(tmp_path: Path):
    file = tmp_path / "own.yaml"
    with pytest.raises(IoError, match=r"cannot read mapping '.*own.yaml': No such file"):
        read(file)
    for content in (b"a: [", b"a: \xff", b"[" * 20_000):
        file.write_bytes(content)
        with pytest.raises(SpecError, match=r"mapping '.*own.yaml' is no YAML"):
            read(file)


@pytest.mark.parametrize(
    ("load", "text"),
    [
        (lambda file: Mapping.load(file), "features: {}\nfeatures: {}\n"),
        (lambda file: Mapping.load(preset=str(file)), "features: {}\nfeatures: {}\n"),
        (Preset.load, "images: {}\nimages: {}\n"),
        (Names.load, "columns: {}\ncolumns: {}\n"),
    ],
)
def test_mappings_and_presets_reject_keys_that_are_there_twice(
    tmp_path: Path, load: Callable[[Path], Any], text: str
):
    file = tmp_path / "own.yaml"
    file.write_text(text)
    with pytest.raises(SpecError, match=r"is there twice, in lines 1 and 2. Keep one"):
        load(file)
