"""The end of a ROS 2 program's connection, where its task is cancelled meanwhile."""

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest.mock import MagicMock

import pytest

from server.features.doors.ros2_connection import _open_node
from server.features.doors.ros2_node import Ros2Node


def test_the_session_is_closed_also_where_all_threads_are_busy_and_its_task_is_cancelled(
    tmp_path: Path,
) -> None:
    node, path = MagicMock(spec=Ros2Node), tmp_path / "ros2-1.sock"
    path.touch()
    free = threading.Event()

    async def run() -> None:
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

    asyncio.run(run())
    node.close.assert_called_once()
    assert not path.exists()
