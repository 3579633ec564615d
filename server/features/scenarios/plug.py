"""The plug of scenarios."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from robot_runtime.experiments.scenario.document import read_scenario
from server.driving.changes import Changes
from server.driving.simulated_starts import SimulatedStarts
from server.feature import Plug
from server.features.scenarios.live_run import LiveExecutor
from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.simulated_run import SimulatedExecutor
from server.health.monitor import HealthMonitor
from server.health.occupation import Occupation
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.supervisor import ProcessSupervisor
from server.recording.recorder import Recorder
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.hub import Hub


def make_live(
    settings: Settings,
    store: Store,
    recorder: Recorder,
    bridge: Bridge,
    changes: Changes,
    monitor: HealthMonitor,
    processes: ProcessSupervisor,
    clock: Clock,
    notices: Notices,
) -> LiveExecutor:
    """Return the executor of scenarios on the robot."""
    return LiveExecutor(settings, store, recorder, bridge, changes, monitor, processes, clock, notices.notify)


def make_scenarios(live: LiveExecutor, simulated: SimulatedExecutor, hub: Hub) -> ScenarioRunner:
    """Return the runner of scenarios."""
    return ScenarioRunner(live, simulated, hub.notify)


class ScenariosPlug(Plug):
    """The plug that ends a scenario on the robot at a STOP."""

    makers: ClassVar[tuple[Maker, ...]] = (make_live, make_scenarios)

    def __init__(
        self,
        scenarios: ScenarioRunner,
        live: LiveExecutor,
        bridge: Bridge,
        occupation: Occupation,
        starts: SimulatedStarts,
        settings: Settings,
    ) -> None:
        self._scenarios = scenarios
        self._live = live
        self._settings = settings
        starts.provide(self._start_simulated)
        bridge.on_stop.append(scenarios.see_stop)
        occupation.robot.append(self._explain)

    async def start(self) -> None:
        """Send the state to the pages."""
        self._scenarios.announce()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Clean up after a killed server."""
        return (self._live.recover(),)

    async def stop(self) -> None:
        """Cancel the running work."""
        await self._scenarios.close()

    def _start_simulated(self, text: str, who: str) -> str:
        scenario = read_scenario(text, self._settings.read_craft())
        return self._scenarios.start(scenario, text, "simulated", "host", who)

    def _explain(self) -> str | None:
        run = self._scenarios.active
        if run is None or run.place != "live":
            return None
        return f"The scenario “{run.scenario.title}” is being run. Cancel it first."
