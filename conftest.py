"""Fixtures and rules of every Python test (python/tests, tests, examples)."""

from __future__ import annotations

import gc
import importlib.util
import os
import shutil
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

# Two processes test at once and start hundreds more. NumPy's own threads would take turns with
# them, and starting them takes as long as all else of its import.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

sys.path.insert(0, str(Path(__file__).parent / "python" / "tests"))

import menagerie as _menagerie

_menagerie.adopt_shared_root()

# A shell's background jobs start with Ctrl-C ignored, and so would all that is tested for it.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


# Gigabytes that `scripts/setup` does not bring: its tests are for who has it (CONTRIBUTING.md).
NEEDS = {"stable_baselines3": "test_sb3_learns.py", "torch": "test_torch_steps.py"}
collect_ignore = [
    f"python/tests/{test}" for needed, test in NEEDS.items() if not importlib.util.find_spec(needed)
]
if not shutil.which("chromium"):
    collect_ignore.append("python/tests/test_report_browser.py")


@pytest.fixture
def menagerie() -> _menagerie.Menagerie:
    """The Menagerie's robots; the test is skipped when they are not on this machine."""
    return _menagerie.require_menagerie()


def pytest_collection_finish() -> None:
    """Modules and tests stay to the end: the collector has no need to look at them each time.

    There are so many of them that a collection takes a tenth of a second, and tests of lifetimes
    make hundreds.
    """
    gc.collect()
    gc.freeze()


def pytest_unconfigure() -> None:
    """What is frozen would never go, and nanobind reports at the end what does not."""
    gc.unfreeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Iterator[pytest.TestReport]:
    """With CI=true a skipped test is a failed one: nothing may go untested unnoticed."""
    report = yield
    _fail_if_skipped(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Iterator[pytest.CollectReport]:
    """The same for files that skip themselves."""
    report = yield
    _fail_if_skipped(report)
    return report


def _fail_if_skipped(report: pytest.TestReport | pytest.CollectReport) -> None:
    if report.skipped and not hasattr(report, "wasxfail") and _menagerie.skips_are_failures():
        report.outcome = "failed"
        report.longrepr = f"{report.nodeid} was skipped, and CI allows no skip: {report.longrepr}"
