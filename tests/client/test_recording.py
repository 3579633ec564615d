"""A program records, marks and reads back, by a server whose runtime the test is."""

import asyncio
from collections.abc import AsyncIterator

import cv2
import numpy as np
import pytest

from mucat import Robot, RobotError, Sessions
from mucat.pictures import decode_picture
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import DEPTH
from server.platform.settings import Settings
from tests.server.blocks import state_block
from tests.server.conftest import settings as settings
from tests.server.features.doors.rig import make_token, rows_block
from tests.server.serving import Served, serve
from tests.server.waiting import until


@pytest.fixture
async def served(settings: Settings) -> AsyncIterator[Served]:
    """A server whose runtime has said its state."""
    async with serve(settings) as served:
        await served.heard("stream")
        served.runtime.publish(state_block(0))
        yield served


async def test_what_was_recorded_and_marked_is_read_back(served: Served) -> None:
    url, token = f"http://127.0.0.1:{served.settings.server.port}", await make_token(served)
    robot, sessions = Robot(url, token), Sessions(url, token)
    now = served.container.clock.now

    def record() -> int:
        with robot.record("Lagoon", "with a *program*") as recording:
            for number in range(20):
                depth = Depth(time=number, depth=0.1 * number, pressure=101_325, temperature=20.0)
                served.runtime.publish(rows_block("depth", number, (now(), depth)))
            recording.mark("Half of it")
        return recording.session

    session = await asyncio.to_thread(record)
    (listed,) = await asyncio.to_thread(sessions.list)
    assert (listed["id"], listed["name"], listed["state"]) == (session, "Lagoon", "complete")
    await asyncio.to_thread(sessions.mark, session, 0.0, "The start")
    marks = await asyncio.to_thread(sessions.marks, session)
    assert [mark["text"] for mark in marks] == ["The start", "Half of it"]
    events = await asyncio.to_thread(sessions.events, session)
    assert all({"time", "kind", "severity", "text"} <= event.keys() for event in events)
    tables = await asyncio.to_thread(sessions.load, session)
    assert max(tables.columns(DEPTH.name)["depth"]) == pytest.approx(1.9)
    with pytest.raises(RobotError, match="no picture"):
        await asyncio.to_thread(sessions.picture, session, 0.0)
    with pytest.raises(RobotError, match="no snapshot"):
        await asyncio.to_thread(sessions.snapshot, session, 0.0)


async def test_the_recording_stops_also_where_the_block_fails(served: Served) -> None:
    url, token = f"http://127.0.0.1:{served.settings.server.port}", await make_token(served)

    def record() -> None:
        with Robot(url, token).record("Lagoon"):
            raise LookupError("the program's own")

    with pytest.raises(LookupError):
        await asyncio.to_thread(record)
    (listed,) = await asyncio.to_thread(Sessions(url, token).list)
    assert listed["state"] == "complete"


async def test_the_topics_are_those_of_this_version(served: Served) -> None:
    url, token = f"http://127.0.0.1:{served.settings.server.port}", await make_token(served)

    def first() -> dict[str, object]:
        samples = Robot(url, token).live("depth")
        sample = next(samples)
        samples.close()
        return dict(sample.fields)

    depth = Depth(time=5, depth=1.25, pressure=113_000, temperature=18.5)
    reading = asyncio.create_task(asyncio.to_thread(first))
    number = 0

    def publish() -> bool:
        nonlocal number
        served.runtime.publish(rows_block("depth", number, (served.container.clock.now(), depth)))
        number += 1
        return reading.done()

    await until(publish, "a sample")
    assert await reading == {name: getattr(depth, name) for name in Depth.wires}


def test_a_picture_becomes_an_array() -> None:
    red = np.zeros((4, 6, 3), np.uint8)
    red[..., 2] = 255
    array = decode_picture(cv2.imencode(".jpg", red)[1].tobytes())
    assert array.shape == (4, 6, 3)
    assert array[0, 0, 0] > 240 > array[0, 0, 2]
    with pytest.raises(RobotError, match="is no picture"):
        decode_picture(b"no picture")
