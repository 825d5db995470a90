"""benchmarks/augment.py in short: what it counts, and how row P19 is judged."""

import json
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
import augment
from floors import AUGMENTATION
from table import markdown
from verdicts import judge


def test_rate_and_yield_are_those_of_kept_episodes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    totals = {"made": 100, "elapsed_s": 30.0, "success_rate": 0.79}
    event = json.dumps({"event": "finished", "totals": totals})
    monkeypatch.setattr(augment, "_robocell", lambda folder, *arguments: f"{{}}\n{event}\n")
    rows = augment.rows(tmp_path)
    section = {"augment": markdown(rows)}
    says = {floor.what: judge(floor, section).says for floor in AUGMENTATION}
    assert len(says) == 4
    for what, said in says.items():
        assert said == ("**floor missed**" if "yield" in what else "floor met")
