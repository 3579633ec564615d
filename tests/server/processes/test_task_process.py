"""Processes that answer the server's tasks."""

import asyncio
import os

from server.processes.task_process import TaskProcess


def test_ctrl_c_in_the_server_s_terminal_does_not_reach_them() -> None:
    async def group() -> int:
        process = await TaskProcess.start("server.features.comparison", "nowhere.db")
        try:
            return os.getpgid(process.pid)
        finally:
            await process.end()

    # A terminal tells the whole group, and each process of it that does not expect it prints a traceback.
    assert asyncio.run(group()) != os.getpgid(0)
