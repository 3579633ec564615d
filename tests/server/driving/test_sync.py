import asyncio

import pytest

import server.driving.sync as sync_module
from robot_runtime.errors import RefusedError
from server.driving.sync import LeaseSync
from server.stream.bridge import RuntimeSilentError
from tests.server.waiting import until


async def test_each_epoch_is_sent_to_each_run_of_the_runtime_until_it_answers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sync_module, "TRY_AGAIN_SECONDS", 0.001)
    asked: list[int] = []
    problems: list[Exception] = [
        RuntimeSilentError("not there", False),
        RuntimeSilentError("not there", True),
    ]

    async def ask(epoch: int) -> None:
        asked.append(epoch)
        if problems:
            raise problems.pop()

    sync = LeaseSync(ask)
    task = asyncio.create_task(sync.run())
    sync.see_epoch(5)
    await until(lambda: asked == [5, 5, 5], "an answer")
    sync.see_epoch(5)
    sync.see_run("a")
    await until(lambda: asked == [5, 5, 5, 5], "the new run to be told")
    problems.append(RefusedError("That epoch is over."))
    sync.see_epoch(6)
    await until(lambda: asked[4:] == [6], "the change")
    sync.see_run("a")
    sync.see_epoch(7)
    await until(lambda: asked[4:] == [6, 7], "the next change")
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
