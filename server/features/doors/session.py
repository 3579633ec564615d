"""The base of the doors' sessions: the limits of a program that sends invalid or too many messages.

STOP, which never waits for its turn, has a limit, too: one under way and one behind it. Until one of them is
answered, nothing more is read, so that the program itself waits.
"""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

from robot_runtime.contract import text_input
from robot_runtime.contract.text_input import TextError
from server.features.doors.subscriptions import DoorClient
from server.http.security import POLICY_VIOLATION
from server.stream.hub import EvictedError

INVALID_MAX = 20
"""Invalid messages in a row after which a program is disconnected."""
CALLS_MAX = 8
"""Calls of one program that may wait for the robot at once."""
STOPS_MAX = 2
"""STOPs of one program at once: one under way, and one behind it, as the robot may be armed meanwhile."""
NAME_MAX = 200


class UnusableMessageError(ValueError):
    """A message that the door cannot use; the text says why."""


class BusyError(UnusableMessageError):
    """Too many calls of this program wait already."""


class DoorSession:
    """One program at a door. Subclasses act on its messages."""

    def __init__(self, client: DoorClient) -> None:
        self.client = client
        self._calls: set[asyncio.Task[None]] = set()
        self._stops: set[asyncio.Task[None]] = set()

    async def listen(
        self,
        receive: Callable[[], Awaitable[Any]],
        act: Callable[[Any], None],
        complain: Callable[[str], None],
    ) -> None:
        """Act on each message until there is None. Raise EvictedError where all are invalid."""
        invalid = 0
        try:
            while (message := await receive()) is not None:
                try:
                    act(message)
                    invalid = 0
                except UnusableMessageError as problem:
                    invalid += 1
                    if invalid >= INVALID_MAX:
                        raise EvictedError(
                            f"{invalid} messages in a row were not valid.", POLICY_VIOLATION
                        ) from problem
                    complain(str(problem))
                await self.pause()
        finally:
            calls = self.cancel_calls()
            await asyncio.gather(*calls, return_exceptions=True)

    async def pause(self) -> None:
        """Wait before the next message: for the turn of a STOP, and where a viewer has sent too many."""
        while len(self._stops) >= STOPS_MAX:
            await asyncio.wait(self._stops, return_when=asyncio.FIRST_COMPLETED)
        await self.client.budget.wait_to_receive()

    def cancel_calls(self) -> list[asyncio.Task[None]]:
        """Cancel the pending calls except STOP; return them."""
        calls = [*self._calls]
        for call in calls:
            call.cancel()
        return calls

    def begin(self, call: Coroutine[Any, Any, None], *, always: bool = False) -> None:
        """Work on a call beside the messages that follow it.

        STOP always may, and goes on even if the program leaves before the answer. `pause` is its limit.
        """
        if not always and len(self._calls) >= CALLS_MAX:
            call.close()
            raise BusyError(f"{CALLS_MAX} calls wait already; try again when one is answered.")
        task = asyncio.create_task(call)
        under_way = self._stops if always else self._calls
        under_way.add(task)
        task.add_done_callback(under_way.discard)


def read_json(text: str | bytes, name: str) -> Any:
    """Return the value of a text of JSON. Raise UnusableMessageError."""
    try:
        return text_input.read_json(text)
    except TextError as problem:
        raise UnusableMessageError(f"{name} must be JSON: it {problem}.") from problem


def text_of(value: object, name: str) -> str:
    """Return a text of a message. Raise UnusableMessageError."""
    if not isinstance(value, str) or not 0 < len(value) <= NAME_MAX:
        raise UnusableMessageError(f"{name} must be a text of up to {NAME_MAX} characters.")
    return value


def mapping_of(value: object, name: str) -> dict[str, Any]:
    """Return an object of a message. Raise UnusableMessageError."""
    if not isinstance(value, dict):
        raise UnusableMessageError(f"{name} must be an object.")
    return value


def number_of(value: object, name: str, most: float) -> float:
    """Return a number from 0 to `most`. Raise UnusableMessageError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= most:
        raise UnusableMessageError(f"{name} must be a number from 0 to {most:g}.")
    return value
