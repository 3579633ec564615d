import asyncio
import json
import socket as sockets
from collections.abc import Callable
from dataclasses import replace
from itertools import chain
from math import inf
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection
from websockets.exceptions import ConnectionClosed, InvalidStatus

import server.stream.bridge as bridge_module
import server.stream.hub as hub_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.transport.blocks import Block, read_blocks
from server.features.live.connection import INVALID_MAX
from server.http.serving import MESSAGE_BYTES_MAX
from server.http.sign_in.access import Access
from server.http.sign_in.identity import SHELL, Identity
from server.platform.settings import Settings
from server.stream.hub import Hub
from tests.server.blocks import debug_block, depth_block, picture_block
from tests.server.serving import Served, next_text, serve
from tests.server.waiting import SECONDS, until
from tests.shell import shell_headers


async def read_until(socket: ClientConnection, condition: Callable[[list[Block]], object]) -> list[Block]:
    """Return all blocks until the condition holds."""
    blocks: list[Block] = []
    async with asyncio.timeout(SECONDS):
        while not condition(blocks):
            message = await socket.recv()
            if isinstance(message, bytes):
                blocks += read_blocks(message)
    return blocks


def numbers(blocks: list[Block], topic: str) -> list[int]:
    return [
        number
        for block in blocks
        if block.topic.name == topic
        for number in range(block.first, block.first + block.count)
    ]


async def test_a_page_gets_greeting_history_and_live_messages_without_gap_or_duplicate(
    served: Served,
) -> None:
    await served.heard("stream")
    start = served.container.clock.now()
    served.runtime.publish(*(depth_block(5 * position, 5, start) for position in range(10)))
    seen = served.get(Hub).history

    def stored_numbers() -> list[int]:
        return numbers(read_blocks(b"".join(chain.from_iterable(seen.since(-1, 1)))), "depth")

    await until(lambda: len(stored_numbers()) == 50, "the past")
    async with served.connect() as page:
        hello = json.loads(await page.recv())
        assert hello["op"] == "hello"
        assert (hello["robot"], hello["definitions"]) == ("tested", f"{DEFINITIONS_HASH:08x}")
        assert hello["steady"] <= served.container.clock.now()
        assert hello["utc"] > 1.7e9
        assert hello["page_version"] == ""
        served.runtime.publish(*(depth_block(50 + 5 * position, 5, start) for position in range(10)))
        served.runtime.publish(debug_block(0, "é"))
        blocks = await read_until(
            page, lambda blocks: len(numbers(blocks, "depth")) >= 100 and numbers(blocks, "debug")
        )
        assert numbers(blocks, "depth") == list(range(100))
        (line,) = (block for block in blocks if block.topic.name == "debug")
        assert json.loads(line.payload)[0]["text"] == "é"


async def test_changes_of_health_and_recording_are_sent(served: Served) -> None:
    async with served.connect() as page:
        health = await next_text(page, "health")
        assert [part["name"] for part in health["parts"]][:2] == ["server", "database"]
    async with served.connect() as page:
        assert (await next_text(page, "session"))["recording"] is None
        session = (await served.api.post("/sessions", json={"name": "Dive"})).json()
        recording = (await next_text(page, "session"))["recording"]
        assert recording == session
        await served.api.post(f"/sessions/{session['id']}/stop")
        while (await next_text(page, "session"))["recording"] is not None:
            pass
    async with served.connect() as page:
        blocks = await read_until(page, lambda blocks: len(said_of_recording(blocks)) == 2)
        assert said_of_recording(blocks) == [
            "Recording of “Dive” has begun.",
            "Recording of “Dive” has ended.",
        ]


def said_of_recording(blocks: list[Block]) -> list[str]:
    events = [json.loads(block.payload)[0] for block in blocks if block.topic.name == "notice"]
    return [event["text"] for event in events if event["kind"] == "recording"]


async def test_ping_and_stop(served: Served) -> None:
    async with served.connect() as page:
        hello = await next_text(page, "hello")
        for identifier in (7, "a", 1.5):
            await page.send(json.dumps({"op": "ping", "id": identifier}))
            pong = await next_text(page, "pong")
            assert pong["id"] == identifier
            assert pong["steady"] >= hello["steady"]
            assert pong["utc"] - pong["steady"] == pytest.approx(hello["utc"] - hello["steady"], abs=1)
        await page.send('{"op": "stop"}')
        await until(lambda: served.runtime.asked == [("stop", {})], "the STOP")


async def test_a_ping_whose_id_json_cannot_write_is_refused(served: Served) -> None:
    async with served.connect() as page:
        await page.send('{"op": "ping", "id": 1e999}')
        await page.send('{"op": "ping", "id": "after it"}')
        async with asyncio.timeout(SECONDS):
            async for message in page:
                if isinstance(message, str) and '"pong"' in message:
                    assert "after it" in message
                    break


async def test_stops_during_a_pending_stop_become_one_more(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    # The first one is pending until it is answered, however busy the computer is.
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", SECONDS)
    async with served.connect() as page:
        served.runtime.gates["stop"].clear()
        await page.send('{"op": "stop"}')
        await until(lambda: len(served.runtime.asked) == 1, "the STOP")
        for _ in range(50):
            await page.send('{"op": "stop"}')
        await page.send('{"op": "ping", "id": 8}')
        assert (await next_text(page, "pong"))["id"] == 8
        served.runtime.gates["stop"].set()
        await until(lambda: len(served.runtime.asked) == 2, "another STOP")
        await page.send('{"op": "ping", "id": 9}')
        await next_text(page, "pong")
        assert len(served.runtime.asked) == 2


async def test_a_stop_without_an_answer_is_reported(served: Served) -> None:
    served.runtime.__exit__()
    async with served.connect() as page:
        await page.send('{"op": "stop"}')
        assert "STOP has not been confirmed" in (await next_text(page, "error"))["text"]


NONSENSE: list[str | bytes] = [
    "",
    "nonsense",
    "[]",
    "3",
    "{}",
    '{"op": "arm"}',
    '{"op": ["stop"]}',
    '{"op": "ping"}',
    '{"op": "ping", "id": null}',
    '{"op": "ping", "id": NaN}',
    '{"op": "ping", "id": true}',
    "[" * 4000,
    b'{"op": "stop"}',
]


async def test_invalid_messages_are_answered_with_the_reason_and_do_nothing(served: Served) -> None:
    async with served.connect() as page:
        for message in NONSENSE:
            await page.send(message)
            assert (await next_text(page, "error"))["text"]
    assert served.runtime.asked == []


async def test_too_many_invalid_messages_close_the_socket(served: Served) -> None:
    async with served.connect() as page:
        for _ in range(INVALID_MAX - 1):
            await page.send("x")
        await page.send('{"op": "ping", "id": 1}')
        await next_text(page, "pong")
        for _ in range(INVALID_MAX):
            await page.send("x")
        with pytest.raises(ConnectionClosed) as closed:
            await read_until(page, lambda _: False)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008
    assert "20 messages in a row" in closed.value.rcvd.reason


async def test_messages_of_a_page_are_limited_in_size(served: Served) -> None:
    async with served.connect() as page:
        frame = '{"op": "ping", "id": "%s"}'
        room = MESSAGE_BYTES_MAX - len(frame) + 2
        await page.send(frame % ("x" * room))
        assert len((await next_text(page, "pong"))["id"]) == room
        await page.send(frame % ("x" * (room + 1)))
        with pytest.raises(ConnectionClosed) as closed:
            await read_until(page, lambda _: False)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1009


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1"])
async def test_foreign_pages_get_no_socket(origin: str, served: Served) -> None:
    with pytest.raises(InvalidStatus) as refused:
        await served.connect(origin=origin)
    assert refused.value.response.status_code == 403
    assert served.get(Hub).clients == 0
    async with served.connect(origin=None) as program:
        assert await program.recv()


async def test_pictures_are_requested_only_while_a_page_is_open(served: Served) -> None:
    await served.heard("stream")
    assert not served.runtime.is_heard("picture")
    async with served.connect() as page:
        await served.heard("picture")
        served.runtime.publish(picture_block(3, size=5000))
        blocks = await read_until(page, lambda blocks: numbers(blocks, "picture"))
        (picture,) = (block for block in blocks if block.topic.name == "picture")
        assert picture == picture_block(3, size=5000)
    await until(lambda: not served.runtime.is_heard("picture"), "the end of the pictures")


async def test_a_page_that_stops_reading_is_disconnected_and_the_others_miss_nothing(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub_module, "STALL_SECONDS", 0.3)
    monkeypatch.setattr(hub_module, "WATCH_SECONDS", 0.05)

    async with serve(settings) as served:
        stalled = await stall(served)
        hub = served.get(Hub)
        await until(lambda: hub.clients == 1, "the stalled page")
        others = {*hub._clients}
        async with served.connect() as page:
            await until(lambda: hub.clients == 2, "both pages")
            (reader,) = hub._clients.keys() - others
            # It reads, but in this process, which may be held for longer than a page may stall here.
            reader._clock = SimulatedClock(inf)
            reader.sending_since = None
            total = 0
            reading = asyncio.create_task(read_until(page, lambda _: False))
            async with asyncio.timeout(SECONDS):
                while hub.clients == 2:
                    served.runtime.publish(depth_block(total, 1000))
                    total += 1000
                    await asyncio.sleep(0.01)
            reading.cancel()
            received = await asyncio.gather(reading, return_exceptions=True)
            assert isinstance(received[0], asyncio.CancelledError)
            served.runtime.publish(debug_block(0, "still here"))
            await read_until(page, lambda blocks: numbers(blocks, "debug"))
        stalled.close()


async def stall(served: Served) -> sockets.socket:
    """Return a page that opens a socket with a small buffer and never reads."""
    page = sockets.socket()
    page.setsockopt(sockets.SOL_SOCKET, sockets.SO_RCVBUF, 4096)
    page.setblocking(False)
    loop = asyncio.get_running_loop()
    port = served.settings.server.port
    await loop.sock_connect(page, ("127.0.0.1", port))
    head: dict[str, Any] = {
        "Host": f"127.0.0.1:{port}",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Version": "13",
    } | shell_headers(served.settings.data)
    lines = "".join(f"{name}: {value}\r\n" for name, value in head.items())
    await loop.sock_sendall(page, f"GET /api/live HTTP/1.1\r\n{lines}\r\n".encode())
    return page


@pytest.mark.parametrize(
    ("present", "reason"),
    [(None, "revoked"), (replace(SHELL, role="viewer"), "has changed")],
)
async def test_a_socket_that_opens_while_its_access_changes_is_closed(
    monkeypatch: pytest.MonkeyPatch, present: Identity | None, reason: str, served: Served
) -> None:
    access = served.get(Access)
    # The first answer is at the admission, the second once the socket is open.
    answers = iter([SHELL, present])
    monkeypatch.setattr(access, "refresh", lambda _: next(answers))
    async with served.connect() as page:
        with pytest.raises(ConnectionClosed, match=reason):
            await next_text(page, "hello")
