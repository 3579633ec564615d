"""Experiments on the depth: a step and a relay, on a robot in simulated water, and their ends."""

import re
from typing import Any

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.commands import RelayExperimentCommand, StepExperimentCommand
from robot_runtime.contract.documents import Experiment, State
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.topics import EXPERIMENT, STATE
from robot_runtime.control.experiments import RelayExperiment, StepExperiment
from robot_runtime.errors import RefusedError
from tests.runtime.control.flight import Flight

STEP: dict[str, Any] = {
    "number": 3,
    "kind": "step",
    "loop": "depth",
    "start": 0.4,
    "target": 0.7,
    "tolerance": 0.03,
    "settle": 20.0,
    "duration": 6.0,
    "low": 0.0,
    "high": 1.2,
}
RELAY: dict[str, Any] = {
    "number": 4,
    "kind": "relay",
    "loop": "depth",
    "set_point": 0.6,
    "amplitude": 0.5,
    "hysteresis": 0.01,
    "cycles": 3,
    "duration": 120.0,
    "low": 0.0,
    "high": 1.2,
}


def begin(flight: Flight, request: dict[str, Any]) -> None:
    kind, fields = request["kind"], {name: value for name, value in request.items() if name != "kind"}
    flight.command(f"{kind}_experiment", **fields)


class LoopLab:
    """A flight with its published experiments."""

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        self.published: list[Experiment] = []
        self.set_points: list[float] = []
        """The depth's, as the newest state has it at each word of the experiment."""
        self._state: State | None = None
        flight.robot.bus.on_document(EXPERIMENT, self._hear)
        flight.robot.bus.on_document(STATE, self._hear_state)

    def begin(self, request: dict[str, Any]) -> None:
        begin(self.flight, request)

    def until_over(self, limit: float) -> Experiment:
        self.flight.until(lambda: bool(self.published) and self.published[-1].phase in OVER, limit)
        return self.published[-1]

    def phases(self) -> list[str]:
        return list(dict.fromkeys(document.phase for document in self.published))

    def _hear(self, document: object) -> None:
        assert isinstance(document, Experiment)
        self.published.append(document)
        assert self._state is not None
        self.set_points.append(self._state.loops[0].set_point)

    def _hear_state(self, document: object) -> None:
        assert isinstance(document, State)
        self._state = document


OVER = ("complete", "stopped", "failed")


def test_a_step_begins_once_settled_and_restores_everything() -> None:
    with Flight() as flight:
        lab = LoopLab(flight)
        flight.arm()
        lab.begin(STEP)
        end = lab.until_over(30.0)
        assert (end.number, end.kind, end.loop, end.phase, end.text) == (3, "step", "depth", "complete", "")
        assert lab.phases() == ["settling", "running", "complete"]
        began = next(document.since for document in lab.published if document.phase == "running")
        assert end.since - began == pytest.approx(6.0, abs=0.11)
        progress = [document.progress for document in lab.published]
        assert progress == sorted(progress)
        assert lab.set_points[-2:] == [STEP["target"], 0.6]
        flight.run(0.2)
        assert flight.robot.control.depth.set_point_in_force == 0.6
        assert flight.robot.control.depth.override is None


def test_a_start_that_never_settles_is_given_up_after_its_time_limit() -> None:
    expected = StepExperimentCommand(
        number=1,
        loop="depth",
        start=0.4,
        target=0.7,
        tolerance=0.01,
        settle=5.0,
        duration=2.0,
        low=0.0,
        high=1.0,
    )
    clock = SimulatedClock(10.0)
    experiment = StepExperiment(expected, clock)
    set_points = []
    for tick in range(60):
        experiment.observe(0.4 + 0.05 * (-1) ** tick)
        set_points.append(experiment.override.set_point)
        clock.forward(0.1)
    assert set_points.index(0.7) == pytest.approx(50, abs=1)


def test_a_relay_finds_the_load_and_a_steady_cycle() -> None:
    with Flight() as flight:
        lab = LoopLab(flight)
        flight.arm()
        lab.begin(RELAY)
        end = lab.until_over(120.0)
        assert end.phase == "complete", end.text
        assert lab.phases() == ["settling", "balancing", "running", "complete"]
        assert end.cycles == 3
        # The robot is buoyant: to stay it has to push down.
        assert 0.05 < end.bias < 0.3
        flight.run(0.2)
        assert abs(flight.sent[-1][1].z) < 1.0


@pytest.mark.parametrize("load", [-0.2, 0.0, 0.15])
def test_the_bias_of_a_relay_is_the_load(load: float) -> None:
    """An integrator with friction and a constant load, with a known solution."""
    expected = RelayExperimentCommand(
        number=1,
        loop="depth",
        set_point=1.0,
        amplitude=0.4,
        hysteresis=0.005,
        cycles=4,
        duration=300.0,
        low=0.0,
        high=2.0,
    )
    clock = SimulatedClock(0.0)
    experiment = RelayExperiment(expected, clock)
    position, speed = 0.9, 0.0
    while not experiment.over:
        experiment.observe(position)
        output = experiment.command(1.0 - position)
        for _ in range(10):
            speed += 0.005 * (output - load - 2.0 * speed)
            position += 0.005 * speed
        clock.forward(0.05)
    assert (experiment.phase, experiment.text) == ("complete", "")
    assert experiment.bias == pytest.approx(load, abs=0.4 * 0.1)


@pytest.mark.parametrize(
    ("end", "phase", "text"),
    [
        (lambda flight: flight.command("stop"), "stopped", "The robot was disarmed."),
        (lambda flight: flight.command("mode", mode="manual"), "stopped", "The pilot took over."),
        (lambda flight: flight.command("end_experiment"), "stopped", "It was stopped."),
        (lambda flight: flight.cut(on=True), "stopped", "stopped for a fault"),
    ],
)
def test_any_end_of_steering_ends_the_experiment(end: Any, phase: str, text: str) -> None:
    with Flight() as flight:
        lab = LoopLab(flight)
        flight.arm()
        lab.begin(STEP)
        flight.run(3.0)
        end(flight)
        over = lab.until_over(2.0)
        assert over.phase == phase
        assert text in over.text
        flight.run(0.5)
        assert lab.published[-1] is over


def test_it_ends_beyond_its_limits() -> None:
    with Flight() as flight:
        lab = LoopLab(flight)
        flight.arm()
        lab.begin(RELAY | {"amplitude": 1.0, "high": 0.65, "set_point": 0.6, "hysteresis": 0.05})
        over = lab.until_over(30.0)
        assert over.phase == "failed"
        assert over.text.endswith("m, which is beyond the limits, 0 m to 0.65 m.")


TILT: dict[str, Any] = {
    name: value
    for name, value in (
        STEP | {"loop": "pitch", "start": 0.0, "target": 0.2, "low": -0.4, "high": 0.4}
    ).items()
    if name != "kind"
}


def test_an_experiment_on_an_angle_speaks_in_degrees() -> None:
    experiment = StepExperiment(StepExperimentCommand(**TILT), SimulatedClock())
    for value in (0.0, 0.5):
        experiment.observe(value)
    assert experiment.text == (
        "It ended at 28.6° (0.5 rad), which is beyond the limits, -22.9° (-0.4 rad) to 22.9° (0.4 rad)."
    )
    for wrong, why in (
        ({"start": 0.593}, "start is 34° (0.593 rad); it must lie between -28.6° (-0.5 rad) and 28.6°"),
        ({"target": 0.45}, "target is 25.8° (0.45 rad); it must lie between the limits -22.9°"),
        ({"tolerance": 1.0}, "tolerance is 57.3° (1 rad); it must lie between 0° (0 rad) and 45.8°"),
        ({"low": 0.5}, "low is 28.6° (0.5 rad) and high 22.9° (0.4 rad); the limits must be apart"),
    ):
        with pytest.raises(ConfigError, match=re.escape(why)):
            StepExperimentCommand(**(TILT | wrong))


def test_a_relay_without_cycles_gives_up() -> None:
    with Flight() as flight:
        lab = LoopLab(flight)
        flight.arm()
        lab.begin(RELAY | {"duration": 5.0})
        over = lab.until_over(10.0)
        assert (over.phase, over.text) == ("failed", "There were 0 of 3 cycles within 5 s.")


NAN = float("nan")
WRONG = [
    (STEP | {"loop": "depths"}, "loop is 'depths'; it must be one of"),
    (STEP | {"cycles": 3}, "'cycles' is not known here"),
    (STEP | {"target": NAN}, "target is nan"),
    (STEP | {"target": 11.0, "high": 20.0}, "between 0 m and 10 m"),
    (STEP | {"target": 1.3}, "between the limits"),
    (STEP | {"target": 0.4}, "are the same"),
    (STEP | {"duration": 0.5}, "between 2 and 300"),
    (STEP | {"duration": "long"}, "must be a number"),
    (STEP | {"high": -1.0}, "must be apart"),
    (STEP | {"number": 1.5}, "whole number"),
    (RELAY | {"amplitude": 1.1}, "between 0.1 and 1"),
    (RELAY | {"amplitude": True}, "must be a number"),
    (RELAY | {"cycles": 3.5}, "whole number"),
    (RELAY | {"hysteresis": 0.5}, "hysteresis is 0.5"),
]


def test_an_invalid_experiment_is_refused() -> None:
    with Flight() as flight:
        with pytest.raises(RefusedError, match="The robot is disarmed"):
            begin(flight, STEP)
        flight.arm()
        for expected, why in WRONG:
            with pytest.raises(RefusedError, match=why):
                begin(flight, expected)
        flight.robot.experiments.require_none()


def test_other_changes_are_refused_during_an_experiment() -> None:
    with Flight() as flight:
        flight.arm()
        begin(flight, STEP)
        for name, question in (
            ("step_experiment", {name: value for name, value in STEP.items() if name != "kind"}),
            ("controller", {"name": "bang_bang"}),
            ("loop", {"name": "depth", "gains": {"kp": 1.0}}),
            ("set_points", {"default": 1.0}),
            ("steering", {"by": "beacons"}),
        ):
            with pytest.raises(RefusedError, match="An experiment runs on the depth"):
                flight._commands[name](question)
