"""Admission of requests that may cost seconds of processor time: one at a time for each device."""

import asyncio
from collections import Counter, defaultdict
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager
from typing import Annotated, Any, TypeVar

from fastapi import Depends, Request

from server.http.dependencies import Provided
from server.http.sign_in.identity import Caller
from server.platform.errors import ApiError

T = TypeVar("T")

WAITING_MAX = 3
"""A page may ask again before its last request was answered, as when somebody types."""
READING_MAX = 100
"""As many as connections of one address: whoever moves through a recording asks faster than is answered."""


class TooManyHeavyError(ApiError):
    """This device has several such requests under way already"""

    status = 429


class HeavyRequests:
    """The turns of all devices."""

    def __init__(self) -> None:
        self._turns: defaultdict[int, asyncio.Lock] = defaultdict(asyncio.Lock)
        self._asked: Counter[int] = Counter()
        self.recordings = asyncio.Lock()
        """Held by the request that reads a recording in this process: what each takes would add up."""

    @asynccontextmanager
    async def turn(self, device: int, waiting_max: int = WAITING_MAX) -> AsyncIterator[None]:
        """Hold the device's turn, once its earlier requests are done.

        Raise TooManyHeavyError where too many of them wait already.
        """
        if self._asked[device] > waiting_max:
            raise TooManyHeavyError(
                "Several long requests of this device are under way already. Wait for their answers."
            )
        self._asked[device] += 1
        try:
            async with self._turns[device]:
                yield
        finally:
            self._asked[device] -= 1
            if not self._asked[device]:
                del self._asked[device], self._turns[device]


async def _take_turn(caller: Caller, heavy: Provided[HeavyRequests]) -> AsyncIterator[None]:
    async with heavy.turn(caller.device):
        yield


async def _take_reading_turn(
    request: Request, caller: Caller, heavy: Provided[HeavyRequests]
) -> AsyncIterator[None]:
    async with heavy.turn(caller.device, READING_MAX):
        await _require_connected(request)
        yield


async def _require_connected(request: Request) -> None:
    if await request.is_disconnected():
        raise TooManyHeavyError("The request was given up before its turn came.")


async def while_connected(request: Request, work: Coroutine[Any, Any, T]) -> T:
    """Return the result of this work; it is cancelled when the client of a request without body has gone.

    Raise TooManyHeavyError then.
    """
    working, gone = asyncio.create_task(work), asyncio.create_task(_wait_until_gone(request))
    try:
        await asyncio.wait((working, gone), return_when=asyncio.FIRST_COMPLETED)
        if not working.done():
            raise TooManyHeavyError("The request was given up before its answer was ready.")
        return working.result()
    finally:
        for task in (working, gone):
            task.cancel()
        await asyncio.gather(working, gone, return_exceptions=True)


async def _wait_until_gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


Turn = Annotated[None, Depends(_take_turn)]
"""A parameter of a route that may cost seconds: it waits for the turn of its caller's device."""
ReadingTurn = Annotated[None, Depends(_take_reading_turn)]
"""The same for a route that reads recordings; where its caller has gone meanwhile, nothing is read."""


async def _read_recordings(
    _: ReadingTurn, request: Request, heavy: Provided[HeavyRequests]
) -> AsyncIterator[None]:
    async with heavy.recordings:
        await _require_connected(request)
        yield


RecordingTurn = Annotated[None, Depends(_read_recordings, scope="function")]
"""The same for a route that reads them in the server's own process: one request of all devices at a time.

The turn ends before the answer is sent, however slowly it is read.
"""
