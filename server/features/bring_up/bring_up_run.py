"""One bring-up at a time: it reserves the board, uploads the sketch, performs actions, writes the report."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from datetime import UTC, datetime
from math import degrees

from robot_runtime.contract.packets import Raw
from robot_runtime.durable_files import write_whole
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.bring_up.bench import Bench, BenchError, SerialBench
from robot_runtime.experiments.bring_up.guide import STEPS, Step
from robot_runtime.experiments.bring_up.procedure import BringUp
from robot_runtime.experiments.bring_up.readings import BATTERY_VOLTS, GRAVITY, counts, field
from robot_runtime.places import FIRMWARE_REMEDY
from robot_runtime.simulation.boards.emulator_process import BoardError
from robot_runtime.simulation.boards.firmware import bring_up_path
from robot_runtime.simulation.boards.workbench import ALONG, BAROMETER, BATTERY, TIP_DOWN, Hands
from server.board_reservation import RobotBoard
from server.features.bring_up.report import write_report
from server.features.bring_up.schemas import (
    BeaconLevels,
    BenchHands,
    BringUpAction,
    BringUpResult,
    BringUpState,
    BringUpStep,
    EncoderReading,
    HandsOrder,
    ImuRaw,
    Phase,
    RawReadings,
)
from server.platform.errors import NotFoundError, explain_internal_error
from server.platform.runs import new_run, require_run
from server.platform.settings import Settings
from server.processes.supervisor import ProcessSupervisor

log = logging.getLogger(__name__)

IDLE_SECONDS = 1800.0
"""Time without any action after which a bring-up ends by itself, so that the robot can be used again."""
ON_THE_BENCH = "The emulated robot lies on a workbench while it is brought up."
REPORT = "/api/bring-up/report"
Reserve = Callable[[str], AbstractAsyncContextManager[list[str]]]


class NoReportError(NotFoundError):
    """There was no bring-up yet"""


class BringUpRun:
    """The bring-up of this server's robot."""

    def __init__(
        self, settings: Settings, board: RobotBoard, reserve: Reserve, processes: ProcessSupervisor
    ) -> None:
        self._settings = settings
        self._board = board
        self._reserve = reserve
        self._processes = processes
        self._run_name = ""
        self._phase: Phase = "idle"
        self._state_text = ""
        self._problem = ""
        self._bench: Bench | None = None
        self._hands: Hands | None = None
        self._procedure: BringUp | None = None
        self._task: asyncio.Task[None] | None = None
        self._over = asyncio.Event()
        self._acted = asyncio.Event()
        self._acting = asyncio.Lock()

    async def begin(self) -> None:
        """Begin; `state` shows when the board is ready. Raise RefusedError where it cannot begin."""
        if self._task is not None and not self._task.done():
            raise RefusedError("A bring-up is going on. End it first.")
        sketch = bring_up_path(self._settings.build, self._settings.link.baud)
        if not sketch.exists():
            raise RefusedError(f"There is no {sketch}; {FIRMWARE_REMEDY}.")
        self._over.clear()
        self._run_name = new_run()
        self._phase, self._problem = "starting", ""
        self._state_text = "The robot is disarmed and its board reserved."
        reserved: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._task = asyncio.create_task(self._run(reserved))
        await asyncio.shield(reserved)

    def end(self, run: str | None = None) -> None:
        """End the bring-up; the robot's firmware is uploaded again meanwhile. Raise RunOverError."""
        require_run(run, self._run_name, "bring-up")
        self._over.set()

    async def close(self) -> None:
        """End the bring-up and wait for its end."""
        self.end()
        if self._task is not None:
            await asyncio.wait([self._task])

    def see_stop(self) -> None:
        """Stop the motor at a STOP; a held button must be released and pressed again."""
        if self._bench is not None and self._procedure is not None:
            with suppress(BenchError):
                self._procedure.stop()

    async def perform(
        self, step: str, action: str, inputs: Mapping[str, float | str], run: str | None = None
    ) -> None:
        """Perform an action. Raise RefusedError where it cannot be done, RunOverError."""
        require_run(run, self._run_name, "bring-up")
        procedure = self._procedure
        if procedure is None or self._phase != "ready":
            raise RefusedError("The board is not ready. Begin the bring-up, and wait until it is.")
        self._acted.set()
        async with self._acting:
            try:
                await asyncio.to_thread(procedure.perform, step, action, inputs)
            except BenchError as problem:
                raise RefusedError(str(problem)) from problem
        if step == "store":
            await asyncio.to_thread(self._write_report, procedure)

    async def use_hands(self, order: HandsOrder) -> None:
        """Move or wire the emulated robot as a person's hands do. Raise RefusedError where there is none."""
        hands = self._hands
        if hands is None:
            raise RefusedError("Only an emulated robot whose bring-up goes on can be handled from here.")
        self._acted.set()
        hands.bench.pose = order.pose or hands.bench.pose
        hands.bench.lamp = order.lamp or hands.bench.lamp
        if order.depth_cm is not None:
            hands.bench.depth = order.depth_cm / 100
        try:
            if order.turn is not None:
                angle = ALONG if order.turn.to == "along" else TIP_DOWN
                await asyncio.to_thread(hands.turn, order.turn.fin, angle)
            if order.leak is not None:
                await asyncio.to_thread(hands.wet, order.leak)
            if order.mend:
                await asyncio.to_thread(hands.mend)
        except BoardError as problem:
            raise RefusedError(str(problem)) from problem

    def report(self) -> str:
        """Return the newest report. Raise NoReportError."""
        try:
            return self._settings.data.bring_up.read_text(encoding="utf-8")
        except FileNotFoundError as problem:
            raise NoReportError("There was no bring-up yet, so there is no report.") from problem

    def state(self) -> BringUpState:
        """Return the state for the pages."""
        return BringUpState(
            run=self._run_name,
            phase=self._phase,
            words=self._state_text,
            problem=self._problem,
            steps=[self._describe(step) for step in STEPS],
            raw=self._raw(),
            hands=None if self._hands is None else _describe_hands(self._hands),
            report=REPORT if self._settings.data.bring_up.exists() else None,
        )

    async def _run(self, reserved: "asyncio.Future[None]") -> None:
        begun = False
        try:
            async with self._reserve("The bring-up") as arguments:
                begun = True
                reserved.set_result(None)
                await self._work(arguments[arguments.index("--port") + 1])
        except RefusedError as problem:
            if reserved.done():
                self._problem = str(problem)
            else:
                reserved.set_exception(problem)
        except Exception as why:
            log.exception("the bring-up failed")
            self._problem = explain_internal_error(why)
        finally:
            if begun:
                self._problem = " ".join(filter(None, (self._problem, self._board.problem)))
            self._state_text = "The robot's firmware is on its board." if begun and not self._problem else ""
            self._phase = "idle"
            if not reserved.done():
                reserved.set_exception(RefusedError("The bring-up ended before it began."))

    async def _work(self, port: str) -> None:
        try:
            self._state_text = "The bring-up's sketch is uploaded to the board."
            sketch = bring_up_path(self._settings.build, self._settings.link.baud)
            if problem := await self._board.upload(sketch):
                self._problem = f"The sketch is not on the board: {problem}."
                return
            self._state_text = "The board is expected to answer."
            async with self._at_hand():
                await self._measure(SerialBench(port, self._settings.link.baud))
        except (BenchError, BoardError) as problem:
            self._problem = str(problem)
        finally:
            self._phase, self._state_text = "ending", "The robot's firmware is uploaded again."

    async def _measure(self, bench: SerialBench) -> None:
        await asyncio.to_thread(bench.__enter__)
        try:
            self._bench, self._procedure = bench, BringUp(bench)
            self._phase, self._state_text = "ready", "The board answers."
            await self._wait()
            await asyncio.to_thread(self._write_report, self._procedure)
        finally:
            self._bench = None
            await asyncio.to_thread(bench.__exit__, None, None, None)

    @asynccontextmanager
    async def _at_hand(self) -> AsyncIterator[None]:
        """Hold an emulated robot out of its water meanwhile, so that hands can turn it."""
        if not self._settings.emulated_board:
            yield
            return
        simulator = self._processes.get("simulator")
        # One that was moved to another computer stays there.
        if simulator is not None and simulator.state != "paused":
            await self._processes.pause("simulator", ON_THE_BENCH)
        try:
            hands = await asyncio.to_thread(Hands(self._settings.data.board_socket).__enter__)
            try:
                self._hands = hands
                yield
            finally:
                self._hands = None
                await asyncio.to_thread(hands.__exit__, None, None, None)
        finally:
            if simulator is not None and simulator.problem == ON_THE_BENCH:
                self._processes.resume("simulator")

    async def _wait(self) -> None:
        while not self._over.is_set():
            self._acted.clear()
            waits = [asyncio.create_task(event.wait()) for event in (self._over, self._acted)]
            done, _ = await asyncio.wait(waits, timeout=IDLE_SECONDS, return_when=asyncio.FIRST_COMPLETED)
            for task in waits:
                task.cancel()
            if not done:
                self._problem = "Nobody did anything for half an hour, so the bring-up ended."
                return

    def _write_report(self, procedure: BringUp) -> None:
        text = write_report(self._settings.robot.name, datetime.now(UTC), procedure)
        try:
            write_whole(self._settings.data.bring_up, text.encode())
        except OSError as problem:
            self._problem = f"The report could not be written: {problem.strerror}."

    def _describe(self, step: Step) -> BringUpStep:
        procedure = self._procedure
        return BringUpStep(
            name=step.name,
            title=step.title,
            about=step.about,
            expected=step.expected,
            state=procedure.state(step.name) if procedure else "open",
            actions=[BringUpAction.model_validate(action, from_attributes=True) for action in step.actions],
            results=[
                BringUpResult.model_validate(result, from_attributes=True)
                for result in (procedure.results(step.name) if procedure else [])
            ],
        )

    def _raw(self) -> RawReadings | None:
        raw = self._bench.newest() if self._bench is not None else None
        return None if raw is None else _describe_raw(raw)


def _describe_hands(hands: Hands) -> BenchHands:
    return BenchHands(
        fins=[degrees(angle) for angle in hands.fins.angles],
        pose=hands.bench.pose,
        depth_cm=hands.bench.depth * 100,
        lamp=hands.bench.lamp,
        leak=hands.bench.leak,
        multimeter_volts=BATTERY,
        barometer_hpa=BAROMETER / 100,
    )


def _describe_raw(raw: Raw) -> RawReadings:
    fx, fy, fz = (part / GRAVITY for part in raw.force)
    rx, ry, rz = map(degrees, raw.rate)
    return RawReadings(
        encoders=[EncoderReading(counts=counts(word), field=field(word)) for word in raw.encoders],
        imu=ImuRaw(identity=raw.identity, force=(fx, fy, fz), rate=(rx, ry, rz)) if raw.identity else None,
        pressure_hpa=raw.pressure / 100 if raw.pressure else None,
        temperature=raw.temperature if raw.pressure else None,
        battery_volts=raw.battery * BATTERY_VOLTS,
        beacons=BeaconLevels(right=bool(raw.beacons & 1), left=bool(raw.beacons & 2)),
        leak=bool(raw.leak),
    )
