"""Names made to hurt, datasets from elsewhere: errors; nothing runs, nothing is written outside.

Names and paths as such, YAML and episode ids have tests beside their code. There are no archives:
robocell unpacks nothing.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import storm
import yaml
from processes import bare_environment

import robocell
from command_line import robocell_command
from made_once import made_once

ID = "s0000_e0000"
# No backslash: MuJoCo takes it for the separator of folders.
CURIOUS = "a b'\"$(touch injected)`touch injected`;touch injected;ü漢 %s {0} -n"


@pytest.fixture(autouse=True)
def _importable_in_children(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", ":".join(sys.path))


def refused(*arguments: object, folder: Path | None = None) -> str:
    """Standard error of a command that must fail in words."""
    result = robocell_command(*arguments, cwd=folder)
    assert result.returncode in (1, 2, 3), result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    return result.stderr + result.stdout


def write_run(folder: Path, **changes: object) -> Path:
    """A run of one episode, in a file of the folder."""
    path = folder / "run.yaml"
    run = {**storm.RUN, "episodes_per_scene": 1, "output": str(folder / "out"), **changes}
    path.write_text(yaml.safe_dump(run, allow_unicode=True))
    return path


@pytest.fixture(scope="module")
def curious(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset in a folder with a curious name, made by the command that stood in it."""
    return made_once(tmp_path_factory, "curious", make_curious) / CURIOUS / "out"


def make_curious(parent: Path) -> None:
    folder = parent / CURIOUS
    folder.mkdir()
    done = subprocess.run(
        [sys.executable, "-m", "robocell", "generate", write_run(folder)],
        capture_output=True,
        text=True,
        timeout=240,
        cwd=folder,
        env=bare_environment(),
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture
def stranger(curious: Path, tmp_path: Path) -> Path:
    """A copy for a stranger to change."""
    return shutil.copytree(curious, tmp_path / "stranger")


def change(dataset: Path, edit: Callable[[dict[str, Any]], object]) -> None:
    """Rewrites the episode's description, with its hash: strangers can compute, too."""
    path = dataset / ID / "episode.json"
    content = json.loads(path.read_text())
    edit(content)
    content["run"]["json_sha256"] = "0" * 64
    text = json.dumps(content, indent=2)
    assert text.count("0" * 64) == 1
    path.write_text(text.replace("0" * 64, hashlib.sha256(text.encode()).hexdigest()))


def facts(file: Path) -> dict[str, Any]:
    """What an episode's description says of a file."""
    content = file.read_bytes()
    return {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def test_a_hostile_name_is_harmless(curious: Path):
    assert robocell.data.verify(curious, decode_videos=True).ok
    assert robocell.Dataset(curious)[ID].frames("wrist").shape[1:] == (24, 32, 3)
    result = robocell_command("replay", "--check", curious)
    assert result.returncode == 0, result.stdout + result.stderr
    injected = list(curious.parents[1].rglob("injected"))
    assert injected == []
    assert {path.name for path in curious.parent.iterdir()} == {"run.yaml", "out"}


def test_a_cycle_of_links_is_an_error(tmp_path: Path):
    (tmp_path / "loop").symlink_to("loop")
    text = refused("generate", write_run(tmp_path, output=str(tmp_path / "loop" / "out")))
    assert f"cannot look at the dataset's folder '{tmp_path}/loop/out'" in text
    assert "Too many levels of symbolic links" in text
    assert f"no dataset '{tmp_path}/loop'" in refused("verify", tmp_path / "loop")
    text = refused("generate", write_run(tmp_path, robot=str(tmp_path / "loop")))
    assert f"no robot file '{tmp_path}/loop'" in text


def test_a_pipe_in_a_model_does_not_block(tmp_path: Path):
    robot = shutil.copytree(Path(str(storm.RUN["robot"])).parent, tmp_path / "robot")
    model, part = robot / "rc7.xml", robot / "part.xml"
    model.write_text(model.read_text().replace("</mujoco>", '<include file="part.xml"/></mujoco>'))
    os.mkfifo(part)
    file = robot / "rc7.yaml"
    for command in (["check", file], ["generate", write_run(tmp_path, robot=str(file))]):
        text = refused(*command)
        assert f"names the file 'part.xml', and '{part}' is a pipe, not a file" in text


def name_a_camera_outside(content: dict[str, Any]) -> None:
    content["cameras"]["wrist"]["file"] = "../../secret.mp4"


def test_a_camera_file_outside_of_the_episode_is_not_opened(stranger: Path):
    shutil.copy(stranger / ID / "wrist.mp4", stranger.parent / "secret.mp4")
    change(stranger, name_a_camera_outside)
    episode = robocell.Dataset(stranger)[ID]
    with pytest.raises(robocell.Error, match=r"names a file '../../secret.mp4', which is not one"):
        episode.frames("wrist")


@pytest.mark.parametrize("name", ["../secret", "/etc/passwd", "a/../../secret", ".."])
def test_a_listed_file_outside_of_the_episode_is_damage(stranger: Path, name: str):
    (stranger / "secret").write_text("s")
    change(stranger, lambda content: content["files"].update({name: {"bytes": 1}}))
    with pytest.raises(robocell.IoError, match=r"episode\.json lists a file"):
        robocell.Dataset(stranger)[ID]
    assert f"it lists a file '{name}'" in str(robocell.data.verify(stranger))
    robocell.data.repair(stranger)
    assert (stranger / "secret").read_text() == "s"
    assert not (stranger / ID).exists(), "set aside"


PLAYLISTS = {
    "concat": "ffconcat version 1.0\nfile 'secret.mp4'\n",
    "playlist": "#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\nsecret.mp4\n#EXT-X-ENDLIST\n",
}


@pytest.mark.parametrize("kind", PLAYLISTS)
def test_rejects_a_playlist_as_a_video(stranger: Path, kind: str):
    video = stranger / ID / "wrist.mp4"
    shutil.copy(video, stranger / ID / "secret.mp4")
    video.write_text(PLAYLISTS[kind])
    change(stranger, lambda c: c["files"]["wrist.mp4"].update(bytes=video.stat().st_size))
    with pytest.raises(robocell.IoError, match=r"wrist\.mp4"):
        robocell.Dataset(stranger)[ID].frames("wrist")


def test_arrays_that_live_in_other_files_are_not_read(stranger: Path):
    secret = stranger.parent / "secret.h5"
    with h5py.File(secret, "w") as other:
        other["numbers"] = np.arange(8.0)
    steps = stranger / ID / "steps.h5"
    with h5py.File(steps, "r+") as file:
        file["linked"] = h5py.ExternalLink(str(secret), "numbers")
        file["soft"] = h5py.SoftLink("/time")
    change(stranger, lambda c: c["files"]["steps.h5"].update(facts(steps)))
    episode = robocell.Dataset(stranger)[ID]
    assert {"linked", "soft"}.isdisjoint(episode.columns)
    with pytest.raises(robocell.NotFoundError, match="no column 'linked'"):
        episode["linked"]


def put_external(file: h5py.File, secret: Path) -> None:
    file.create_dataset("stolen", (1,), "u1", external=[(str(secret), 0, 1)])


def put_virtual(file: h5py.File, secret: Path) -> None:
    layout = h5py.VirtualLayout((8,), "f8")
    layout[:] = h5py.VirtualSource(str(secret), "numbers", (8,))
    file.create_virtual_dataset("stolen", layout)


@pytest.mark.parametrize("put", [put_external, put_virtual])
def test_rejects_arrays_stored_in_other_files(
    stranger: Path, put: Callable[[h5py.File, Path], None]
):
    secret = stranger.parent / "secret.h5"
    with h5py.File(secret, "w") as other:
        other["numbers"] = np.arange(8.0)
    steps = stranger / ID / "steps.h5"
    with h5py.File(steps, "r+") as file:
        put(file, secret)
    change(stranger, lambda c: c["files"]["steps.h5"].update(facts(steps)))
    message = "array stolen, its numbers are kept in other files"
    with pytest.raises(robocell.IoError, match=message):
        robocell.Dataset(stranger)[ID]["time"]


def swap_model(dataset: Path, text: str, others: Mapping[str, str] = {}) -> None:
    """Puts another robot model into the dataset, as if it had been stored there."""
    files = {"rc7.xml": text, **others}
    lines = "".join(
        f"{hashlib.sha256(files[name].encode()).hexdigest()}  {name}\n" for name in sorted(files)
    )
    name = f"models/rc7-{hashlib.sha256(lines.encode()).hexdigest()[:16]}"
    (dataset / name).mkdir()
    for file, content in files.items():
        (dataset / name / file).write_text(content)

    def edit(content: dict[str, Any]) -> None:
        robot = next(key for key in content["models"] if "rc7" in key)
        content["models"][robot] = f"{name}/rc7.xml"

    change(dataset, edit)


MODELS = {
    "include": ('<mujoco><include file="/etc/passwd"/></mujoco>', "names '/etc/passwd', which is"),
    "climb": ('<mujoco><include file="../../../secret.xml"/></mujoco>', "secret.xml', which is"),
    "mesh": (
        '<mujoco><asset><mesh name="m" file="{secret}"/></asset></mujoco>',
        "secret.xml', which is outside the files stored for this model",
    ),
    "texture": (
        '<mujoco><compiler texturedir="{folder}"/><asset>'
        '<texture name="t" type="2d" file="secret.xml"/></asset></mujoco>',
        "secret.xml', which is outside",
    ),
    "entities": (
        '<mujoco><include file="&#46;&#46;/&#46;&#46;/&#46;&#46;/secret.xml"/></mujoco>',
        "secret.xml', which is outside",
    ),
    "comment": (
        '<mujoco model="<!--"><include file="{secret}"/></mujoco>',
        "secret.xml', which is outside",
    ),
    "backslash": (
        r'<mujoco><include file="..\..\..\secret.xml"/></mujoco>',
        "secret.xml', which is outside",
    ),
    "missing": (
        '<mujoco><asset><mesh name="m" file="../../../later.obj"/></asset></mujoco>',
        "names '../../../later.obj', which is not among the files stored",
    ),
    "text": (
        '<mujoco><include file="LoadModelFromString:&lt;mujoco/&gt;"/></mujoco>',
        "names 'LoadModelFromString:<mujoco/>', which is not among the files stored",
    ),
    "no xml": ("PK", "rc7.xml' of its model cannot be read as XML"),
    "plugin": (
        '<mujoco><extension><plugin plugin="evil.so"><instance name="x"/></plugin></extension>'
        "</mujoco>",
        "evil.so",
    ),
}


@pytest.mark.parametrize("kind", MODELS)
def test_a_stored_model_cannot_access_other_files_or_code(stranger: Path, kind: str):
    secret = stranger.parent / "secret.xml"
    secret.write_text("<mujoco><worldbody/></mujoco>")
    text, message = MODELS[kind]
    swap_model(stranger, text.format(secret=secret, folder=secret.parent))
    episode = robocell.Dataset(stranger)[ID]
    with pytest.raises(robocell.Error) as raised:
        robocell.Scene.build(robocell.data.recorded_scene(episode))
    assert message in str(raised.value)


def test_an_include_of_any_suffix_is_read(stranger: Path):
    secret = stranger.parent / "secret.xml"
    secret.write_text("<mujoco><worldbody/></mujoco>")
    part = f'<mujoco><include file="{secret}"/></mujoco>'
    swap_model(stranger, '<mujoco><include file="part.txt"/></mujoco>', {"part.txt": part})
    with pytest.raises(robocell.SpecError, match=r"secret\.xml', which is outside"):
        robocell.data.recorded_scene(robocell.Dataset(stranger)[ID])


@pytest.mark.parametrize("name", ["/etc/passwd", "../secret.xml"])
def test_a_recorded_scene_cannot_name_files_of_this_machine(stranger: Path, name: str):
    def edit(content: dict[str, Any]) -> None:
        scene = content["metadata"]["scene_spec"]
        robot = next(key for key in content["models"] if "rc7" in key)
        assert robot in scene
        content["metadata"]["scene_spec"] = scene.replace(f"model: {robot}", f"model: {name}")

    change(stranger, edit)
    with pytest.raises(robocell.SpecError, match=f"its scene names the model '{name}'"):
        robocell.data.recorded_scene(robocell.Dataset(stranger)[ID])


def test_a_model_path_outside_the_dataset_is_damage(stranger: Path):
    def edit(content: dict[str, Any]) -> None:
        for robot in content["models"]:
            content["models"][robot] = "models/rc7-0123456789abcdef/../../../../etc/passwd"

    change(stranger, edit)
    with pytest.raises(robocell.IoError, match=r"episode.json keeps model .* at "):
        robocell.Dataset(stranger)[ID]


def test_a_cache_of_downloads_is_read_through_its_links(stranger: Path):
    blobs = stranger.parent / "blobs"
    blobs.mkdir()
    for path in sorted(stranger.rglob("*")):
        if path.is_file() and not any(part.startswith(".") for part in path.parts[-2:]):
            blob = blobs / hashlib.sha256(path.read_bytes()).hexdigest()
            path.rename(blob)
            path.symlink_to(os.path.relpath(blob, path.parent))
    before = {blob: blob.read_bytes() for blob in blobs.iterdir()}
    assert (stranger / "dataset.json").is_symlink()
    episode = robocell.Dataset(stranger)[ID]
    for stream in episode.cameras:
        assert len(episode.frames(stream)) == len(episode)
    for command in (["verify", "--decode-videos"], ["report"], ["replay", "--check"]):
        done = robocell_command(*command, stranger)
        assert done.returncode == 0, done.stderr + done.stdout
    (stranger / ID / "steps.h5").unlink()
    (stranger / ID / "steps.h5").symlink_to("/dev/zero")
    assert f"{ID}/steps.h5: it is a link to '/dev/zero', not a file" in refused("verify", stranger)
    assert robocell_command("verify", "--repair", stranger).returncode == 0
    assert {blob: blob.read_bytes() for blob in blobs.iterdir()} == before


def test_a_lock_that_is_a_link_writes_to_no_other_file(stranger: Path):
    victim = stranger.parent / "precious.txt"
    victim.write_text("precious")
    for name in (".lock", ".lock-writers"):
        (stranger / name).unlink(missing_ok=True)
        (stranger / name).symlink_to(victim)
        expected = f"'{stranger / name}': it is a link to '{victim}', not a file. Remove it"
        assert expected in refused("verify", "--repair", stranger)
        (stranger / name).unlink()
    (stranger / ".lock").unlink(missing_ok=True)
    (stranger / ".lock").symlink_to(victim)
    assert "it is a link" in refused("generate", write_run(stranger.parent, output=str(stranger)))
    assert victim.read_text() == "precious"


@pytest.mark.parametrize("name", [".quarantine", "models", ".logs"])
def test_nothing_is_moved_or_written_through_a_link(stranger: Path, name: str):
    elsewhere = stranger.parent / "elsewhere"
    elsewhere.mkdir()
    if (stranger / name).exists():
        shutil.rmtree(stranger / name)
    (stranger / name).symlink_to(elsewhere)
    (stranger / ID / "steps.h5").write_bytes(b"damaged")
    run = write_run(stranger.parent, output=str(stranger))
    for command in (["verify", "--repair", stranger], ["generate", run]):
        text = refused(*command)
        assert f"'{stranger / name}': it is a link to '{elsewhere}'" in text
        assert "Remove it, or replace" in text
    assert f"{name}: it is a link to '{elsewhere}'" in refused("verify", stranger)
    assert list(elsewhere.iterdir()) == []
    assert (stranger / ID).exists()


def test_a_log_that_is_a_link_is_not_written(stranger: Path):
    victim = stranger.parent / "precious.txt"
    victim.write_text("precious")
    (stranger / ".logs").mkdir(exist_ok=True)
    log = stranger / ".logs" / "worker-0.log"
    log.unlink(missing_ok=True)
    log.symlink_to(victim)
    shutil.rmtree(stranger / ID)
    text = refused("generate", write_run(stranger.parent, output=str(stranger)))
    assert f"'{log}': it is a link to '{victim}'" in text
    assert victim.read_text() == "precious"


def test_pipes_and_devices_are_named_and_not_opened(stranger: Path):
    manifest = stranger / "dataset.json"
    model = next((stranger / "models").glob("rc7-*/rc7.xml"))
    for path in (stranger / ID / "episode.json", manifest, model):
        path.unlink()
        os.mkfifo(path)
    text = refused("verify", stranger)
    assert f"{ID}/episode.json: it is a pipe, not a file" in text
    assert f"'{manifest}': it is a pipe, not a file" in text
    assert f"'{model}': it is a pipe, not a file" in text
    manifest.unlink()
    manifest.symlink_to("/dev/zero")
    assert f"'{manifest}': it is a link to '/dev/zero', not a file" in refused("verify", stranger)


def test_looking_at_a_strangers_dataset_writes_nothing(stranger: Path):
    change(stranger, name_a_camera_outside)

    def state() -> dict[Path, tuple[int, int]]:
        files = stranger.parent.rglob("*")
        return {path: (path.stat().st_mtime_ns, path.stat().st_size) for path in files}

    swap_model(stranger, '<mujoco><include file="/etc/passwd"/></mujoco>')
    before = state()
    robocell_command("verify", stranger)
    assert "names '/etc/passwd', which is" in refused("replay", "--check", stranger)
    robocell_command("report", stranger)
    assert state() == before
