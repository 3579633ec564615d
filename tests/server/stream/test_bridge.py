import asyncio
import time
from collections.abc import Mapping

import pytest

from robot_runtime.errors import NoAnswerError
from robot_runtime.transport.replay_cache import BacklogReply
from server.platform.settings import Settings
from server.stream.bridge import BACKLOG_SECONDS, Bridge

ANSWER = BacklogReply("0123456789abcdef", {}, [])


class Process:
    """A process that drops the first requests, and takes `needs` s to answer one."""

    def __init__(self, lost: int = 0, needs: float = 0.0) -> None:
        self.asked: list[float] = []
        self._lost = lost
        self._needs = needs

    def answer(self, _question: str, _first_numbers: Mapping[str, int], seconds: float) -> BacklogReply:
        self.asked.append(seconds)
        if len(self.asked) <= self._lost or self._needs > seconds:
            time.sleep(seconds)
            raise NoAnswerError("no answer")
        time.sleep(self._needs)
        return ANSWER


def fetch(settings: Settings, monkeypatch: pytest.MonkeyPatch, process: Process) -> BacklogReply | None:
    async def scenario() -> BacklogReply | None:
        bridge = Bridge(settings, lambda _: None)
        bridge._loop = asyncio.get_running_loop()
        monkeypatch.setattr(bridge, "_fetch", process.answer)
        return await bridge._fetch_backlog("runtime", {})

    return asyncio.run(scenario())


def test_a_lost_request_is_repeated_soon(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    process, began = Process(lost=1), time.monotonic()
    assert fetch(settings, monkeypatch, process) is ANSWER
    assert time.monotonic() - began < 1.5
    assert process.asked[0] < 0.5


def test_a_slow_process_gets_the_whole_timeout(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    process = Process(needs=2.0)
    assert fetch(settings, monkeypatch, process) is ANSWER
    assert process.asked[-1] == BACKLOG_SECONDS
