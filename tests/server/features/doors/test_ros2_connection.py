"""A ROS 2 program's connection: its end where its task is cancelled meanwhile, and its limit of bytes."""

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest.mock import MagicMock

import pytest

from robot_runtime.clock import SimulatedClock
from server.features.doors.ros2_connection import Ros2Connection, _open_node
from server.features.doors.ros2_node import Ros2Node
from server.features.doors.subscriptions import DoorClient
from server.http.sign_in.identity import Identity
from server.stream.budget import STREAM_BURST, STREAM_PER_SECOND, Budgets


async def test_the_session_is_closed_also_where_all_threads_are_busy_and_its_task_is_cancelled(
    tmp_path: Path,
) -> None:
    node, path = MagicMock(spec=Ros2Node), tmp_path / "ros2-1.sock"
    path.touch()
    free = threading.Event()

    asyncio.get_running_loop().set_default_executor(ThreadPoolExecutor(1))
    opened, leave = asyncio.Event(), asyncio.Event()

    async def visit() -> None:
        async with _open_node(lambda _: (node, path), MagicMock()):
            opened.set()
            await leave.wait()

    visiting = asyncio.create_task(visit())
    await opened.wait()
    busy = asyncio.create_task(asyncio.to_thread(free.wait))
    await asyncio.sleep(0)
    leave.set()
    for _ in range(2):
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        visiting.cancel()
    assert not node.close.called
    free.set()
    await busy
    with pytest.raises(asyncio.CancelledError):
        await visiting
    node.close.assert_called_once()
    assert not path.exists()


async def test_what_a_viewer_sends_over_one_connection_is_missing_to_the_others(tmp_path: Path) -> None:
    path, clock = tmp_path / "ros2-1.sock", SimulatedClock()
    viewer = Identity(7, "Viewer", "viewer", "program")
    budget = Budgets(clock).of(viewer)

    async def take(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.read()
        writer.close()

    async with await asyncio.start_unix_server(take, path):
        sent = asyncio.StreamReader()
        sent.feed_data(bytes(int(STREAM_BURST)))
        sent.feed_eof()
        visit = Ros2Connection(MagicMock(), MagicMock(), MagicMock(), sent, MagicMock())
        client = DoorClient(1, viewer, "", visit.send, clock, budget)
        await visit.listen(client, lambda _: (MagicMock(spec=Ros2Node), path))
    assert budget.open_stream().spend(STREAM_PER_SECOND) == pytest.approx(1.0)
