"""A shop of made-up robots in the place of the Menagerie's archives."""

from __future__ import annotations

import hashlib
import tarfile
from pathlib import Path

import mujoco_menagerie
import pytest

MODEL = (
    "<mujoco model='{0}'><worldbody><body name='base'><geom size='.1'/></body></worldbody></mujoco>"
)


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Publishes versions of robots, at first of ``toy_arm``; caches are empty."""
    monkeypatch.delenv("MENAGERIE_ROOT", raising=False)
    monkeypatch.setenv("MENAGERIE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    archives = tmp_path / "archives"
    archives.mkdir()
    monkeypatch.setenv("MENAGERIE_BASE_URL", archives.as_uri())
    here: dict[str, mujoco_menagerie.Robot] = {}

    def publish(version: str, name: str = "toy_arm", model: str = "arm") -> None:
        source = tmp_path / version / name
        source.mkdir(parents=True)
        (source / f"{model}.xml").write_text(MODEL.format(version))
        archive = archives / f"{name}-{version}.tar.xz"
        with tarfile.open(archive, "w:xz") as tar:
            tar.add(source, name)
        here[name] = mujoco_menagerie.Robot(
            name, "A toy", "arm", "Apache-2.0", hashlib.sha1(version.encode()).hexdigest(),
            archive.name, hashlib.sha256(archive.read_bytes()).hexdigest(), archive.stat().st_size,
            1, (mujoco_menagerie.EntryPoint(model, "robot", f"{model}.xml"),), model, None,
        )  # fmt: skip

    def get(name: str) -> mujoco_menagerie.Robot:
        if name not in here:
            raise mujoco_menagerie.UnknownRobotError(name, here)
        return here[name]

    monkeypatch.setattr(mujoco_menagerie, "get", get)
    monkeypatch.setattr(mujoco_menagerie, "commit", lambda: "c0ffee" * 6)
    publish("one")
    return publish


def version_of(path: str | Path) -> str:
    return Path(path).read_text().split("'")[1]
