"""Row: images are read when one of them is asked for, and once."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import robocell as rc
from robocell._row import Row

IMAGE = np.arange(12).reshape(2, 2, 3)


class Counted:
    def __init__(self) -> None:
        self.reads = 0

    def row(self) -> Row:
        return Row({"time": np.array(0.5)}, ["wrist", "exo"], self.read)

    def read(self) -> dict[str, np.ndarray]:
        self.reads += 1
        return {"wrist": IMAGE, "exo": 2 * IMAGE}


def test_keys_and_numbers_read_no_image():
    counted = Counted()
    row = counted.row()
    assert list(row) == list(row.keys()) == ["time", "wrist", "exo"]
    assert len(row) == 3
    assert "wrist" in row
    assert "wrong" not in row
    assert row["time"] == row.get("time") == 0.5
    assert row.get("wrong", 7) == 7
    row["mine"] = np.array(1.0)
    with pytest.raises(KeyError) as caught:
        row["wrong"]
    assert isinstance(caught.value, rc.NotFoundError)
    assert str(caught.value) == "the row has no 'wrong'. It has: exo, mine, time, wrist"
    assert isinstance(row, dict)
    assert counted.reads == 0


@pytest.mark.parametrize(
    "look",
    [
        lambda row: row["wrist"],
        lambda row: row.get("wrist"),
        lambda row: dict(row)["wrist"],
        lambda row: {**row}["wrist"],
        lambda row: dict(row.items())["wrist"],
        lambda row: list(row.values())[1],
        lambda row: row.copy()["wrist"],
        lambda row: copy.copy(row)["wrist"],
        lambda row: copy.deepcopy(row)["wrist"],
        lambda row: (row | {"a": 1})["wrist"],
        lambda row: ({"a": 1} | row)["wrist"],
        lambda row: row.pop("wrist"),
        lambda row: row.setdefault("wrist"),
        lambda row: pickle.loads(pickle.dumps(dict(row)))["wrist"],
        lambda row: ({}, row)[1] != {} and row["wrist"],
    ],
)
def test_every_way_to_a_value_reads_the_images_once(look: Callable[[Row], Any]):
    counted = Counted()
    row = counted.row()
    assert np.array_equal(look(row), IMAGE)
    assert np.array_equal(row["exo"], 2 * IMAGE)
    assert counted.reads == 1


def test_replaced_values_stay():
    row = Counted().row()
    row["wrist"] = np.zeros(3)
    row.update(exo=np.ones(3))
    assert row["wrist"].shape == row["exo"].shape == (3,)


def test_a_row_that_is_over_says_so():
    row = Row({"time": np.array(0.5)}, ["wrist"], lambda: None)
    assert row["time"] == 0.5
    with pytest.raises(rc.Error, match=r"'wrist' of an earlier row was not read in time"):
        row["wrist"]
