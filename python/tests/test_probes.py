"""What `robocell doctor` finds out: whether and with what this machine draws."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from robocell._cli import probes
from robocell._cli.doctor import advice
from robocell._cli.probes import State


def test_the_doctor_does_not_show_an_error_as_a_description(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/no")
    monkeypatch.setenv("PYTHONPATH", ":".join(sys.path))
    egl = next(finding for finding in probes.graphics() if finding.what == "graphics: egl")
    assert egl.state is not State.OK
    assert egl.detail.startswith("egl: ")


def machine_with_a_card(root: Path) -> str:
    """A machine's files: a card, and a driver without its graphics libraries."""
    (root / "dev").mkdir(parents=True)
    (root / "dev" / "nvidia0").touch()
    return str(root)


def test_software_on_a_machine_with_a_card_is_not_ok(tmp_path: Path):
    llvmpipe = probes.Finding("graphics: egl", State.OK, "egl: llvmpipe (LLVM 15.0.6), OpenGL 4.5")
    card = probes.Finding("graphics: egl", State.OK, "egl: NVIDIA H100 PCIe/PCIe/SSE2, OpenGL 4.6")
    assert probes.judged(llvmpipe, str(tmp_path)) == llvmpipe
    root = machine_with_a_card(tmp_path)
    assert probes.judged(card, root) == card
    found = probes.judged(llvmpipe, root)
    assert found.state is State.SLOW
    assert found.detail == llvmpipe.detail
    lines = advice([found])
    assert lines[1].startswith("graphics: egl is slow: images are drawn on the processor (egl: llv")
    assert "(/dev/nvidia0). The driver's EGL library libEGL_nvidia.so.0 is missing." in lines[1]
    assert lines[-1] == "this machine can generate datasets"


def test_without_opengl_soft_draws(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    nothing = probes.Finding("graphics: egl", State.MISSING, "egl: no library")
    monkeypatch.setattr(probes, "_graphics", lambda _: nothing)
    monkeypatch.delenv("ROBOCELL_RENDERER", raising=False)
    found = probes.graphics(str(tmp_path))
    assert {finding.state for finding in found} == {State.MISSING}
    assert "`soft` needs neither" in advice(found)[1]
    assert advice(found)[-1] == "this machine can generate datasets"
    found = probes.graphics(machine_with_a_card(tmp_path / "card"))
    assert {finding.state for finding in found} == {State.SLOW}
    assert "images are drawn on the processor (soft), although this machine has" in found[0].remedy
    monkeypatch.setenv("ROBOCELL_RENDERER", "gl")
    assert {finding.state for finding in probes.graphics(str(tmp_path))} == {State.BROKEN}
