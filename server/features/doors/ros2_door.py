"""The door for ROS 2: programs and routers that speak rmw_zenoh, each behind a certificate of this robot.

    program or router of ROS 2  --TLS-->  this door  --Unix socket-->  a Zenoh session of its own

The door ends the TLS itself, and each connection gets its own Zenoh session. So every message has a known
sender, access ends at once where it is revoked, and nothing leads from there into the robot's own Zenoh.
"""

import asyncio
import logging
import socket
import ssl
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

from server.driving.arbiter import ControlArbiter
from server.features.doors.commands import DoorCommands, DoorPilot
from server.features.doors.config import DoorsConfig
from server.features.doors.house import Doors
from server.features.doors.ros2_certificates import check_ros2
from server.features.doors.ros2_connection import CHUNK_BYTES, Ros2Connection
from server.features.doors.ros2_names import Endpoint, Ros2Names
from server.features.doors.ros2_node import Ros2Node
from server.features.doors.ros2_session import Ros2Session, ros2_endpoints
from server.http.audit import AuditLog
from server.http.listener import open_socket
from server.http.sign_in.access import Access
from server.http.sign_in.devices import SignInEndedError
from server.http.sign_in.identity import Identity
from server.platform.settings import Settings
from server.stream.hub import EvictedError
from server.stream.socket_ends import end_after

log = logging.getLogger(__name__)

HANDSHAKE_SECONDS = 5.0
STRANGERS_MAX = 10
"""Connections whose handshake goes on."""
ACCEPT_PAUSE = 1.0


class Ros2Door:
    """The listener of ROS 2 programs while the server runs, where `doors.ros2` is set."""

    def __init__(
        self,
        settings: Settings,
        access: Access,
        arbiter: ControlArbiter,
        audit: AuditLog,
        doors: Doors,
        commands: DoorCommands,
    ) -> None:
        self.address = ("", 0)
        """Where it listens."""
        self._settings = settings
        self._access = access
        self._arbiter = arbiter
        self._audit = audit
        self._doors = doors
        self._door = doors.doors["ros2"]
        self._commands = commands
        self._config = settings.section(DoorsConfig)
        self._names = Ros2Names(self._config.ros2_domain, self._config.ros2_namespace)
        self._endpoints: list[Endpoint] = []
        self._tasks: set[asyncio.Task[None]] = set()

    async def open(self) -> None:
        """Listen, if the door is open. Raise SetupError."""
        if not self._door.open:
            return
        context = check_ros2(self._settings)
        channels = self._door.publisher.channels.values()
        self._endpoints = await asyncio.to_thread(ros2_endpoints, channels)
        listener = open_socket(*self._config.ros2_address)
        listener.setblocking(False)
        self.address = listener.getsockname()[:2]
        self._begin(self._accept(listener, context))

    async def close(self) -> None:
        """End all connections."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _accept(self, listener: socket.socket, context: ssl.SSLContext) -> None:
        loop = asyncio.get_running_loop()
        with listener:
            while True:
                try:
                    connection, address = await loop.sock_accept(listener)
                except OSError:  # too many open files: wait for others to end
                    await asyncio.sleep(ACCEPT_PAUSE)
                    continue
                if self._door.strangers >= STRANGERS_MAX:
                    connection.close()
                else:
                    self._door.strangers += 1
                    self._begin(self._serve(connection, str(address[0]), context))
                # `sock_accept` itself lets nobody else work while connections wait.
                await asyncio.sleep(0)

    async def _serve(self, connection: socket.socket, address: str, context: ssl.SSLContext) -> None:
        """Serve a connection, counted as a stranger's."""
        try:
            reader, writer = await _shake_hands(connection, context)
        except (OSError, TimeoutError):  # without a certificate of this robot
            self._audit.record(None, address, "Open a door", "/ros2", "refused")
            return
        finally:
            self._door.strangers -= 1
        try:
            await self._admit(reader, writer, address)
        except (EvictedError, OSError) as problem:
            log.info("ROS 2 at %s: %s", address, problem)
        finally:
            writer.transport.abort()

    async def _admit(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, address: str) -> None:
        caller = self._identify(_common_name(writer))
        if caller is None:
            self._audit.record(None, address, "Open a door", "/ros2", "refused")
            return
        self._audit.record(caller, address, "Open a door", "/ros2", "done")
        with self._arbiter.page(caller) as owner:
            pilot = DoorPilot(owner, address)
            visit = Ros2Connection(self._doors, self._commands, pilot, reader, writer)
            serving = self._doors.serve(
                self._door, visit.send, caller, address, lambda client: visit.listen(client, self._make_node)
            )
            await end_after(self._access.devices.count_seconds(caller.device), serving)

    def _identify(self, common_name: str) -> Identity | None:
        try:
            return self._access.identify_certificate(common_name)
        except SignInEndedError:
            return None

    def _make_node(self, session: Ros2Session) -> tuple[Ros2Node, Path]:
        path = self._settings.data.run / f"ros2-{session.client.number % 1000}.sock"
        return Ros2Node(path, self._names, self._endpoints, session.receive, session.match), path


async def _shake_hands(
    connection: socket.socket, context: ssl.SSLContext
) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(CHUNK_BYTES)
    protocol = asyncio.StreamReaderProtocol(reader)
    try:
        transport, _ = await loop.connect_accepted_socket(
            lambda: protocol, connection, ssl=context, ssl_handshake_timeout=HANDSHAKE_SECONDS
        )
    except BaseException:
        connection.close()
        raise
    return reader, asyncio.StreamWriter(transport, protocol, reader, loop)


def _common_name(writer: asyncio.StreamWriter) -> str:
    subject = (writer.get_extra_info("peercert") or {}).get("subject", ())
    names = [value for part in subject for key, value in part if key == "commonName"]
    return str(names[0]) if len(names) == 1 else ""
