"""The session that all doors share."""

import asyncio

from robot_runtime.clock import SteadyClock
from server.features.doors.session import DoorSession
from server.features.doors.subscriptions import DoorClient
from server.http.sign_in.identity import SHELL
from tests.server.waiting import until


def test_stop_is_begun_although_its_program_leaves_in_the_same_moment() -> None:
    async def scenario() -> None:
        async def send(_: str | bytes) -> None:
            raise AssertionError("nothing is sent")

        session = DoorSession(DoorClient(1, SHELL, "", send, SteadyClock()))
        begun: list[str] = []
        messages = iter(["arm", "stop", None])

        async def receive() -> str | None:
            return next(messages)

        async def call(name: str) -> None:
            begun.append(name)

        await session.listen(
            receive, lambda name: session.begin(call(name), always=name == "stop"), lambda _: None
        )
        await until(lambda: begun == ["stop"], "STOP to be begun")

    asyncio.run(scenario())
