"""The container: makes the services of a server, joins them, starts and ends them."""

import asyncio
import json
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from dataclasses import asdict
from functools import partial
from typing import Any

from robot_runtime.clock import Clock, SteadyClock
from robot_runtime.contract.topics import SENT_BY
from robot_runtime.control.alarms import Alarms
from robot_runtime.errors import RefusedError
from robot_runtime.transport.blocks import Block
from server.features.backup.download import DatabaseDownloads
from server.features.board.firmware_upload import FirmwareUpload
from server.features.board.reservation import BoardReservation, RobotBoard
from server.features.bring_up.bring_up_run import BringUpRun
from server.features.comm_tests.runner import CommTestRunner
from server.features.comm_tests.runs import CommTestStore
from server.features.comm_tests.shipped import import_samples
from server.features.comparison.worker import ComparisonWorker
from server.features.doctor.examination import Examination
from server.features.doors.commands import DoorCommands
from server.features.doors.house import Doors
from server.features.doors.ros2_door import Ros2Door
from server.features.events.announcer import EventAnnouncer
from server.features.exports.imports import Imports
from server.features.exports.jobs import Jobs
from server.features.identification.adoption import CraftAdoption
from server.features.identification.runner import IdentificationRunner
from server.features.installation.places import InstallPlaces
from server.features.layouts.library import Layouts
from server.features.lease.arbiter import ControlArbiter
from server.features.lease.sync import LeaseSync
from server.features.missions.marks import MissionMarks
from server.features.missions.trials import MissionTrials
from server.features.operate.performing import CheckedCommands
from server.features.parameters.changes import Changes
from server.features.parameters.profiles import Profiles
from server.features.scenarios.live_run import LiveExecutor
from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.simulated_run import SimulatedExecutor
from server.features.sessions.auto_recording import AutoRecorder
from server.features.sessions.bookmarks import Bookmarks
from server.features.sessions.catalogue import Catalogue
from server.features.sessions.clock_correction import ClockCorrection
from server.features.sessions.provenance import ProvenanceWatch
from server.features.sessions.recorder import Recorder, RecordingRefusedError
from server.features.sessions.resume import InterruptedSession, find_missing
from server.features.sessions.retention import RetentionWorker
from server.features.sessions.session import new_row
from server.features.tuning.runner import TuningRunner
from server.features.tuning.runs import TuningStore
from server.features.updates.page_updates import PageUpdates
from server.health.faults import FAULTS
from server.health.monitor import HealthMonitor
from server.health.watchdog import DOWN, Watchdog
from server.http.audit import ARMING, AuditLog
from server.http.heavy_requests import HeavyRequests
from server.http.page import Page
from server.http.sign_in.access import Access
from server.platform.memory_reserve import MemoryReserve
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.pidfile import running_parts
from server.platform.settings import Settings
from server.platform.store import Store, StoreError
from server.processes.managed_process import ProcessCommand
from server.processes.supervisor import SIMULATION, SIMULATION_ELSEWHERE, ProcessSupervisor
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.budget import Budgets
from server.stream.hub import Hub

log = logging.getLogger(__name__)

HEALTH_SECONDS = 1.0
BEAT_SECONDS = 1.0


class Container:
    """Everything that lives as long as the server does."""

    def __init__(
        self, settings: Settings, commands: Sequence[ProcessCommand], token: str, ended: str = ""
    ) -> None:
        self.settings = settings
        self._stopping: asyncio.Task[None] | None = None
        self._ended = ended
        """A sentence about the unexpected end of the server before this one; empty without one."""
        self.clock: Clock = SteadyClock()
        self.page = Page(settings.page)
        self.store = Store(settings.data.database)
        self.notices = Notices(self.clock, lambda block: self._deliver([block]))
        self.bridge = Bridge(settings, self._deliver)
        self.hub = Hub(self.clock, self.bridge.watch_pictures)
        self.events = EventAnnouncer(settings, self.clock)
        self.audit = AuditLog(settings.data.audit, self.clock, self._note_act)
        self.access = Access(settings, self.store, self.clock, self.notices.notify, self._dismiss, token)
        self.changes = Changes(self.store, self.bridge)
        self.profiles = Profiles(self.store)
        self._add_lease()
        self._add_health(commands)
        self._add_sessions()
        self._add_comm_tests()
        self._add_tuning()
        self._add_scenarios()
        self._add_identification()
        self.budgets = Budgets(self.clock)
        self.doors = Doors(settings, self.clock, self.hub, self.budgets)
        self.changes.listeners.append(self.doors.note_parameters)
        self.commands = CheckedCommands(self.changes, settings, self.alarms)
        self._add_ros2()
        self.heavy_requests = HeavyRequests()
        self.memory_reserve = MemoryReserve(self.clock)
        self.downloads = DatabaseDownloads(settings.data, settings.config)
        self.layouts = Layouts(self.store)
        self.updates = PageUpdates(self.settings.data, InstallPlaces())

    def _add_ros2(self) -> None:
        commands = DoorCommands(
            "/ros2", self.clock, self.access, self.commands, self.bridge, self.arbiter, self.audit
        )
        self.ros2 = Ros2Door(self.settings, self.access, self.arbiter, self.audit, self.doors, commands)

    def _add_lease(self) -> None:
        self.lease_sync = LeaseSync(self.bridge.send_lease)
        self.arbiter = ControlArbiter(
            self.clock,
            self._notify_control,
            self.bridge.drive,
            lambda text: self.notices.notify("control", "info", text),
            lambda identity, why: self.audit.record(identity, "", "Lose control", why, "done"),
        )

    def _add_health(self, commands: Sequence[ProcessCommand]) -> None:
        self.alarms = Alarms(self.clock, FAULTS, self.notices.add_event, changed=self._notify_alarms)
        self.processes = ProcessSupervisor(commands, self.settings.data, self.clock, self._see_down)
        self.monitor = HealthMonitor(
            self.settings, self.clock, self.store, self.processes, self.events.condition
        )
        self.examination = Examination(self.settings, self.monitor, self.notices)
        self.watchdog = Watchdog(
            self.settings, self.clock, self.monitor, self.processes, self.store, self.alarms
        )

    def _add_sessions(self) -> None:
        self.provenance = ProvenanceWatch(
            self.settings, lambda: self.bridge.query("provenance"), self.notices
        )
        self.recorder = Recorder(self.store, self.clock, self.notices, self._notify_session, self.provenance)
        self.catalogue = Catalogue(self.store, self.recorder)
        self.bookmarks = Bookmarks(self.store, self.clock, self.recorder)
        self.mission_marks = MissionMarks(self.recorder, self.bookmarks, self.catalogue)
        self.clock_correction = ClockCorrection(self.store, self.notices, self.clock, self.catalogue.notify)
        self.arming = AutoRecorder(self.recorder, self.clock, self.notices, self._armed_row)
        self.jobs = Jobs(self.settings.data, self.store, self.clock)
        self.retention = RetentionWorker(
            self.store, self.settings, self.notices, self.clock, self.jobs.see_purged
        )
        self.imports = Imports(self.settings.data, self.store)
        self.comparison = ComparisonWorker(self.settings.data.database)

    def _add_comm_tests(self) -> None:
        board = RobotBoard(self.settings, self.notices.notify, self.provenance.read_firmware)
        self.board_reservation = BoardReservation(
            board, self.bridge, self.monitor, self.processes, self.clock, self._board_occupied
        )
        self.comm_tests = CommTestRunner(
            self.settings,
            CommTestStore(self.store),
            self.clock,
            self.hub.notify,
            self.board_reservation.reserve,
            self.events.see_comm_test,
        )

        self.firmware_upload = FirmwareUpload(self.settings, board, self.board_reservation.reserve)
        self.bring_up = BringUpRun(self.settings, board, self.board_reservation.reserve, self.processes)

    def _add_scenarios(self) -> None:
        self._live = LiveExecutor(
            self.settings,
            self.store,
            self.recorder,
            self.bridge,
            self.changes,
            self.monitor,
            self.processes,
            self.clock,
            self.notices.notify,
        )
        simulated = SimulatedExecutor(self.settings, self.store, self.notices)
        self.scenarios = ScenarioRunner(self._live, simulated, self._notify_pages)
        self.bridge.on_stop = self._see_stop
        self.mission_trials = MissionTrials(self.settings)

    def _add_identification(self) -> None:
        self.craft_adoption = CraftAdoption(self.settings, self.monitor, self.processes, self.changes)
        self.identification = IdentificationRunner(self.settings, self.craft_adoption)

    def _add_tuning(self) -> None:
        self.tuning = TuningRunner(
            TuningStore(self.store),
            self.bridge,
            self.changes,
            self.clock,
            self._notify_pages,
            self.notices.notify,
            self._scenario_on,
        )

    @property
    def services(self) -> dict[type, object]:
        """The services that routes are provided with, by their types."""
        return {type(service): service for service in vars(self).values()} | {Clock: self.clock}

    @asynccontextmanager
    async def run(self) -> AsyncIterator[None]:
        """Start everything; end everything. Raises SetupError, StoreError."""
        tasks: list[asyncio.Task[None]] = []
        self.memory_reserve.watch(asyncio.get_running_loop())
        try:
            interrupted = await self.recorder.recover()
            await self.imports.recover()
            self.downloads.recover()
            self.updates.recover()
            self.jobs.open()
            await self.comm_tests.runs.mark_interrupted()
            await self.tuning.runs.mark_interrupted()
            await import_samples(self.comm_tests.runs)
            self.access.open()
            self.events.open()
            await self.bridge.open()
            tasks.append(self._begin(self._beat()))
            await self.processes.end_others()
            await self._catch_up(interrupted)
            self._notify_session()
            self._notify_alarms()
            if self._ended:
                self.alarms.begin("server_restarted", f"{self._ended} It was started again.")
            with suppress(StoreError):
                # Killed again at once, it has stored its restart. The watchdog tells of a failure.
                await self.recorder.flush()
            if self.settings.hil.simulator == "elsewhere":
                for name in SIMULATION:
                    await self.processes.pause(name, SIMULATION_ELSEWHERE)
            self.scenarios.announce()
            self.tuning.announce()
            tasks += [
                self._begin(work)
                for work in (
                    self.board_reservation.start_processes(),
                    self.recorder.run(),
                    self._live.recover(),
                    self.jobs.run(),
                    self.hub.watch(),
                    self.retention.run(),
                    self.clock_correction.run(),
                    self.arbiter.run(),
                    self.lease_sync.run(),
                    self.provenance.run(),
                    self.watchdog.run(),
                    self.examination.at_start(),
                    self.tuning.run(),
                    self._notify_health(),
                )
            ]
            await self.ros2.open()
            yield
        finally:
            # Also where one of them fails: what is left open keeps the process.
            async with AsyncExitStack() as ending:
                for close in reversed(self._closes(tasks)):
                    ending.push_async_callback(close)

    def _closes(self, tasks: Sequence[asyncio.Task[None]]) -> Sequence[Callable[[], Awaitable[object]]]:
        """The calls that end everything, in their order."""
        return (
            self.ros2.close,
            partial(_cancel, tasks),
            self.tuning.close,
            self.scenarios.close,
            self.comm_tests.close,
            self.bring_up.close,
            self.firmware_upload.close,
            self.comparison.close,
            self.identification.close,
            self.mission_trials.close,
            self.processes.stop,
            self.arming.close,
            self.mission_marks.close,
            self._end_session,
            self.events.close,
            self.bridge.close,
            self.access.devices.close,
            partial(asyncio.to_thread, self.audit.close),
            partial(asyncio.to_thread, self.store.close),
        )

    def _begin(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Begin a background task, whose failure is logged and an alarm."""
        task = asyncio.create_task(work, name=getattr(work, "__qualname__", None))
        task.add_done_callback(self._see_failed)
        return task

    def _see_failed(self, task: asyncio.Task[None]) -> None:
        if task.cancelled() or (problem := task.exception()) is None:
            return
        name = task.get_name()
        log.error("the background task %s has failed", name, exc_info=problem)
        self.alarms.begin("server_task_failed", f"Its task {name} ended: {problem}.")

    async def _catch_up(self, interrupted: InterruptedSession | None) -> None:
        """Take in what the parts of a killed server have sent since, before anybody is served."""
        running = set(running_parts(self.settings.data.run))
        if "runtime" in running and self.settings.in_the_loop:
            running.add("simulator")  # perhaps on another computer
        backlogs = await self.bridge.catch_up(running)
        if interrupted is not None:
            found = {name: find_missing(interrupted, SENT_BY[name], one) for name, one in backlogs.items()}
            await self.recorder.resume(interrupted, found)
        self.bridge.begin_delivery(backlogs)
        self.recorder.caught_up()

    def _deliver(self, blocks: list[Block]) -> None:
        self.hub.add(blocks)
        states: list[Block] = []
        for block in blocks:
            self.recorder.add(block)
            self.monitor.see(block)
            self.tuning.see(block)
            self.doors.see(block)
            self.events.see(block)
            if block.topic.name == "event":
                self.mission_marks.see(block)
            if block.topic.name == "state":
                states.append(block)
        if states:
            self.lease_sync.see_run(self.bridge.run)
            self.provenance.see_run(self.bridge.run)
            if self.settings.sessions.record_at_arming:
                self.arming.see(states)

    def _see_stop(self) -> None:
        self.scenarios.see_stop()
        self.bring_up.see_stop()

    def _scenario_on(self) -> str | None:
        run = self.scenarios.active
        if run is not None and run.place == "live":
            return f"The scenario “{run.scenario.title}” is being run. Cancel it first."
        return None

    def _board_occupied(self) -> str | None:
        session = self.recorder.session
        if (scenario := self._scenario_on()) is not None:
            return scenario
        # An automatic recording ends by itself: reserving the board disarms the robot.
        if session is None or session.origin == "arming":
            return None
        return f"“{session.name}” is being recorded. Stop the recording first."

    async def _armed_row(self, name: str, state: str) -> SessionRow:
        return await asyncio.to_thread(new_row, self.settings, self.clock, name, "", state, origin="arming")

    def _note_act(self, operation: str, text: str) -> None:
        if operation in ARMING and self.settings.sessions.record_at_arming:
            self.arming.note_arming(text)
        else:
            self.notices.notify("control", "info", text)

    def _notify_session(self) -> None:
        session = self.recorder.session
        self._notify_pages({"op": "session", "recording": session and json.loads(session.model_dump_json())})

    def _dismiss(self, device: int, reason: str) -> None:
        self.arbiter.dismiss(device)
        self.hub.dismiss(device, reason)
        self.doors.dismiss(device, reason)

    def _notify_control(self, message: dict[str, Any]) -> None:
        self.lease_sync.see_epoch(message["epoch"])
        self.hub.notify(message)

    def _notify_alarms(self) -> None:
        self._notify_pages({"op": "alarms", "alarms": [asdict(alarm) for alarm in self.alarms.listed()]})

    def _notify_pages(self, message: dict[str, Any]) -> None:
        """Send the pages a message that may be an event for other programs too."""
        self.hub.notify(message)
        self.events.see_message(message)

    def _see_down(self, part: str, text: str) -> None:
        self.alarms.begin(DOWN[part], text)
        if part == "simulator":
            self._stopping = asyncio.create_task(self._stop_without_water())

    async def _stop_without_water(self) -> None:
        # The simulator may be back before the frozen sensors are a fault, with the robot at another place.
        with suppress(RefusedError, RuntimeSilentError):
            await self.bridge.disarm()

    async def _notify_health(self) -> None:
        while True:
            self.arming.tick()
            board = self.processes.get("board")
            await self.provenance.see_board(None if board is None else board.pid)
            health = self.monitor.health()
            parts = [part.model_dump() for part in health.parts]
            self.hub.notify({"op": "health", "parts": parts})
            self.doors.see_health(parts)
            await asyncio.sleep(HEALTH_SECONDS)

    async def _beat(self) -> None:
        while True:
            self.bridge.send_heartbeat(self.hub.operators)
            await asyncio.sleep(BEAT_SECONDS)

    async def _end_session(self) -> None:
        if self.recorder.session is not None:
            # Where even its end cannot be stored, the next start marks it as interrupted.
            with suppress(StoreError, RecordingRefusedError):
                await self.recorder.stop(self.recorder.session.id)


async def _cancel(tasks: Sequence[asyncio.Task[None]]) -> None:
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
