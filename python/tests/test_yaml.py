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
    return read_yaml(file, "mapping", "robocell.export", "export")[0]


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


def test_places_are_those_of_the_entries(tmp_path: Path):
    file = tmp_path / "own.yaml"
    file.write_text("a:\n  b.c: [1, {d: 2}]\n  7: x\ne: &e\n  f: 1\ng:\n  <<: *e\n")
    _, place = read_yaml(file, "mapping", "robocell.export", "export")
    assert str(place) == f"mapping '{file}'"
    for path, text in (
        (("a",), ":1:1': a"),
        (("a", "b.c"), ":2:3': a.b.c"),
        (("a", "b.c", 1), ":2:12': a.b.c[1]"),
        (("a", "b.c", 1, "d"), ":2:13': a.b.c[1].d"),
        (("a", "7"), ":3:3': a.7"),
        (("a", "b.c", 9), ":2:3': a.b.c[9]"),
        (("none", "of", "them"), "': none.of.them"),
        (("g", "f"), ":5:3': g.f"),
    ):
        assert str(place.at(*path)) == f"mapping '{file}{text}"
        assert str(place.near(*path)) == f"mapping '{file}{text[: text.index(chr(39)) + 1]}"


def test_a_place_is_in_the_file_that_has_the_entry(tmp_path: Path):
    places = []
    for name, text in (("own", "a: {b: 1}\n"), ("base", "# built in\na: {b: 2, c: 3}\nd: 4\n")):
        file = tmp_path / name
        file.write_text(text)
        shown = {"name": name, "has_lines": name == "own"}
        places.append(read_yaml(file, "preset", "robocell.export", "export", **shown)[1])
    place = places[0].over(places[1])
    assert str(place) == "preset 'own'"
    assert str(place.at("a", "b")) == "preset 'own:1:5': a.b"
    assert str(place.at("a", "c")) == "preset 'base': a.c"
    assert str(place.at("d")) == "preset 'base': d"
    assert str(place.at("e")) == "preset 'own': e"


@pytest.mark.parametrize(
    ("load", "text", "told"),
    [
        (
            Mapping.load,
            "# mine\nfeatures:\n  x: [{column: a, times: 0}]\n",
            ":3:19': features.x[0].t",
        ),
        (Mapping.load, "image_size: [3]\n", ":1:1': image_size is width and height"),
        (Mapping.load, "task: instruction\nfeature: {}\n", ":2:1': no field 'feature'"),
        (Mapping.load, "images:\n  a: '{robot}'\n", ":2:3': images.a: no placeholder '{robot}'"),
        (
            lambda file: Mapping.load(preset=str(file)),
            "gripper: {open: a, closed: 1}",
            ":1:11': gr",
        ),
        (Preset.load, "actions:\n  - a\n  - {colum: b}\n", ":3:5': actions[1]: expected a column"),
        (Preset.load, "extends: droid\nrate: -1\n", ":2:1': rate is a number above 0"),
        (Names.load, "columns: {}\ncameras:\n  top: 3\n", ":3:3': cameras.top is a name or null"),
        (Names.load, "columns:\n  a: {b: [2, 1]}\n", ":2:3': columns.a is a column, null"),
    ],
)
def test_mistakes_in_mappings_and_presets_name_line_and_column(
    tmp_path: Path, load: Callable[[Path], Any], text: str, told: str
):
    file = tmp_path / "own.yaml"
    file.write_text(text)
    with pytest.raises(SpecError) as raised:
        load(file)
    assert f"'{file}{told}" in str(raised.value)
