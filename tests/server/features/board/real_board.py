"""A real robot's board of which there is only the port, and a stand-in for the program that uploads to it."""

import asyncio
import sys
from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from robot_runtime.config import LinkConfig
from server.platform.settings import Settings
from server.processes.managed_process import ProcessCommand
from tests.server.blocks import state_block
from tests.server.serving import Served, serve
from tests.server.waiting import until


class UploadedRobot:
    """A real robot's settings, with an existing port and a stand-in for the upload."""

    def __init__(self, settings: Settings, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.uploads, self.started = folder / "uploads", folder / "started"
        port = folder / "port"
        port.touch()
        self.settings = replace(
            settings,
            robot=replace(settings.robot, mode="robot"),
            link=LinkConfig(port=str(port), reset="dtr"),
        )
        code = f"import pathlib, time; p = pathlib.Path({str(self.started)!r})\n"
        code += f"p.write_text(str(pathlib.Path({str(self.uploads)!r}).exists()))\ntime.sleep(600)"
        self.runtime = ProcessCommand("runtime", "robot's runtime", (sys.executable, "-c", code))
        asleep = (sys.executable, "-c", "import time; time.sleep(600)")
        self.simulator = ProcessCommand("simulator", "simulator", asleep)
        self._script = folder / "upload"
        self.upload_does("exit 0")
        monkeypatch.setattr(sys, "executable", str(self._script))

    def upload_does(self, program: str) -> None:
        self._script.write_text(f'#!/bin/sh\necho "$*" >> {self.uploads}\n{program}\n', encoding="utf-8")
        self._script.chmod(0o755)

    @property
    def marker(self) -> Path:
        return self.settings.data.firmware_away

    def serve(self) -> AbstractAsyncContextManager[Served]:
        """Return the server of the robot's settings, with its processes."""
        simulated = [] if self.settings.robot.mode == "robot" else [self.simulator]
        return serve(self.settings, [self.runtime, *simulated])


@asynccontextmanager
async def disarming(served: Served) -> AsyncIterator[None]:
    """Meanwhile the runtime reports after STOP that the robot is disarmed."""
    asked = len(served.runtime.asked)

    async def disarm() -> None:
        await until(lambda: len(served.runtime.asked) > asked, "STOP")
        now = served.container.clock.now()
        served.runtime.publish(state_block(1000 * (asked + 1), time=now, armed=False))

    task = asyncio.create_task(disarm())
    yield
    await task
