"""The session that all doors share."""

import asyncio

from robot_runtime.clock import SteadyClock
from server.features.doors.session import DoorSession
from server.features.doors.subscriptions import DoorClient
from server.http.sign_in.identity import SHELL
from server.stream.budget import Budgets
from server.stream.hub import Send
from tests.server.waiting import until


def make_session(send: Send) -> DoorSession:
    """Return the session of a program of the shell."""
    clock = SteadyClock()
    return DoorSession(DoorClient(1, SHELL, "", send, clock, Budgets(clock).of(SHELL)))


async def send_nothing(_: str | bytes) -> None:
    raise AssertionError("nothing is sent")


async def test_while_two_stops_wait_no_further_message_is_read() -> None:
    session, answered = make_session(send_nothing), asyncio.Event()
    read: list[int] = []

    async def receive() -> int | None:
        read.append(len(read))
        return read[-1] if len(read) <= 1000 else None

    listening = asyncio.create_task(
        session.listen(receive, lambda _: session.begin(wait_for(answered), always=True), lambda _: None)
    )
    await until(lambda: len(read) >= 2, "two STOPs to be read")
    for _ in range(100):
        await asyncio.sleep(0)
    assert len(read) == 2
    answered.set()
    await listening
    assert len(read) == 1001


async def wait_for(event: asyncio.Event) -> None:
    await event.wait()


async def test_stop_is_begun_although_its_program_leaves_in_the_same_moment() -> None:
    session = make_session(send_nothing)
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
