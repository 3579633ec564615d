"""A scenario in simulated time, as fast as possible: the steps of real time, one after the other.

Nothing here looks at the computer's clock, and nothing runs beside it, so that the same scenario and seed
give the same bytes. Before time 0 the board lies powered in still water at the surface for `PRELUDE`, as a
robot does before a dive: it learns the surface's pressure, and is greeted.
"""

import json
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from robot_runtime.commands import Commands
from robot_runtime.contract.commands import ArmCommand, FilmCommand, MissionCommand
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, CraftDocument
from robot_runtime.contract.documents import MISSION_MARK, Event
from robot_runtime.contract.topics import EVENT
from robot_runtime.control.supervisor import ARM_WAIT, Arming
from robot_runtime.core import PUBLISH_EVERY
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.cameras import needs_camera
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.experiments.scenario.events import CommandEvent, LineFaultChange, TimedEvent, WaterEvent
from robot_runtime.experiments.scenario.rig import MakeBoard, ScenarioRig
from robot_runtime.link.link_driver import PERIOD as GATHERING
from robot_runtime.periodic_task import SAME_TIME, PeriodicTask
from robot_runtime.simulation.boards.stepped_board import PERIOD
from robot_runtime.simulation.water.requests import changes

PRELUDE = 2.0
"""s."""
AFTERWARDS = 0.5
"""s after the end for which the robot is watched as it disarms."""
PROGRESS_EVERY = 1.0
"""s of simulated time."""
FILM_RENEWAL = 10.0
"""s of simulated time, as a server renews its order to film."""


class RunListener(Protocol):
    """Receiver of the data and the events of a run; times are s since its start."""

    def blocks(self, data: bytes) -> None:
        """Take the robot's data: blocks one after the other."""
        ...

    def event(self, event: str, **more: Any) -> None:
        """Receive an event of the run: started, progress, marker or ended."""
        ...


class Unheard:
    """The listener of a run of which nothing is kept."""

    def blocks(self, data: bytes) -> None:
        """Take nothing."""

    def event(self, event: str, **more: Any) -> None:
        """Receive nothing."""


class ScenarioRun:
    """One run of a scenario on this kind of board; `perform` runs all of it. `craft` is the robot's."""

    def __init__(
        self,
        scenario: Scenario,
        make_board: MakeBoard,
        listener: RunListener,
        craft: CraftDocument = DEFAULT_DOCUMENT,
    ) -> None:
        self._craft = craft if scenario.craft == "robot" else DEFAULT_DOCUMENT
        self._scenario = scenario
        self._make_board = make_board
        self._listener = listener
        self._run_loop: RunLoop | None = None
        self._cancelled = False

    def cancel(self) -> None:
        """End `perform` soon, in order; may be called from a signal handler."""
        self._cancelled = True

    def perform(self, describe: Callable[[bytes], Mapping[str, str]]) -> None:
        """Run the whole scenario. `describe` returns the board's program for the start event.

        Raise BoardError where there is no board, or it goes away.
        """
        with ScenarioRig(self._scenario, self._make_board, self._send, PRELUDE, self._craft) as rig:
            run_loop = RunLoop(rig, self._listener, lambda: self._cancelled)
            run_loop.wait_for_start()
            self._listener.event("started", time=0.0, **describe(rig.board.firmware))
            self._run_loop = run_loop
            run_loop.play()
            run_loop.finish(cancelled=self._cancelled)

    def _send(self, data: bytes) -> None:
        if self._run_loop is not None:
            self._listener.blocks(data)


class RunLoop:
    """The loop that advances the rig from the prelude on; `stopped` returns True to end early."""

    def __init__(self, rig: ScenarioRig, listener: RunListener, stopped: Callable[[], bool]) -> None:
        self._rig = rig
        self._listener = listener
        self._stopped = stopped
        self._commands = Commands(rig.robot)
        self._changes = changes(rig.simulator)
        self._remarks: list[str] = []
        self._arming: tuple[Arming, TimedEvent] | None = None
        self._next_attempt = 0.0
        self._received = b""
        self._next_poll = now = rig.clock.now()
        self._tasks = [
            PeriodicTask(now, 1 / rig.scenario.control.rate, rig.robot.control_tick),
            PeriodicTask(now, PUBLISH_EVERY, rig.robot.publish_tick),
        ]
        self._has_camera = needs_camera(rig.scenario)
        rig.robot.bus.on_document(EVENT, self._see_event)

    def wait_for_start(self) -> None:
        """Run the prelude."""
        self.advance(0.0)
        robot = self._rig.robot
        robot.outbox.flush()
        robot.announce()
        self._tasks.append(PeriodicTask(0.0, PROGRESS_EVERY, self._report_progress))
        if self._rig.scenario.vision.film:
            self._tasks.append(PeriodicTask(0.0, FILM_RENEWAL, self._film))

    def play(self) -> None:
        """Run all events, until the end or until it is stopped."""
        scenario = self._rig.scenario
        for event in scenario.events:
            self.advance(event.at)
            if self._stopped():
                return
            self.run_event(event)
        self.advance(scenario.duration)

    def finish(self, *, cancelled: bool) -> None:
        """Disarm the robot and report how the run ended."""
        robot, clock = self._rig.robot, self._rig.clock
        if robot.supervisor.armed:
            robot.supervisor.stop(f"The scenario {'was cancelled' if cancelled else 'ended'}.")
        self._stopped = lambda: False
        self.advance(clock.now() + AFTERWARDS)
        self._receive_bytes()
        robot.publish_tick()
        self._listener.event(
            "ended",
            time=_round_time(clock.now()),
            state="cancelled" if cancelled else "complete",
            problem=" ".join(self._remarks) or None,
        )

    def advance(self, end: float) -> None:
        """Advance the time to `end` (s since the start), or until it is stopped."""
        rig = self._rig
        while (now := rig.clock.now()) < end - SAME_TIME and not self._stopped():
            self._poll_link(now)
            for task in self._tasks:
                task.run_if_due(now)
            due = [end, self._next_poll, rig.robot.pilot_tick(), *(task.due for task in self._tasks)]
            if self._arming is not None:
                self._continue_arming(now)
                due.append(self._next_attempt)
            if self._has_camera and now > -SAME_TIME:
                due.append(now + rig.robot.vision.tick())
            periods = max(round((min(due) - now) / PERIOD), 1)
            self._received += rig.run(periods)

    def _poll_link(self, now: float) -> None:
        """Do the work of the link's thread: collect bytes, handle them, send what is due."""
        line = self._rig.robot.link
        if now < self._next_poll - SAME_TIME and (line.gathering or not self._received):
            return
        self._receive_bytes()
        line.poll()
        # On a line where bytes may arrive at any time, every step reads.
        self._next_poll = now + (GATHERING if line.gathering else min(line.wait(), PERIOD))

    def _receive_bytes(self) -> None:
        if self._received:
            heard, self._received = self._received, b""
            self._rig.robot.link.receive(heard)

    def run_event(self, event: TimedEvent) -> None:
        """Make an event happen now; a refusal is a remark, and a bookmark."""
        now = self._rig.clock.now()
        try:
            self._do(event, now)
        except (RefusedError, ValueError) as problem:
            self._refuse(event, str(problem))
        else:
            if not _arms(event):
                self._add_bookmark(event.label)

    def _do(self, event: TimedEvent, now: float) -> None:
        rig = self._rig
        if isinstance(event, CommandEvent) and isinstance(command := event.command, ArmCommand):
            arming = rig.robot.supervisor.begin_arming(command.mode, command.alone, command.unwatched)
            self._arming = arming, event
            self._next_attempt = now + ARM_WAIT
        elif isinstance(event, CommandEvent) and isinstance(command := event.command, MissionCommand):
            self._arming = self._commands.begin_mission(command), event
            self._next_attempt = now + ARM_WAIT
        elif isinstance(event, CommandEvent):
            self._commands.perform(event.command)
        elif isinstance(event, LineFaultChange):
            rig.board.line(event.command)
        elif isinstance(event, WaterEvent):
            # As it comes to the simulator's process in JSON, where there are no tuples.
            self._changes[event.do](json.loads(json.dumps(event.question)))
            rig.break_devices()

    def _continue_arming(self, now: float) -> None:
        assert self._arming is not None
        arming, event = self._arming
        supervisor = self._rig.robot.supervisor
        if not arming.over and (supervisor.board_armed or now >= self._next_attempt - SAME_TIME):
            self._next_attempt = now + ARM_WAIT
            supervisor.continue_arming()
        if arming.over:
            self._arming = None
            if arming.refusal:
                self._refuse(event, arming.refusal)
            else:
                self._add_bookmark(event.label)

    def _refuse(self, event: TimedEvent, problem: str) -> None:
        # A refusal does not end the experiment, as with an operator.
        text = f"{event.label}: refused. {problem}"
        self._remarks.append(f"At {event.at:g} s: {text}")
        self._add_bookmark(text)

    def _see_event(self, event: Event) -> None:
        if event.kind == MISSION_MARK:
            self._add_bookmark(event.text)

    def _add_bookmark(self, text: str) -> None:
        self._listener.event("marker", time=_round_time(self._rig.clock.now()), text=text)

    def _film(self) -> None:
        self._rig.robot.vision.film(FilmCommand(seconds=2 * FILM_RENEWAL))

    def _report_progress(self) -> None:
        self._listener.event("progress", time=_round_time(self._rig.clock.now()))


def _arms(event: TimedEvent) -> bool:
    return isinstance(event, CommandEvent) and isinstance(event.command, ArmCommand | MissionCommand)


def _round_time(time: float) -> float:
    return round(time, 6)
