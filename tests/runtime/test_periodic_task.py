"""A periodic task by a simulated clock."""

from robot_runtime.clock import SimulatedClock
from robot_runtime.periodic_task import PeriodicTask

PERIOD = 0.1


class SleepingLoop:
    """A loop that sleeps until the task is due; some sleeps and some ticks take longer (s)."""

    def __init__(
        self, *, oversleeps: dict[int, float] | None = None, long: dict[int, float] | None = None
    ) -> None:
        self.clock = SimulatedClock()
        self.ticks: list[float] = []
        self._oversleeps = oversleeps or {}
        self._long = long or {}
        self._task = PeriodicTask(PERIOD, PERIOD, self._tick)

    def run(self, seconds: float) -> list[float]:
        """Return when each tick began, in ms."""
        while self._task.due < seconds:
            late = self._oversleeps.get(len(self.ticks), 0.0)
            self.clock.forward(max(self._task.due - self.clock.now(), 0.0) + late)
            self._task.run_if_due(self.clock.now())
        return [round(1000 * at) for at in self.ticks]

    def _tick(self) -> None:
        self.ticks.append(self.clock.now())
        self.clock.forward(self._long.get(len(self.ticks) - 1, 0.0))


def test_it_runs_once_per_period_from_its_start_on() -> None:
    assert SleepingLoop().run(100.05) == [100 * tick for tick in range(1, 1001)]


def test_a_late_run_does_not_move_the_next_ones() -> None:
    late = SleepingLoop(oversleeps={2: 0.03, 4: 0.099})
    assert late.run(0.75) == [100, 200, 330, 400, 599, 600, 700]


def test_periods_that_passed_as_a_whole_are_not_made_up_for() -> None:
    assert SleepingLoop(oversleeps={1: 0.35}).run(0.9) == [100, 550, 650, 750, 850]
    assert SleepingLoop(long={1: 0.35}).run(0.9) == [100, 200, 550, 650, 750, 850]


def test_it_does_not_run_before_it_is_due() -> None:
    ran: list[float] = []
    task = PeriodicTask(1.0, PERIOD, lambda: ran.append(1.0))
    task.run_if_due(0.999)
    assert ran == []
    task.run_if_due(1.0)
    assert len(ran) == 1
