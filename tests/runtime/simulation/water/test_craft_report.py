"""The simulator reports the craft that it swims."""

from dataclasses import replace

from robot_runtime.contract.craft import Craft, CraftDocument
from robot_runtime.simulation.water.craft_report import PERIOD, CraftReport
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water.surroundings import Trim

FILE = CraftDocument(title="Turtle 2", origin="weighed", craft=Craft(mass=2.5))


def test_it_is_sent_at_the_start_at_changes_and_every_period() -> None:
    simulator = Simulator(SimulationParameters.of(FILE.craft), seed=1)
    report = CraftReport(simulator, FILE)
    first = report.due(5.0)
    assert first is not None
    assert (first.time, first.title, first.origin, first.craft) == (5.0, "Turtle 2", "weighed", FILE.craft)
    assert report.due(5.0 + PERIOD - 0.1) is None
    assert report.due(5.0 + PERIOD) == replace(first, time=5.0 + PERIOD)
    simulator.set_trim(Trim(buoyancy=1.01, forward=0.001, right=0.0, above=0.02))
    changed = report.due(5.1 + PERIOD)
    assert changed is not None
    assert changed.title == "Turtle 2, changed"
    assert changed.craft == replace(FILE.craft, buoyancy=1.01, buoyancy_forward=0.001, buoyancy_height=0.02)
    simulator.set_trim(Trim.of(FILE.craft))
    assert getattr(report.due(5.2 + PERIOD), "title", None) == "Turtle 2"
