"""A scenario on the robot in real time, by an operator's commands."""

import asyncio
import json
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.experiments.scenario.events import LineFaultChange, TimedEvent
from robot_runtime.simulation.water.parameters import SimulationParameters
from server.driving.changes import Changes, Send
from server.features.scenarios.live_setup import LiveSetup, SavedState
from server.features.scenarios.recording import begin, describe_session, mark
from server.features.scenarios.run import RunCancelledError, RunFailedError, RunRecord
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.platform.store import Store, StoreError
from server.processes.managed_process import Notify
from server.processes.supervisor import ProcessSupervisor
from server.recording.recorder import Recorder, RecordingRefusedError
from server.stream.bridge import Bridge, RuntimeSilentError

POLL_SECONDS = 0.1
STATE_SECONDS = 5.0
"""The runtime sends its state once a second."""
SETTLE_SECONDS = 0.5
"""Time after a change of the water, for the sensors to follow before the recording begins."""
NEEDED = ("board", "runtime", "simulator")


class LiveExecutor:
    """Executor of scenarios on the running robot with its simulated water and its recorder."""

    def __init__(
        self,
        settings: Settings,
        store: Store,
        recorder: Recorder,
        bridge: Bridge,
        changes: Changes,
        monitor: HealthMonitor,
        processes: ProcessSupervisor,
        clock: Clock,
        notify: Notify,
    ) -> None:
        self._settings = settings
        self._store = store
        self._recorder = recorder
        self._bridge = bridge
        self._changes = changes
        self._monitor = monitor
        self._processes = processes
        self._clock = clock
        self._notify = notify
        self._snapshot = settings.data.scenario_before
        self._recovering = False
        self._setup = LiveSetup(bridge, settings.data.board_socket if settings.emulated_board else None)

    def check(self, scenario: Scenario) -> None:
        """Raise RefusedError with all reasons against a run now."""
        if reasons := [*self._find_obstacles(), *self._find_differences(scenario)]:
            raise RefusedError(" ".join(reasons))

    async def perform(self, run: RunRecord) -> None:
        """Perform a run. Raise the errors of `ScenarioExecutor.perform`."""
        self.check(run.scenario)
        run.phase = "preparing"
        processes = self._process_ids()
        before = await self._setup.read(await self._next_state())
        await asyncio.to_thread(before.write, self._snapshot)
        async with self._changes.together(run.who, f"Scenario “{run.scenario.title}”") as send:
            try:
                await self._setup.prepare(run.scenario, before, send)
                await run.sleep(SETTLE_SECONDS)
                await self._record(run, processes, send)
            finally:
                run.phase = "ending"
                await _finish_step(self._put_back(before, send))

    async def recover(self) -> None:
        """Clean up after a killed server: disarm, close the recording, restore the previous state."""
        before = await asyncio.to_thread(SavedState.read, self._snapshot)
        recording = self._recorder.session
        session = recording.id if recording is not None and recording.origin == "scenario" else None
        if before is None and session is None:
            return
        self._recovering = True
        try:
            while (state := self._monitor.state()) is None:
                await asyncio.sleep(POLL_SECONDS)
            killed = self._clock.now()
            disarmed = await self._disarm()
            if session is not None:
                await self._close_recording(session, killed)
            # A restarted runtime already has the settings of robot.toml; water and board may have lived on.
            same = before is not None and state["run"] == before.robot["run"]
            restored = before is not None and await self._put_back(
                before, self._changes.put_back if same else None
            )
        finally:
            self._recovering = False
        text = "The server was killed during a scenario."
        if disarmed and restored:
            text += " The robot is disarmed and has its previous settings."
        self._notify("scenario", "caution", text)

    async def _close_recording(self, session: int, killed: float) -> None:
        """End the recording of a killed server's run, as far as the disk allows."""
        with suppress(StoreError):
            await mark(self._store, session, killed, "The server was killed; the scenario ends here.")
        with suppress(StoreError, RecordingRefusedError):
            await self._recorder.stop(session)

    async def _record(self, run: RunRecord, processes: Mapping[str, int | None], send: Send) -> None:
        row = describe_session(self._settings, self._clock, run, json.dumps(self._monitor.state()))
        session = await begin(self._recorder, self._store, run, row)
        try:
            await self._play(run, row.started_steady, processes, send)
        except RunCancelledError as why:
            await mark(self._store, session, self._clock.now(), str(why))
            raise
        finally:
            run.phase = "ending"
            await _finish_step(self._finish(session))

    async def _play(
        self, run: RunRecord, began: float, processes: Mapping[str, int | None], send: Send
    ) -> None:
        coming = list(run.scenario.events)
        while True:
            run.elapsed = self._clock.now() - began
            self._check_processes(run, processes)
            while coming and coming[0].at <= run.elapsed:
                run.check()
                await self._apply_event(run, coming.pop(0), began, send)
            if run.elapsed >= run.scenario.duration:
                return
            until = min([run.scenario.duration, *(event.at for event in coming[:1])])
            await run.sleep(min(until - run.elapsed, POLL_SECONDS))

    async def _apply_event(self, run: RunRecord, event: TimedEvent, began: float, send: Send) -> None:
        assert run.session is not None
        text = event.label
        try:
            await self._setup.apply(event, send)
        except (RefusedError, RuntimeSilentError) as problem:
            # The robot may refuse a command, as to an operator; the experiment continues.
            text = f"{text}: refused. {problem}"
            run.remarks.append(f"At {event.at:g} s: {text}")
        await mark(self._store, run.session, max(self._clock.now(), began), text)

    def _check_processes(self, run: RunRecord, processes: Mapping[str, int | None]) -> None:
        """Raise RunCancelledError or RunFailedError if the run can no longer continue."""
        recording = self._recorder.session
        if recording is None or recording.id != run.session:
            raise RunCancelledError("The recording was stopped.")
        if self._bridge.reserved_reason is not None:
            raise RunFailedError(self._bridge.reserved_reason)
        for name, pid in self._process_ids().items():
            if pid != processes[name]:
                raise RunFailedError(f"The {name} ended during the run, and its settings are lost.")

    async def _finish(self, session: int) -> None:
        """Disarm, and stop the scenario's recording afterwards."""
        await self._disarm()
        if self._recorder.session is not None and self._recorder.session.id == session:
            await self._recorder.stop(session)

    async def _disarm(self) -> bool:
        """Disarm, and let the sensors follow; return False, with an alarm, if the robot stays armed."""
        try:
            await self._setup.disarm()
        except (RefusedError, RuntimeSilentError) as problem:
            text = f"The robot could not be disarmed after the scenario: {problem}"
            self._notify("scenario", "alarm", text)
            return False
        await asyncio.sleep(SETTLE_SECONDS)
        return True

    async def _put_back(self, before: SavedState, send: Send | None) -> bool:
        """Restore the previous state; without `send` only that of the water and the board.

        Return False, with a notice, if some of it is not restored.
        """
        problems = await self._setup.put_back(before, send)
        if problems:
            text = " ".join(problems)
            self._notify(
                "scenario", "caution", f"Some settings from before the scenario are not restored. {text}"
            )
        await asyncio.to_thread(self._snapshot.unlink, missing_ok=True)
        return not problems

    def _find_obstacles(self) -> list[str]:
        recording = self._recorder.session
        if self._recovering:
            return ["The state before an interrupted scenario is being restored. Wait a moment."]
        if self._settings.robot.mode == "robot":
            return [
                "A scenario changes the water, and this robot swims in real water: robot.mode is “robot”."
            ]
        if self._bridge.reserved_reason is not None:
            return [self._bridge.reserved_reason]
        state = self._monitor.state()
        if state is None:
            return ["The robot's runtime has said nothing yet. Wait a moment."]
        if (age := self._monitor.silence()) is not None:
            return [f"The robot's state is unknown: its runtime has said nothing for {age:.0f} s."]
        reasons = []
        if recording is not None:
            reasons.append(f"“{recording.name}” is being recorded. Stop the recording first.")
        if state["armed"]:
            reasons.append("The robot is armed. STOP it first.")
        elif state["mode"] == "failsafe":
            reasons.append("The robot is in failsafe. Acknowledge its alarms first.")
        if not state["connected"]:
            reasons.append(f"There is no connection to the board: {state['connection']}.")
        reasons += [f"The {name} does not run." for name, pid in self._process_ids().items() if pid is None]
        return reasons

    def _find_differences(self, scenario: Scenario) -> list[str]:
        """Return the differences between the running robot and the scenario's."""
        reasons = []
        if not self._settings.emulated_board and any(
            isinstance(event, LineFaultChange) for event in scenario.events
        ):
            reasons.append("It disturbs the serial line, which needs an emulated board.")
        if scenario.robot not in (
            SimulationParameters(),
            SimulationParameters.of(self._settings.read_craft()),
        ):
            reasons.append("It changes the hull's parameters, which needs simulated time.")
        if scenario.mistakes:
            reasons.append("Its board has mistakes, which needs simulated time.")
        state = self._monitor.state() or {}
        rate = state.get("control_rate", scenario.control.rate)
        if rate != scenario.control.rate:
            reasons.append(
                f"It needs control at {scenario.control.rate:g} Hz; this robot's runs at {rate:g} Hz "
                "([control] rate in robot.toml)."
            )
        return reasons

    async def _next_state(self) -> dict[str, Any]:
        """Return the next state of the runtime: the newest one may precede the last change."""
        asked = self._clock.now()
        try:
            async with asyncio.timeout(STATE_SECONDS):
                while (state := self._monitor.state()) is None or state["time"] < asked:
                    await asyncio.sleep(POLL_SECONDS)
        except TimeoutError:
            raise RefusedError("The robot's runtime does not tell its state. Wait a moment.") from None
        return state

    def _process_ids(self) -> dict[str, int | None]:
        # With hardware in the loop the simulator may be on another computer; without it the robot disarms.
        needed = [name for name in NEEDED if not (self._settings.in_the_loop and name == "simulator")]
        processes = {name: self._processes.get(name) for name in needed}
        return {name: part.pid for name, part in processes.items() if part is not None}


async def _finish_step(step: Any) -> None:
    """Finish a step even while the server shuts down."""
    await asyncio.shield(asyncio.create_task(step))
