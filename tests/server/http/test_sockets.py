"""Binary messages of any size, in frames as every WebSocket client reads them."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest
from fastapi import FastAPI, WebSocket
from uvicorn.protocols.utils import ClientDisconnected
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosedOK

from server.http import websocket_protocol
from server.http.listener import open_socket
from server.http.serving import make_server
from server.http.websocket_protocol import PARTS_MAX, PIECE_BYTES, UNREAD_MAX, WebSocketProtocol
from tests.server.waiting import SECONDS, SOCKET_LIMITS

SIZES = (0, 1, 125, 126, 65_535, 65_536, 300_000)


async def test_messages_of_every_size_arrive_whole_and_between_texts() -> None:
    app = FastAPI()

    @app.websocket("/")
    async def send_all(socket: WebSocket) -> None:
        await socket.accept()
        for size in SIZES:
            await socket.send_bytes(bytes(size - 1) + b"x" if size else b"")
            await socket.send_text(str(size))
        await socket.close()

    async with _serve(app) as url, connect(url, max_size=None, **SOCKET_LIMITS) as client:
        for size in SIZES:
            data = await client.recv()
            assert isinstance(data, bytes)
            assert len(data) == size
            assert data[-1:] == (b"x" if size else b"")
            assert await client.recv() == str(size)
        with pytest.raises(ConnectionClosedOK):
            await client.recv()


async def test_nothing_is_sent_to_a_closed_socket() -> None:
    app = FastAPI()
    outcomes: list[BaseException] = []
    over = asyncio.Event()

    @app.websocket("/")
    async def send_after_the_end(socket: WebSocket) -> None:
        await socket.accept()
        assert (await socket.receive())["type"] == "websocket.disconnect"
        # Starlette does this itself; here for a sender that has not received the end yet.
        raw: Any = socket._send
        try:
            await raw({"type": "websocket.send", "bytes": b"late"})
        except BaseException as problem:
            outcomes.append(problem)
        over.set()

    async with _serve(app) as url:
        async with connect(url, **SOCKET_LIMITS):
            pass
        await over.wait()
    assert [type(problem) for problem in outcomes] == [ClientDisconnected]


async def test_the_server_ends_in_order_while_a_page_that_has_left_still_has_unread_data() -> None:
    ended: list[bool] = []
    clients: list[ClientConnection] = []

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        yield
        ended.append(True)
        clients[0].transport.abort()

    app = FastAPI(lifespan=lifespan)
    remaining = asyncio.Event()

    @app.websocket("/")
    async def send_much(socket: WebSocket) -> None:
        await socket.accept()
        await socket.send_bytes(bytes(5_000_000))
        while (await socket.receive())["type"] != "websocket.disconnect":
            pass
        remaining.set()

    async with _serve(app) as url:
        clients.append(client := await connect(url, max_size=None, **SOCKET_LIMITS))
        client.transport.pause_reading()
        client.protocol.send_close(1001)
        client.transport.write(b"".join(client.protocol.data_to_send()))
        await remaining.wait()
    assert ended == [True]


@pytest.fixture
def protocols(monkeypatch: pytest.MonkeyPatch) -> list[WebSocketProtocol]:
    """The server's ends of the sockets that were opened."""
    results: list[WebSocketProtocol] = []
    opened = WebSocketProtocol.connection_made

    def note(protocol: WebSocketProtocol, transport: Any) -> None:
        results.append(protocol)
        opened(protocol, transport)

    monkeypatch.setattr(WebSocketProtocol, "connection_made", note)
    return results


async def test_a_burst_of_small_messages_is_taken_in_pieces(protocols: list[WebSocketProtocol]) -> None:
    sent, most = 20_000, 0
    app, done = FastAPI(), asyncio.Event()
    numbers: list[int] = []

    @app.websocket("/")
    async def take_all(socket: WebSocket) -> None:
        nonlocal most
        await socket.accept()
        protocol: Any = protocols[0]
        while len(numbers) < sent:
            numbers.append(int(await socket.receive_text()))
            most = max(most, protocol.queue.qsize())
        done.set()

    async with _serve(app) as url, connect(url, **SOCKET_LIMITS) as client:
        client.transport.write(b"".join(_frame(str(number).encode()) for number in range(sent)))
        await done.wait()
    assert numbers == list(range(sent))
    assert most <= PIECE_BYTES / len(_frame(b"1"))


async def test_others_have_a_turn_after_each_message() -> None:
    app, done = FastAPI(), asyncio.Event()
    turns: list[int] = []
    turn = 0

    @app.websocket("/")
    async def take_all(socket: WebSocket) -> None:
        await socket.accept()
        for _ in range(500):
            await socket.receive()
            turns.append(turn)
        done.set()

    async def count() -> None:
        nonlocal turn
        while not done.is_set():
            turn += 1
            await asyncio.sleep(0)

    async with _serve(app) as url, connect(url, **SOCKET_LIMITS) as client:
        counting = asyncio.create_task(count())
        client.transport.write(_frame(b"") * 500)
        await counting
    assert len(set(turns)) == len(turns)


async def test_a_client_whose_pings_are_answered_and_who_reads_nothing_is_disconnected(
    protocols: list[WebSocketProtocol],
) -> None:
    most = 0
    app, remaining = FastAPI(), asyncio.Event()

    @app.websocket("/")
    async def listen(socket: WebSocket) -> None:
        await socket.accept()
        while (await socket.receive())["type"] != "websocket.disconnect":
            pass
        remaining.set()

    async with _serve(app) as url:
        client = await connect(url, ping_interval=None, **SOCKET_LIMITS)
        client.transport.pause_reading()
        pings = _frame(bytes(125), 9) * 1000
        while not remaining.is_set() and most < 2 * UNREAD_MAX:
            if not client.transport.get_write_buffer_size():
                client.transport.write(pings)
            await asyncio.sleep(0)
            most = max(most, protocols[0].transport.get_write_buffer_size())
        client.transport.abort()
        await remaining.wait()
    assert most < 2 * UNREAD_MAX


async def test_what_waits_for_a_client_does_not_outlive_its_socket_for_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(websocket_protocol, "FLUSH_SECONDS", 0.0)
    app, ended, lose = FastAPI(), asyncio.Event(), WebSocketProtocol.connection_lost

    def note(protocol: WebSocketProtocol, problem: Exception | None) -> None:
        lose(protocol, problem)
        ended.set()

    monkeypatch.setattr(WebSocketProtocol, "connection_lost", note)

    @app.websocket("/")
    async def send_much(socket: WebSocket) -> None:
        await socket.accept()
        await socket.send_bytes(bytes(20_000_000))

    async with _serve(app) as url:
        client = await connect(url, max_size=None, **SOCKET_LIMITS)
        client.transport.pause_reading()
        async with asyncio.timeout(SECONDS):
            await ended.wait()
        client.transport.abort()


async def test_a_message_without_an_end_is_ended() -> None:
    app, remaining = FastAPI(), asyncio.Event()
    received: list[str] = []

    @app.websocket("/")
    async def listen(socket: WebSocket) -> None:
        await socket.accept()
        while (message := await socket.receive())["type"] != "websocket.disconnect":
            received.append(message["text"])
        remaining.set()

    async with _serve(app) as url, connect(url, **SOCKET_LIMITS) as client:
        first, part, last = _part(b"a", 1), _part(b"", 0), _frame(b"b", 0)
        client.transport.write(first + part * (PARTS_MAX - 2) + last + first + part * PARTS_MAX)
        await remaining.wait()
    assert received == ["ab"]


def _part(payload: bytes, opcode: int) -> bytes:
    """Return a part of a message that is not its last."""
    return bytes([opcode]) + _frame(payload)[1:]


def _frame(payload: bytes, opcode: int = 1) -> bytes:
    """Return a short message of a client, masked by zeros (RFC 6455, 5.2)."""
    return bytes([128 + opcode, 128 + len(payload)]) + bytes(4) + payload


@asynccontextmanager
async def _serve(app: FastAPI) -> AsyncIterator[str]:
    server = make_server(app)
    with open_socket("127.0.0.1", 0) as listener:
        running = asyncio.create_task(server.serve(sockets=[listener]))
        try:
            yield f"ws://127.0.0.1:{listener.getsockname()[1]}/"
        finally:
            server.should_exit = True
            await running
