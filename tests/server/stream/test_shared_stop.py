"""STOPs of many that share their way to the robot."""

import asyncio
from collections.abc import Mapping
from typing import Any

import pytest

from robot_runtime.errors import NoAnswerError
from server.stream.shared_stop import AT_ONCE, SharedStop
from tests.server.waiting import until


class StopCounter:
    """Answers a STOP once it may; counts those that have begun."""

    def __init__(self) -> None:
        self.begun = 0
        self.may_answer = asyncio.Event()

    async def stop(self) -> Mapping[str, Any]:
        """Begin a STOP; its answer is its number."""
        self.begun += 1
        number = self.begun
        await self.may_answer.wait()
        return {"number": number}


async def test_a_hundred_that_wait_are_one_stop() -> None:
    robot = StopCounter()
    shared = SharedStop(robot.stop)
    first = []
    for number in range(1, AT_ONCE + 1):
        first.append(asyncio.create_task(shared.ask()))
        await until(lambda begun=number: robot.begun == begun, "the first ones to begin")  # type: ignore[misc]
    others = [asyncio.create_task(shared.ask()) for _ in range(100)]
    await asyncio.sleep(0)
    robot.may_answer.set()
    answers = await asyncio.gather(*first, *others)
    assert robot.begun == AT_ONCE + 1
    assert {answer["number"] for answer in answers[AT_ONCE:]} == {AT_ONCE + 1}


async def test_one_who_asks_gets_a_stop_that_begins_afterwards() -> None:
    robot = StopCounter()
    shared = SharedStop(robot.stop)
    earlier = asyncio.create_task(shared.ask())
    await until(lambda: robot.begun == 1, "the first one to begin")
    later = asyncio.create_task(shared.ask())
    robot.may_answer.set()
    assert (await earlier)["number"] == 1
    assert (await later)["number"] == 2


async def test_an_unanswered_stop_lets_the_next_one_go_at_once() -> None:
    robot = StopCounter()
    shared = SharedStop(robot.stop)
    waiting = [asyncio.create_task(shared.ask())]
    await until(lambda: robot.begun == 1, "the first one to begin")
    waiting.append(asyncio.create_task(shared.ask()))
    await until(lambda: robot.begun == 2, "the second one to begin")
    robot.may_answer.set()
    await asyncio.gather(*waiting)


async def test_all_who_share_one_hear_of_its_failure_and_the_next_works_again() -> None:
    failing = True

    async def stop() -> Mapping[str, Any]:
        if failing:
            raise NoAnswerError("nobody answers")
        return {}

    shared = SharedStop(stop)
    outcomes = await asyncio.gather(*(shared.ask() for _ in range(3)), return_exceptions=True)
    assert [type(outcome) for outcome in outcomes] == [NoAnswerError] * 3
    failing = False
    assert await shared.ask() == {}


async def test_a_stop_goes_on_where_the_one_who_asked_leaves() -> None:
    robot = StopCounter()
    shared = SharedStop(robot.stop)
    asked = asyncio.create_task(shared.ask())
    await asyncio.sleep(0)
    asked.cancel()
    with pytest.raises(asyncio.CancelledError):
        await asked
    await until(lambda: robot.begun == 1, "STOP to begin")
