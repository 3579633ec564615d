"""Limits of connections: their number, and the time that a client may take."""

import asyncio
import errno
import logging
import resource
import socket
import struct
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import inf

import httpx
import psutil
import pytest
from fastapi import FastAPI, Request

from robot_runtime.clock import SimulatedClock
from server.http.connections import (
    ADDRESS_MAX,
    BODY_SECONDS,
    HEAD_SECONDS,
    Connections,
    HttpProtocol,
    raise_file_limit,
)
from server.http.listener import BACKLOG, open_socket
from server.http.serving import REPORT_SECONDS, OutOfFiles, WebServer, make_server
from server.platform.certificate import Certificate, prepare_certificate, trust_only
from server.platform.server_config import ServerConfig
from server.platform.settings import Settings
from tests.server.serving import next_text, serve
from tests.server.waiting import SECONDS, until
from tests.shell import shell_headers

Connection = tuple[asyncio.StreamReader, asyncio.StreamWriter]


class ConnectionSite:
    """A small server in simulated time, which reads bodies piece by piece."""

    def __init__(self, total: int) -> None:
        self.clock = SimulatedClock()
        self.limits = Connections(self.clock, total)
        self.got: list[bytes] = []
        self.left: list[str] = []
        self.port = 0
        self.writers: list[asyncio.StreamWriter] = []
        self.app = FastAPI()
        self.app.post("/upload")(self.upload)

    async def upload(self, request: Request) -> str:
        try:
            async for piece in request.stream():
                self.got.append(piece)
        except Exception as problem:
            self.left.append(type(problem).__name__)
        return "done"

    async def open(self) -> Connection:
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        self.writers.append(writer)
        return reader, writer

    async def connect(self, text: str = "") -> Connection:
        """Return a connection that the server has admitted, with the first bytes of a request."""
        before = len(self.limits)
        reader, writer = await self.open()
        await until(lambda: len(self.limits) > before, "the connection")
        writer.write(text.encode())
        return reader, writer

    def pass_time(self, seconds: float) -> None:
        self.clock.forward(seconds)
        self.limits.expire()


@asynccontextmanager
async def site(total: int = 400, certificate: Certificate | None = None) -> AsyncIterator[ConnectionSite]:
    item = ConnectionSite(total)
    server = WebServer(make_server(item.app, certificate).config, item.limits)
    with open_socket("127.0.0.1", 0) as listener:
        item.port = listener.getsockname()[1]
        running = asyncio.create_task(server.serve(sockets=[listener]))
        await until(lambda: server.started, "the server")
        try:
            yield item
        finally:
            for writer in item.writers:
                writer.close()
            server.should_exit = True
            await running


async def has_ended(connection: Connection) -> bool:
    """Return True where the server closes this connection, soon."""
    reader, _ = connection
    try:
        async with asyncio.timeout(SECONDS):
            return await reader.read() == b""
    except ConnectionResetError:
        return True


HALF_BODY = "POST /upload HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\n{"
LONG_BODY = HALF_BODY.replace("9", "54001")


async def test_a_head_has_ten_seconds_also_where_it_comes_byte_by_byte() -> None:
    async with site() as server:
        silent, slow = await server.connect(), await server.connect("GET / HT")
        for letter in "TP/":
            server.pass_time(HEAD_SECONDS / 4)
            slow[1].write(letter.encode())
            await slow[1].drain()
        assert len(server.limits) == 2
        server.pass_time(HEAD_SECONDS / 4)
        assert len(server.limits) == 0
        assert await has_ended(silent)
        assert await has_ended(slow)


async def test_the_head_of_a_further_request_has_ten_seconds_too_and_an_idle_connection_more() -> None:
    async with site() as server:
        request = "GET / HTTP/1.1\r\nHost: x\r\n\r\n"
        idle, slow = await server.connect(request), await server.connect(request)
        for reader, _ in (idle, slow):
            assert b"Not Found" in await reader.readuntil(b"}")
        slow[1].write(b"GET")
        later = server.clock.now() + HEAD_SECONDS
        await until(lambda: any(result.overdue(later) for result in server.limits), "the first bytes")
        server.pass_time(HEAD_SECONDS)
        assert await has_ended(slow)
        idle[1].write(request.encode())
        assert b"Not Found" in await idle[0].readuntil(b"}")


async def test_a_body_may_last_as_long_as_it_progresses() -> None:
    async with site() as server:
        upload, hanging = await server.connect(LONG_BODY), await server.connect(HALF_BODY)
        await until(lambda: server.got == [b"{"] * 2, "both bodies")
        pieces = 18_000
        for number in range(3):
            server.pass_time(BODY_SECONDS * 0.6)
            upload[1].write(b"x" * pieces)
            size = (number + 1) * pieces + 2
            await until(lambda: len(b"".join(server.got)) == size, "a further piece")  # noqa: B023
        assert await has_ended(hanging)
        await until(lambda: server.left == ["ClientDisconnect"], "the end of the hanging body")
        assert b"done" in await upload[0].readuntil(b'done"')


async def test_a_body_that_drips_is_ended() -> None:
    async with site() as server:
        dripping = await server.connect(HALF_BODY)
        await until(lambda: server.got == [b"{"], "the body")
        server.pass_time(BODY_SECONDS - 1)
        dripping[1].write(b"x")
        await until(lambda: len(server.got) == 2, "a further byte")
        assert len(server.limits) == 1
        server.pass_time(1.01)
        assert len(server.limits) == 0
        assert await has_ended(dripping)


async def test_connections_are_counted_from_accept_on_also_with_tls(settings: Settings) -> None:
    certificate = prepare_certificate(settings.with_section(ServerConfig(tls=True)))

    async with site(certificate=certificate) as server:
        silent = [await server.connect() for _ in range(ADDRESS_MAX)]
        assert len(server.limits) == ADDRESS_MAX
        server.clock.forward(HEAD_SECONDS / 2)
        tls = trust_only(settings.data)
        address = f"https://127.0.0.1:{server.port}/upload"
        async with httpx.AsyncClient(verify=tls, timeout=SECONDS) as client:
            assert (await client.post(address, content=b"x")).text == '"done"'
            assert await has_ended(silent[0])
            server.pass_time(HEAD_SECONDS / 2)
            assert len(server.limits) == 1
            assert await has_ended(silent[1])
            assert (await client.post(address, content=b"x")).text == '"done"'


async def test_a_head_has_ten_seconds_from_the_end_of_the_tls_handshake(settings: Settings) -> None:
    certificate = prepare_certificate(settings.with_section(ServerConfig(tls=True)))

    async with site(certificate=certificate) as server:
        reader, writer = await server.connect()
        server.pass_time(0.9 * HEAD_SECONDS)
        await writer.start_tls(trust_only(settings.data), server_hostname="127.0.0.1")
        await until(
            lambda: any(isinstance(result, HttpProtocol) for result in server.limits), "the handshake"
        )
        server.pass_time(0.9 * HEAD_SECONDS)
        writer.write(HALF_BODY.encode() + b"}" * 8)
        async with asyncio.timeout(SECONDS):
            assert b" 200 " in await reader.readline()
        writer.close()


async def test_a_connection_that_waits_for_its_client_makes_room() -> None:
    async with site(total=3) as server:
        first = await server.connect(HALF_BODY)
        await until(lambda: server.got, "the body")
        server.clock.forward(1)
        for _ in range(2):
            await server.connect()
        await server.open()
        assert await has_ended(first)
        assert len(server.limits) == 3


async def test_an_address_has_so_many_connections_however_many_the_server_could_have() -> None:
    async with site() as server:
        first = await server.connect()
        server.clock.forward(1)
        for _ in range(ADDRESS_MAX - 1):
            await server.connect()
        await server.open()
        assert await has_ended(first)
        assert len(server.limits) == ADDRESS_MAX


async def test_requests_that_are_worked_on_are_not_ended_for_others() -> None:
    async with site(total=2) as server:
        release = asyncio.Event()

        async def work() -> str:
            server.got.append(b"working")
            await release.wait()
            return "done"

        server.app.get("/work")(work)
        request = "GET /work HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
        busy = [await server.connect(request) for _ in range(2)]
        await until(lambda: len(server.got) == 2, "both requests")
        assert await has_ended(await server.open())
        release.set()
        for reader, _ in busy:
            assert b"done" in await reader.read()


def count_files() -> float:
    """Open files of this process; without end where even counting them needs one that is not there."""
    try:
        return psutil.Process().num_fds()
    except OSError:
        return inf


async def test_stop_and_an_open_page_are_served_while_300_silent_connections_hang(settings: Settings) -> None:
    attack = """if True:
        import socket, sys
        sys.stdin.readline()
        held = [socket.create_connection(("127.0.0.1", int(sys.argv[1]))) for _ in range(300)]
        print("there", flush=True)
        sys.stdin.readline()
    """

    async with serve(settings) as served:
        stop = f"{served.api.base_url}robot/stop"
        # Read first: this process is the server's, and may soon open no more files.
        headers = shell_headers(settings.data)
        # Started first: a process inherits the limit.
        attacker = subprocess.Popen(
            [sys.executable, "-c", attack, str(served.settings.server.port)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        limit = resource.getrlimit(resource.RLIMIT_NOFILE)
        try:
            async with served.connect() as page:
                await next_text(page, "hello")
                few = psutil.Process().num_fds() + ADDRESS_MAX + BACKLOG + 20
                resource.setrlimit(resource.RLIMIT_NOFILE, (few, limit[1]))
                assert attacker.stdin is not None
                assert attacker.stdout is not None
                attacker.stdin.write(b"go\n")
                attacker.stdin.flush()
                assert await asyncio.to_thread(attacker.stdout.readline) == b"there\n"
                # The server accepts as many at once as wait; those that it refuses are closed a moment later.
                free = few - 20
                await until(lambda: count_files() < free, "refused connections to be closed")
                async with httpx.AsyncClient(headers=headers, timeout=SECONDS) as fresh:
                    assert (await fresh.post(stop)).status_code == 204
                await page.send('{"op": "ping", "id": 1}')
                assert (await next_text(page, "pong"))["id"] == 1
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, limit)
            attacker.communicate(b"end\n")


def test_missing_file_handles_are_reported_once_a_minute(caplog: pytest.LogCaptureFixture) -> None:
    clock = SimulatedClock()
    report = OutOfFiles(Connections(clock)).report
    loop = asyncio.new_event_loop()
    try:
        for _ in range(1000):
            report(loop, {"message": "accept", "exception": OSError(errno.EMFILE, "Too many open files")})
        assert [record.levelno for record in caplog.records] == [logging.ERROR]
        assert "Too many open files" in caplog.text
        clock.forward(REPORT_SECONDS)
        report(loop, {"message": "accept", "exception": OSError(errno.EMFILE, "Too many open files")})
        report(loop, {"message": "something else"})
        assert [record.name for record in caplog.records] == [*["server.http.serving"] * 2, "asyncio"]
    finally:
        loop.close()


async def test_the_backlog_is_the_servers_own() -> None:
    server = make_server(FastAPI())
    with open_socket("127.0.0.1", 0) as listener:
        running = asyncio.create_task(server.serve(sockets=[listener]))
        await until(lambda: server.started, "the server")
        described = listener.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, 32)
        # Of a listening socket, `tcpi_sacked` is the greatest backlog.
        assert struct.unpack_from("I", described, 28) == (BACKLOG,)
        server.should_exit = True
        await running


def test_the_limit_of_open_files_is_raised() -> None:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (512, before[1]))
        assert raise_file_limit() == resource.getrlimit(resource.RLIMIT_NOFILE)[0] > 512
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
