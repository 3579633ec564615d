"""Experiments on the whole robot in simulated time, evaluated by the server's code."""

from typing import Any

from robot_runtime.contract.documents import Control, Experiment
from robot_runtime.contract.packets import Motor
from robot_runtime.contract.topics import CONTROL, EXPERIMENT, MOTOR
from server.features.tuning.curve import SampleBuffer, TuningCurve
from server.features.tuning.evaluation import measure_run
from server.features.tuning.schemas import MeasuredLimitCycle, RelayStart, StepStart
from tests.runtime.control.flight import Flight

ENDED = ("complete", "stopped", "failed")


class TuningRig:
    """One armed flight with several experiments on the depth."""

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        self._gathering = SampleBuffer("depth")
        self._published: list[Experiment] = []
        self.curve = TuningCurve([], [], [], [])
        """Of the last experiment."""
        bus = flight.robot.bus
        bus.on_row(CONTROL, self._tick)
        bus.on_row(MOTOR, self._fins)
        bus.on_document(EXPERIMENT, self._take_progress)
        flight.arm()

    def step(self, start: float, target: float, seconds: float) -> dict[str, float | None]:
        """Return the figures of a step of the set point, from rest at the start."""
        expected = StepStart(
            kind="step",
            start=start,
            target=target,
            tolerance=0.03,
            settle=40.0,
            duration=seconds,
            low=0.0,
            high=2.5,
        )
        return {name: figure["value"] for name, figure in self._run(expected)["figures"].items()}

    def relay(self, amplitude: float, cycles: int = 4) -> MeasuredLimitCycle:
        """Return the limit cycle of a relay about 0.6 m."""
        expected = RelayStart(
            kind="relay",
            set_point=0.6,
            amplitude=amplitude,
            hysteresis=0.01,
            cycles=cycles,
            duration=200.0,
            low=0.0,
            high=2.5,
        )
        return MeasuredLimitCycle(**self._run(expected)["cycle"])

    def use(self, controller: str, gains: dict[str, float]) -> None:
        """Steer the depth by this controller from now on."""
        self.flight.robot.control.set_loop("depth", controller=controller, gains=gains)

    def _run(self, expected: StepStart | RelayStart) -> dict[str, Any]:
        self._gathering, self._published = SampleBuffer("depth"), []
        command = expected.command(1)
        self.flight.command(command.policy.name, **command.payload())
        self.flight.until(lambda: bool(self._published) and self._published[-1].phase in ENDED, 250.0)
        starts: dict[str, float] = {}
        for message in self._published:
            starts.setdefault(message.phase, message.since)
        end = self._published[-1]
        assert end.phase == "complete", end.text
        result, self.curve, problem = measure_run(expected, self._gathering, starts, "complete", "")
        assert problem == ""
        return result

    def _tick(self, time: float, record: bytes) -> None:
        tick = Control.from_bytes(record)
        self._gathering.curve.add(time, tick.set_point, tick.depth, tick.output)

    def _fins(self, time: float, record: bytes) -> None:
        self._gathering.fin_times.append(time)
        for stored, angle in zip(self._gathering.fins, Motor.from_bytes(record).angle, strict=True):
            stored.append(angle)

    def _take_progress(self, document: object) -> None:
        assert isinstance(document, Experiment)
        self._published.append(document)
