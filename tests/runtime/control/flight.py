"""The whole robot in simulated time, with firmware and water; the test is the operator."""

import json
from collections.abc import Callable
from typing import Any, Self

from robot_runtime.commands import Commands
from robot_runtime.contract.documents import Event, Mode
from robot_runtime.contract.packets import Navigation
from robot_runtime.contract.topics import EVENT, NAVIGATION
from robot_runtime.control_step import ControlStep
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.rig import MakeBoard, ScenarioRig
from robot_runtime.experiments.scenario.run import PRELUDE, RunLoop
from robot_runtime.link.serial_link import HEARTBEAT_EARLY
from robot_runtime.periodic_task import SAME_TIME
from robot_runtime.simulation.water.requests import changes
from tests.runtime.experiments.scenario.staging import Output, document

STEP = 0.02
"""s, in which what the test does between two looks falls."""
PUSH_EVERY = 0.05
"""s between two inputs of the pilot's."""


class _StepLoop(RunLoop):
    """The loop of a robot that hears its board in step with control."""

    def __init__(self, rig: ScenarioRig) -> None:
        super().__init__(rig, Output(), lambda: False)
        self._step = ControlStep(rig.robot, self._receive)
        self._tasks.clear()

    def _poll_link(self, now: float) -> None:
        robot = self._rig.robot
        if now >= self._step.due - SAME_TIME:
            robot.missions.see_pages(1)
            self._step.run()
            robot.link.poll(HEARTBEAT_EARLY)
        if robot.link.gathering:
            self._next_poll = self._step.due
        else:
            super()._poll_link(now)
            self._next_poll = min(self._next_poll, self._step.due)

    def _receive(self, wait: float) -> bool:
        if not self._rig.robot.link.gathering:
            return False
        if wait > 0:
            self._received += self._rig.run(1)
        self._receive_bytes()
        return True


class Flight:
    """A flight that begins when all is well; `sticks`, if any, are sent every 0.05 s.

    `in_step` the robot hears its board once a control tick, as in the lean profile.
    """

    def __init__(self, board: str | MakeBoard = "host", more: str = "", *, in_step: bool = False) -> None:
        make = boards()[board] if isinstance(board, str) else board
        self.stage = ScenarioRig(read_scenario(document(3600, more=more)), make, lambda _: None, PRELUDE)
        self.robot, self.clock = self.stage.robot, self.stage.clock
        self.supervisor, self.board = self.robot.supervisor, self.stage.board
        self.events: list[Event] = []
        self.sent: list[tuple[float, Navigation]] = []
        self.sticks: list[float] | None = None
        self.server = self.watched = True
        self._sequence = 0
        self._commands = Commands(self.robot).do
        self._water = changes(self.stage.simulator)
        self._performance = _StepLoop(self.stage) if in_step else RunLoop(self.stage, Output(), lambda: False)
        self.robot.bus.on_document(EVENT, self._hear)
        self.robot.bus.on_row(
            NAVIGATION, lambda time, record: self.sent.append((time, Navigation.from_bytes(record)))
        )
        self._performance.wait_for_start()
        self.run(0.5)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stage.__exit__()

    @property
    def now(self) -> float:
        return self.clock.now()

    def run(self, seconds: float) -> None:
        """Run for this time."""
        end = self.now + seconds
        while self.now < end - 1e-6:
            if self.server:
                self.supervisor.detector.see_server(watched=self.watched)
            if self.sticks is not None and self._sequence * PUSH_EVERY <= self.now:
                self.push(self.sticks)
            self._performance.advance(min(self.now + STEP, end))

    def until(self, holds: Callable[[], bool], limit: float) -> float:
        """Run until the condition holds; return the s that it took. Fails beyond the limit."""
        began = self.now
        while not holds():
            assert self.now - began <= limit + 1e-6, f"not within {limit} s: {self.supervisor.mode}"
            self.run(STEP)
        return self.now - began

    def push(self, axes: list[float], **more: Any) -> None:
        """A pilot's input, as the server passes it on."""
        self._sequence = int(self.now / PUSH_EVERY) + 1
        text = {"lease": 0, "sequence": self._sequence, "taken": self.now, "axes": axes} | more
        self.robot.take_pilot(json.dumps(text).encode())

    def arm(self, mode: Mode = "automatic", alone: float = 0.0, unwatched: float | None = None) -> None:
        arming = self.supervisor.begin_arming(mode, alone, unwatched)
        while not arming.over:
            self.run(0.1)
            self.supervisor.continue_arming()
        assert arming.refusal == ""

    def command(self, name: str, **question: Any) -> None:
        self._commands[name](question)

    def break_(self, sensor: str, kind: str, **more: float) -> None:
        self._water["fault"]({"sensor": sensor, "kind": kind} | more)
        self.stage.break_devices()

    def water(self, what: str, **question: Any) -> None:
        self._water[what](question)

    def cut(self, *, on: bool) -> None:
        for way in ("to_board", "from_board"):
            self.board.line(f"line {way} cut {'on' if on else 'off'}")

    def alarm(self, fault: str) -> bool:
        """Return True if this alarm is active."""
        return any(alarm.fault == fault and alarm.active for alarm in self.supervisor.alarms)

    def _hear(self, document: object) -> None:
        assert isinstance(document, Event)
        self.events.append(document)
