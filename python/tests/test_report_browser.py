"""The page of `robocell report --output` in a browser: all is drawn, and nothing is fetched."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from command_line import robocell_command
from report_dataset import mixed_dataset

# Nothing leaves the machine, the browser's own requests included.
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("page") / "report.html"
    result = robocell_command("report", mixed_dataset(tmp_path_factory), "-o", out)
    assert result.returncode == 0, result.stderr
    return out


def browse(page: Path) -> subprocess.CompletedProcess[str]:
    """Opens a page in a browser without a window and returns its document, when all is drawn."""
    return subprocess.run(
        [
            "chromium",
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-background-networking",
            f"--user-data-dir={page.parent / 'profile'}",
            OFFLINE,
            "--virtual-time-budget=20000",
            "--enable-logging=stderr",
            "--dump-dom",
            page.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=240,
        check=True,
    )


@pytest.mark.proof
def test_a_browser_draws_the_page_without_a_network(page: Path):
    charts = page.read_text().count('class="plotly-graph-div"')
    assert charts > 15
    shown = browse(page)
    assert shown.stdout.count('class="plot-container plotly"') == charts
    drawn = re.findall(
        r'<svg class="main-svg"[^>]* width="([\d.]+)" height="([\d.]+)"', shown.stdout
    )
    assert len(drawn) >= charts
    assert all(float(width) > 100 and float(height) > 50 for width, height in drawn)
    said = [line for line in shown.stderr.splitlines() if "CONSOLE" in line]
    assert not said, "neither errors nor requests, which the page's policy stops and reports"


@pytest.mark.proof
def test_the_policy_of_the_page_stops_requests(page: Path, tmp_path: Path):
    other = tmp_path / "report.html"
    picture = '<img src="https://robocell.invalid/picture.png"><footer'
    other.write_text(page.read_text().replace("<footer", picture, 1))
    said = [line for line in browse(other).stderr.splitlines() if "CONSOLE" in line]
    assert any("https://robocell.invalid/picture.png" in line for line in said), said
    assert any("Content Security Policy" in line for line in said), said
