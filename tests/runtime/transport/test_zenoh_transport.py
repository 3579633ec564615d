import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.transport.zenoh_transport import ZenohTransport


@pytest.fixture
def ends() -> Iterator[tuple[ZenohTransport, ZenohTransport]]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        endpoint = f"unixsock-stream/{folder}/zenoh"
        with (
            ZenohTransport("turtle", listen=[endpoint]) as answering,
            ZenohTransport("turtle", connect=[endpoint]) as asking,
        ):
            yield answering, asking


def heard(by: ZenohTransport, of: ZenohTransport) -> float:
    """s until a message of one peer reaches the other."""
    arrived, began = threading.Event(), time.monotonic()
    subscription = by.subscribe("word", lambda *_: arrived.set())
    while not arrived.wait(0.01):
        assert time.monotonic() < began + 10
        of.publish("word", b"")
    subscription.close()
    return time.monotonic() - began


def test_a_peer_does_not_wait_for_missing_peers(tmp_path: Path) -> None:
    seconds = []
    for number in range(3):
        began = time.monotonic()
        with ZenohTransport("turtle", connect=[f"unixsock-stream/{tmp_path}/nobody{number}"]):
            seconds.append(time.monotonic() - began)
    assert min(seconds) < 0.25


def test_a_peer_reconnects_soon() -> None:
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        endpoint = f"unixsock-stream/{folder}/zenoh"
        with ZenohTransport("turtle", connect=[endpoint]) as staying:
            with ZenohTransport("turtle", listen=[endpoint]) as leaving:
                heard(staying, leaving)
            # Pauses between retries grow to a limit, which is reached by now.
            time.sleep(1.8)
            with ZenohTransport("turtle", listen=[endpoint]) as back:
                assert heard(staying, back) < 0.5


def ask(asking: ZenohTransport, name: str, payload: bytes) -> bytes:
    """Ask, and repeat until Zenoh has announced the answering peer."""
    while True:
        try:
            return asking.query_bytes(name, payload)
        except NoAnswerError:
            continue


@pytest.mark.parametrize("payload", [b"", b"{}", b"\0\xff" * 1_000_000])
def test_bytes_are_answered_with_bytes(ends: tuple[ZenohTransport, ZenohTransport], payload: bytes) -> None:
    answering, asking = ends
    answering.serve_bytes("picture", lambda question: question[::-1])
    assert ask(asking, "picture", payload) == payload[::-1]


def test_a_refusal_carries_its_text(ends: tuple[ZenohTransport, ZenohTransport]) -> None:
    answering, asking = ends

    def refuse(question: bytes) -> bytes:
        raise RefusedError(f"no picture {question.decode()} µm wide")

    answering.serve_bytes("picture", refuse)
    with pytest.raises(RefusedError, match="no picture 3 µm wide"):
        ask(asking, "picture", b"3")


def test_an_internal_error_is_answered_without_details(
    ends: tuple[ZenohTransport, ZenohTransport], caplog: pytest.LogCaptureFixture
) -> None:
    answering, asking = ends

    def fail(_: bytes) -> bytes:
        raise RuntimeError("secret")

    answering.serve_bytes("picture", fail)
    with pytest.raises(RefusedError, match="its log says more"):
        ask(asking, "picture", b"")
    assert "secret" in caplog.text


def test_a_request_without_an_answer_times_out(ends: tuple[ZenohTransport, ZenohTransport]) -> None:
    answering, asking = ends
    gate = threading.Event()
    answering.serve_bytes("there", lambda _: b"")
    answering.serve_bytes("picture", lambda _: b"late" if gate.wait(30) else b"")
    ask(asking, "there", b"")
    with pytest.raises(NoAnswerError, match="no answer to picture within"):
        asking.query_bytes("picture", b"", timeout=0.2)
    gate.set()
