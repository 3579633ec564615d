"""A mission runner in simulated time without a board; the test sets what the robot measures and its mode."""

from collections.abc import Callable

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Event, Mission, Mode
from robot_runtime.contract.missions import NO_LIMITS
from robot_runtime.generate.reference import make_core
from robot_runtime.missions.document import read_mission
from robot_runtime.missions.node import LoadedMission, MissionRunner
from robot_runtime.missions.senses import MissionSenses

TICK = 0.1
"""s between two ticks of the control loop."""


class SetSenses(MissionSenses):
    """Readings that the test sets."""

    measured = 0.6
    look: Callable[[str], bool] = staticmethod(lambda _: False)

    @property
    def depth(self) -> float:
        """m."""
        return self.measured

    @property
    def heading(self) -> float:
        """rad."""
        return 0.0

    def sees(self, what: str) -> bool:
        """Return True if the test shows it."""
        return self.look(what)


class MissionRig:
    """A runner of missions with its documents, events and stops."""

    def __init__(self, senses: type[SetSenses] = SetSenses) -> None:
        self.clock = SimulatedClock()
        self.core = core = make_core(self.clock)
        self.senses = senses(core.bus, self.clock, core.control, core.supervisor.detector, core.vision)
        self.documents: list[Mission] = []
        self.events: list[Event] = []
        self.stops: list[str] = []
        self.runner = MissionRunner(
            self.clock,
            NO_LIMITS,
            self.senses,
            core.parameters,
            self.stops.append,
            self.documents.append,
            self.events.append,
        )

    @property
    def last(self) -> Mission:
        """The newest document."""
        return self.documents[-1]

    def prepare(self, text: str) -> None:
        """Have a mission begin with the next tick."""
        self.runner.prepare(LoadedMission(read_mission(text), text))

    def tick(self, seconds: float = TICK, mode: Mode = "automatic") -> None:
        """Tick the mission for this time."""
        for _ in range(round(seconds / TICK)):
            self.runner.tick(mode)
            self.clock.forward(TICK)

    def swim(self, text: str) -> Mission:
        """Tick a mission until it ends; return its last document."""
        self.prepare(text)
        while self.runner.active:
            self.tick()
        return self.last

    def status(self, path: str) -> str:
        """Return the status of a step in the newest document."""
        return next(step.status for step in self.last.steps if step.path == path)
