"""A scenario whose robot a program steers as its pilot, step by step, in simulated time."""

import json
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from robot_runtime.contract.commands import ArmCommand, SetPointsCommand
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, CraftDocument
from robot_runtime.contract.documents import Truth
from robot_runtime.contract.packets import Depth, Fins, Imu, Motor, Quaternion
from robot_runtime.contract.topics import DEPTH, IMU, MOTOR
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.experiments.scenario.events import CommandEvent, LineFaultChange, TimedEvent, WaterEvent
from robot_runtime.experiments.scenario.rig import MakeBoard, ScenarioRig
from robot_runtime.experiments.scenario.run import PRELUDE, RunLoop, Unheard
from robot_runtime.simulation.water.parameters import Vector

ARMING = 0.5
"""s since the scenario's start at which the robot is armed: it has felt the water for long enough then."""
START = 1.0
"""s since the scenario's start at which the first step begins."""
STEP = 0.1
"""s of a step: a tick of the control loop, and half of the time for which a pilot's input counts."""


class EpisodeError(Exception):
    """The scenario's robot could not be armed; the text says why."""


class EpisodeState(NamedTuple):
    """The robot at the end of a step: its newest measurements in SI units, and the truth."""

    time: float
    """s since the scenario's start."""
    set_point: float
    """m; the depth to hold."""
    depth: float
    attitude: Quaternion
    rate: Vector
    force: Vector
    fins: Fins
    truth: Truth


class Episode:
    """A run of this scenario whose robot is armed in manual before `START`; it ends by `close`.

    Of the scenario's events those of the water, the line and the depth to hold happen; its other commands are
    the program's part. Raises BoardError where there is no board, EpisodeError where the robot does not arm.
    """

    def __init__(
        self, scenario: Scenario, make_board: MakeBoard, craft: CraftDocument = DEFAULT_DOCUMENT
    ) -> None:
        own = craft if scenario.craft == "robot" else DEFAULT_DOCUMENT
        self._scenario = scenario
        self._events = [event for event in reversed(scenario.events) if _happens(event)]
        self._rig = ScenarioRig(scenario, make_board, lambda _: None, PRELUDE, own)
        self._robot = self._rig.robot
        self._loop = RunLoop(self._rig, Unheard(), lambda: False)
        self._rows: dict[str, bytes] = {}
        for topic in (DEPTH, IMU, MOTOR):
            self._robot.bus.on_row(topic, partial(self._keep, topic.name))
        self._steps = 0
        try:
            self._begin()
        except Exception:
            self.close()
            raise

    @property
    def complete(self) -> bool:
        """True once the scenario's duration is over."""
        return self._now >= self._scenario.duration - STEP / 2

    @property
    def stopped(self) -> str:
        """The faults for which the robot stopped itself, in words; empty while it is armed."""
        supervisor = self._robot.supervisor
        if supervisor.armed:
            return ""
        return " ".join(alarm.what for alarm in supervisor.alarms) or "The robot is disarmed."

    def step(self, axes: Sequence[float]) -> EpisodeState:
        """Hold the sticks for a `STEP`; return the state at its end.

        `axes`: shares of the greatest force forwards, to the right and down, and of the greatest torque about
        these axes, each from -1 to 1. Raise BoardError where the board goes away.
        """
        self._steps += 1
        sticks = {"lease": 0, "sequence": self._steps, "taken": self._rig.clock.now(), "axes": [*axes]}
        self._robot.take_pilot(json.dumps(sticks).encode())
        self._advance(self._now)
        return self.state()

    def state(self) -> EpisodeState:
        """Return the state now."""
        depth, imu = Depth.from_bytes(self._rows[DEPTH.name]), Imu.from_bytes(self._rows[IMU.name])
        return EpisodeState(
            time=self._now,
            set_point=self._robot.control.set_point_default,
            depth=depth.depth,
            attitude=imu.attitude,
            rate=imu.rate,
            force=imu.force,
            fins=Motor.from_bytes(self._rows[MOTOR.name]).angle,
            truth=self._rig.simulator.truth(),
        )

    def close(self) -> None:
        """End the board."""
        self._rig.__exit__()

    @property
    def _now(self) -> float:
        # Not a sum of many small numbers.
        return round(START + self._steps * STEP, 6)

    def _begin(self) -> None:
        self._loop.wait_for_start()
        self._advance(ARMING)
        self._loop.run_event(CommandEvent(at=ARMING, command=ArmCommand(mode="manual", unwatched=0.0)))
        self._advance(START)
        if not self._robot.supervisor.armed:
            problems = self._robot.supervisor.refusals()
            raise EpisodeError(f"The robot is not armed {START:g} s after the start. {' '.join(problems)}")

    def _advance(self, end: float) -> None:
        """Advance the time to `end`, with the events until then."""
        while self._events and self._events[-1].at < end:
            event = self._events.pop()
            self._loop.advance(event.at)
            self._loop.run_event(event)
        self._loop.advance(end)

    def _keep(self, name: str, _: float, record: bytes) -> None:
        self._rows[name] = record


def _happens(event: TimedEvent) -> bool:
    if isinstance(event, CommandEvent):
        return isinstance(event.command, SetPointsCommand)
    return isinstance(event, WaterEvent | LineFaultChange)
