"""A scenario from a shell: in simulated time if no server uses the data folder, else by the server."""

import asyncio
import math
import signal
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack
from time import sleep

from robot_runtime.clock import SteadyClock
from robot_runtime.experiments.scenario.document import read_scenario
from server.driving.shell_control import in_control, renew_control
from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.schemas import EndedRun, ScenarioEvent, ScenarioStart, ScenarioState
from server.features.scenarios.simulated_run import SimulatedExecutor
from server.platform.folder_lock import claim
from server.platform.notices import Notices
from server.platform.running_server import ask
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.shell_store import open_writer
from server.platform.store import Store
from server.platform.terminal import echo

POLL_SECONDS = 0.25
CANCELLED = "The run was cancelled; its recording stays."
ENDED = "The run has ended, and another one since; the page Sessions has its recording."
TAKEN_OUT = "The run was taken out of the queue."


def run_scenario(start: ScenarioStart, settings: Settings, *, take_over: bool) -> int:
    """Run a scenario and print its events as they come. Return the exit status: 1 if it did not complete.

    Raise SetupError if it cannot start.
    """
    with ExitStack() as claimed:
        if start.place == "simulated" and _enter(claimed, claim(settings.data)):
            return _conclude(_run_here(start, settings))
    return _conclude(_run_there(start, settings.data, take_over=take_over))


def _enter(claimed: ExitStack, claim: AbstractContextManager[None]) -> bool:
    """Return True if the data folder was claimed; False if a server uses it or it is not usable."""
    try:
        claimed.enter_context(claim)
    except SetupError:
        return False
    return True


def _run_here(start: ScenarioStart, settings: Settings) -> EndedRun:
    with open_writer(settings.data) as store:
        return asyncio.run(_simulate(start, settings, store))


async def _simulate(start: ScenarioStart, settings: Settings, store: Store) -> EndedRun:
    progress = _Progress()
    simulated = SimulatedExecutor(settings, store, Notices(SteadyClock(), lambda _: None))
    runs = ScenarioRunner(
        simulated, simulated, lambda message: progress.notify(ScenarioState.model_validate(message))
    )
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, runs.cancel)
    runs.start(read_scenario(start.text), start.text, start.place, start.board)
    await runs.wait()
    last = runs.state().last
    assert last is not None
    return last


def _run_there(start: ScenarioStart, folder: DataFolder, *, take_over: bool) -> EndedRun:
    """Run the scenario by the running server; Ctrl-C cancels it there."""
    if start.place == "simulated":
        run = ask(folder, "POST", "/scenarios/runs", start.model_dump())["run"]
        return _follow(run, folder, lambda: None)
    with in_control(folder, over=take_over):
        run = ask(folder, "POST", "/scenarios/runs", start.model_dump())["run"]
        return _follow(run, folder, lambda: renew_control(folder))


def _follow(run: str, folder: DataFolder, keep: Callable[[], None]) -> EndedRun:
    """Print the run's events until its end. Raise SetupError where its end is not known."""
    progress = _Progress()
    began = False
    try:
        while True:
            keep()
            state = ScenarioState.model_validate(ask(folder, "GET", "/scenarios/state"))
            progress.notify(state)
            if state.last is not None and state.last.run == run:
                return state.last
            active = state.active is not None and state.active.run == run
            began |= active
            if not active and run not in (record.run for record in state.queued):
                raise SetupError(ENDED if began else TAKEN_OUT)
            sleep(POLL_SECONDS)
    except KeyboardInterrupt:
        ask(folder, "POST", f"/scenarios/cancel?run={run}")
        raise SetupError(CANCELLED if began else TAKEN_OUT) from None


def _conclude(last: EndedRun) -> int:
    text = f"{last.title}: {last.state}. {last.problem}".strip()
    echo(text if last.session is None else f"{text} Session {last.session}.")
    return 0 if last.state == "complete" else 1


class _Progress:
    """The printed events of a run, in step with it."""

    def __init__(self) -> None:
        self._run: str | None = None
        self._events: list[ScenarioEvent] = []
        self._printed = 0

    def notify(self, state: ScenarioState) -> None:
        """Print the new events of this state."""
        active, last = state.active, state.last
        if last is not None and last.run == self._run and last.state == "complete":
            # A fast run may end before its last events are reported.
            self._print_until(math.inf)
        if active is None or active.phase not in ("running", "ending"):
            return
        if active.run != self._run:
            self._run, self._events, self._printed = active.run, active.events, 0
            echo(f"run {active.run}: {active.title}, {active.place}, {active.duration:g} s")
        self._print_until(active.elapsed)

    def _print_until(self, time: float) -> None:
        past = [event for event in self._events if event.at <= time]
        for event in past[self._printed :]:
            echo(f"{event.at:8.1f} s  {event.words}")
        self._printed = max(self._printed, len(past))
