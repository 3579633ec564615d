import re
import select
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh

from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.transport.zenoh_transport import ZenohTransport
from tests.stack import ROOT
from tests.waiting import SECONDS


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
        assert time.monotonic() < began + SECONDS
        of.publish("word", b"")
    subscription.close()
    return time.monotonic() - began


def test_a_peer_does_not_wait_for_missing_peers(tmp_path: Path) -> None:
    def opening() -> float:
        began = time.monotonic()
        with ZenohTransport("turtle", connect=[f"unixsock-stream/{tmp_path}/nobody"]):
            return time.monotonic() - began

    # A busy computer delays any of them; one that is quick shows that none waits.
    end = time.monotonic() + SECONDS
    while opening() >= 0.25:
        assert time.monotonic() < end


def test_a_peer_reconnects_soon() -> None:
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        endpoint = f"unixsock-stream/{folder}/zenoh"
        seconds: list[float] = []
        with ZenohTransport("turtle", connect=[endpoint]) as staying:
            # A busy computer delays some of them.
            while len(seconds) < 4 or min(seconds[1:]) >= 0.5:
                assert len(seconds) < 12, seconds
                with ZenohTransport("turtle", listen=[endpoint]) as coming_and_leaving:
                    seconds.append(heard(staying, coming_and_leaving))
                # Pauses between retries grow to a limit, which is reached by now.
                time.sleep(1.8)


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
    answering.serve_bytes("picture", lambda _: b"late" if gate.wait(SECONDS) else b"")
    ask(asking, "there", b"")
    with pytest.raises(NoAnswerError, match="no answer to picture within"):
        asking.query_bytes("picture", b"", timeout=0.2)
    gate.set()


SLOW_READER = """
import os, sys, threading

# Of Zenoh's own threads, so that it asks while it does not read.
one = "(worker_threads: 1)"
os.environ["ZENOH_RUNTIME"] = f"(net: {one}, acc: {one}, rx: {one}, tx: {one})"

import zenoh
from robot_runtime.transport.zenoh_transport import ZenohTransport

begun, asked = threading.Event(), threading.Event()

def read(_):
    begun.set()
    asked.wait()

with ZenohTransport("turtle", connect=[sys.argv[1]]) as reader:
    session = reader._session
    flood = session.declare_subscriber("mucat/turtle/flood", zenoh.handlers.Callback(read, indirect=False))
    begun.wait()
    print("reads nothing", flush=True)
    sys.stdin.readline()
    threading.Timer(0.5, asked.set).start()
    print([reply.err.payload.to_string() for reply in session.get("mucat/turtle/nothing", timeout=4.0)])
"""


def test_what_is_received_while_the_queue_is_full_does_not_stop_the_sending() -> None:
    """A thread that did both would wait for itself, for 5 s."""
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        endpoint = f"unixsock-stream/{folder}/zenoh"
        with ZenohTransport("turtle", listen=[endpoint]) as sender:
            # Ended in the thread that receives, as Zenoh ends a question that nobody answers.
            end = zenoh.handlers.Callback(zenoh.Query.drop, indirect=False)
            sender._session.declare_queryable("mucat/turtle/nothing", end)
            with subprocess.Popen(
                [sys.executable, "-c", SLOW_READER, endpoint],
                cwd=ROOT,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            ) as reader:
                assert reader.stdout is not None
                while not select.select([reader.stdout], [], [], 0.0)[0]:
                    sender.publish("flood", bytes(100_000))
                # More than the queue and the socket hold.
                for _ in range(20):
                    sender.publish("flood", bytes(100_000))
                assert reader.communicate("ask\n", 60)[0] == "reads nothing\n[]\n"


def test_an_unreachable_robot_is_said_without_paths_of_zenoh_s_source(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="cannot reach unixsock-stream/") as result:
        ZenohTransport("turtle", connect=[f"unixsock-stream/{tmp_path}/nobody"], client=True)
    assert not re.search(r"\.rs\b|cargo|Single", str(result.value))
