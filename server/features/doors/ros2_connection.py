"""One connection of a program of ROS 2: its bytes to and from a Zenoh session of its own."""

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

from server.features.doors.commands import DoorCommands, DoorPilot
from server.features.doors.house import Doors
from server.features.doors.ros2_node import Ros2Node
from server.features.doors.ros2_session import Ros2Session
from server.features.doors.subscriptions import DoorClient
from server.stream.budget import Allowance

CHUNK_BYTES = 65_536

MakeNode = Callable[[Ros2Session], tuple[Ros2Node, Path]]
"""Makes the robot's node for a session, and the path of the socket that leads to it. Raises OSError."""


class Ros2Connection:
    """The connection of an admitted program, from its Zenoh session's beginning to its end."""

    def __init__(
        self,
        doors: Doors,
        commands: DoorCommands,
        pilot: DoorPilot,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        self._doors = doors
        self._commands = commands
        self._pilot = pilot
        self._reader = reader
        self._writer = writer
        self._publish: Callable[[bytes], None] = lambda _: None

    async def send(self, data: bytes | str) -> None:
        """Publish a message, as soon as the program has read enough of the earlier ones."""
        assert isinstance(data, bytes)
        await self._writer.drain()
        self._publish(data)
        await asyncio.sleep(0)  # lets the bytes pass on

    async def listen(self, client: DoorClient, make_node: MakeNode) -> None:
        """Serve the program until it leaves. Raise OSError."""
        client.owner = self._pilot.owner.number
        session = Ros2Session(client, self._pilot, self._doors, self._commands, self._writer.drain)
        async with _open_node(make_node, session) as (node, path):
            self._publish = lambda data: node.publish(*session.unpack(data))
            reader, writer = await asyncio.open_unix_connection(path)
            pump_in = _pump_in(self._reader, writer, client.budget.open_stream())
            parts = (pump_in, _pump(reader, self._writer), session.run(node))
            work = [asyncio.create_task(part) for part in parts]
            try:
                await asyncio.wait(work, return_when=asyncio.FIRST_COMPLETED)
            finally:
                self._publish = lambda _: None
                for task in work:
                    task.cancel()
                await asyncio.gather(*work, return_exceptions=True)
                writer.close()


@asynccontextmanager
async def _open_node(make: MakeNode, session: Ros2Session) -> AsyncIterator[tuple[Ros2Node, Path]]:
    # A thread cannot be cancelled: what it opens is closed.
    opening = asyncio.ensure_future(asyncio.to_thread(make, session))
    try:
        yield await asyncio.shield(opening)
    finally:
        await _complete(_close(opening))


async def _close(opening: asyncio.Future[tuple[Ros2Node, Path]]) -> None:
    node, path = await opening
    await asyncio.to_thread(node.close)
    for file in (path, path.with_name(f"{path.name}.lock")):
        file.unlink(missing_ok=True)


async def _complete(work: Coroutine[Any, Any, None]) -> None:
    """Await all of the work, also where this task is cancelled meanwhile.

    A call that waits for a thread would be dropped with its task, and the session's threads would stay.
    """
    task = asyncio.create_task(work)
    cancelled = False
    while not task.done():
        try:
            await asyncio.shield(task)
        except asyncio.CancelledError:
            cancelled = True
    task.result()
    if cancelled:
        raise asyncio.CancelledError


async def _pump(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Pass on bytes until the end, at the reader's speed."""
    with suppress(OSError):
        while data := await reader.read(CHUNK_BYTES):
            writer.write(data)
            await writer.drain()


async def _pump_in(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, allowance: Allowance) -> None:
    """Pass on a program's bytes until the end, with a limit of bytes per second."""
    with suppress(OSError):
        while data := await reader.read(CHUNK_BYTES):
            writer.write(data)
            await writer.drain()
            await asyncio.sleep(allowance.spend(len(data)))
