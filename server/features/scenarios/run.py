"""One run of a scenario: its progress and its cancellation."""

import asyncio
from dataclasses import dataclass, field

from robot_runtime.experiments.scenario.document import Scenario
from server.features.scenarios.schemas import (
    ActiveRun,
    BoardKind,
    End,
    EndedRun,
    Phase,
    Place,
    describe_events,
)


class RunCancelledError(Exception):
    """The run was cancelled; the text says why."""


class RunFailedError(Exception):
    """The run cannot continue; the text says why."""


@dataclass(slots=True)
class RunRecord:
    """Everything about one run; `elapsed` in s of the scenario."""

    run: str
    scenario: Scenario
    text: str
    place: Place
    board: BoardKind
    who: str = ""
    """The person or program that started it."""
    phase: Phase = "waiting"
    elapsed: float = 0.0
    session: int | None = None
    before: int | None = None
    """The newest older session of the same scenario."""
    remarks: list[str] = field(default_factory=list)
    """Deviations from the scenario that did not end the run."""
    _cancelled: asyncio.Event = field(default_factory=asyncio.Event)
    _why: str = ""

    def cancel(self, why: str) -> None:
        """Request an orderly end of the run; the first reason counts."""
        if not self._cancelled.is_set():
            self._why = why
            self._cancelled.set()

    def check(self) -> None:
        """Raise RunCancelledError if the run is cancelled."""
        if self._cancelled.is_set():
            raise RunCancelledError(self._why)

    async def cancelled(self) -> None:
        """Wait until the run is cancelled."""
        await self._cancelled.wait()

    async def sleep(self, seconds: float) -> None:
        """Wait. Raise RunCancelledError."""
        try:
            async with asyncio.timeout(max(seconds, 0.0)):
                await self._cancelled.wait()
        except TimeoutError:
            return
        self.check()

    def describe(self) -> ActiveRun:
        """Return the run as sent to the pages."""
        events = describe_events(self.scenario)
        coming = (event for event in events if event.at > self.elapsed or self.phase == "preparing")
        return ActiveRun(
            run=self.run,
            name=self.scenario.name,
            title=self.scenario.title,
            place=self.place,
            board=self.board,
            phase=self.phase,
            elapsed=round(self.elapsed, 2),
            duration=self.scenario.duration,
            session=self.session,
            next=next(coming, None),
            events=events,
        )

    def end(self, state: End, problem: str) -> EndedRun:
        """Return the end of the run for the pages."""
        return EndedRun(
            run=self.run,
            name=self.scenario.name,
            title=self.scenario.title,
            place=self.place,
            session=self.session,
            before=self.before,
            state=state,
            problem=" ".join([*([problem] if problem else []), *self.remarks]),
        )
