"""Messages between supervisor and worker: lines of JSON in any pieces, and exceptions as values."""

import pytest

import robocell as rc
from robocell._generation.protocol import Failure, LineReader, ProtocolError, encode


def test_messages_round_trip_for_any_chunking():
    sent = [{"ready": True}, {"done": {"id": "s0_e1", "text": "a\nb \u00e9"}}, {"stop": True}]
    data = b"".join(encode(message) for message in sent)
    assert data.count(b"\n") == len(sent)
    for size in (1, 2, 7, len(data)):
        reader, got = LineReader(), []
        for start in range(0, len(data), size):
            got += reader.feed(data[start : start + size])
        assert got == sent


def test_an_unfinished_line_waits_for_its_end():
    reader = LineReader()
    assert list(reader.feed(b'{"ready"')) == []
    assert list(reader.feed(b": true}\n{")) == [{"ready": True}]


@pytest.mark.parametrize("line", [b"hello\n", b"[1]\n", b"\xff\n", b"\n"])
def test_rejects_and_quotes_an_invalid_message(line):
    with pytest.raises(ProtocolError, match="not a message: b"):
        list(LineReader().feed(line))


@pytest.mark.parametrize(
    ("error", "kind", "raised"),
    [
        (rc.SpecError("run.yaml:1:1: no field"), "spec", rc.SpecError),
        (rc.NotFoundError("no robot"), "spec", rc.SpecError),
        (rc.IoError("disk full"), "io", rc.IoError),
        (OSError(28, "No space left on device"), "io", rc.IoError),
        (rc.EngineError("nan in qacc"), "other", rc.Error),
    ],
)
def test_an_exception_arrives_with_its_kind_and_text(error, kind, raised):
    failure = Failure.from_json(Failure.of(error, loading=True).to_json())
    assert failure == Failure(kind, str(error))
    assert type(failure.error()) is raised
    assert str(failure.error()) == str(error)


def test_an_exception_in_user_code_has_file_and_line():
    try:
        raise KeyError("mug")
    except KeyError as error:
        failure = Failure.of(error)
    assert failure.kind == "other"
    assert "KeyError" in failure.message
    assert "test_protocol.py" in failure.message
