"""Turns of requests that cost much."""

import asyncio
from dataclasses import replace
from typing import get_args

import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from starlette.types import Message

from server.app import create_app
from server.http.heavy_requests import (
    WAITING_MAX,
    HeavyRequests,
    ReadingTurn,
    RecordingTurn,
    TooManyHeavyError,
    Turn,
)
from server.http.sign_in.identity import IDENTITY, SHELL
from server.platform.settings import Settings
from tests.server.waiting import SECONDS


async def test_a_device_has_one_heavy_request_at_a_time_and_few_that_wait() -> None:
    heavy = HeavyRequests()
    begun: list[tuple[int, int]] = []
    gates = [asyncio.Event() for _ in range(WAITING_MAX + 1)]

    async def ask(device: int, number: int) -> None:
        async with heavy.turn(device):
            begun.append((device, number))
            await gates[number].wait()

    tasks = [asyncio.create_task(ask(1, number)) for number in range(WAITING_MAX + 1)]
    await asyncio.sleep(0)
    assert begun == [(1, 0)]
    with pytest.raises(TooManyHeavyError, match="Wait for their answers"):
        async with asyncio.timeout(SECONDS):
            await ask(1, 0)
    other = asyncio.create_task(ask(2, 0))
    await asyncio.sleep(0)
    assert begun == [(1, 0), (2, 0)]
    for gate in gates:
        gate.set()
    await asyncio.gather(other, *tasks)
    assert [number for device, number in begun if device == 1] == list(range(WAITING_MAX + 1))
    await ask(1, 0)


def test_reports_checks_replays_and_comparisons_take_turns(settings: Settings) -> None:
    turns = {get_args(annotation)[1].dependency for annotation in (Turn, ReadingTurn, RecordingTurn)}
    routes = iter_route_contexts([*create_app(replace(settings, every_feature=True)).routes])
    heavy = {
        str(getattr(route, "operation_id", ""))
        for route in routes
        if (dependant := getattr(route, "dependant", None)) is not None
        and any(dependency.call in turns for dependency in dependant.dependencies)
    }
    assert heavy == {
        *("getComparisonReport", "compareSessions", "compareLines", "getBlocks"),
        *("getStory", "getStoryFigures", "getTrack", "getReadings", "getSpectrum", "getPair"),
        *("checkScenario", "checkMission", "readVision", "examineAgain"),
        *("getSession", "getTimeline", "getThumbnail", "listSessionMissions", "listMissionRuns"),
        *("listSessionSnapshots", "getSnapshot"),
        *("getFilm", "getFilmPart"),
        *("checkSweep", "startSweep", "getSweep", "listSweepRuns", "downloadSweepTable"),
        "predictStep",
        "getFigureStudy",
    }


async def test_a_reading_whose_caller_has_gone_is_left_out() -> None:
    read: list[str] = []
    app = FastAPI()
    app.state.services = {HeavyRequests: HeavyRequests()}

    @app.get("/read")
    def read_something(_: ReadingTurn, name: str) -> None:
        read.append(name)

    async def ask(name: str, *, gone: bool) -> None:
        async def receive() -> Message:
            if not gone:
                await asyncio.sleep(SECONDS)
            return {"type": "http.disconnect"}

        async def send(_message: Message) -> None:
            return

        scope = {"type": "http", "method": "GET", "path": "/read", "headers": [], IDENTITY: SHELL}
        await app(scope | {"query_string": f"name={name}".encode()}, receive, send)

    await ask("wanted", gone=False)
    with pytest.raises(TooManyHeavyError, match="given up"):
        await ask("gone", gone=True)
    assert read == ["wanted"]
