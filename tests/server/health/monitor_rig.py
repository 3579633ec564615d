"""A health monitor with processes whose state the test sets."""

from typing import Any

from robot_runtime.clock import SimulatedClock
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.logs import ProcessLog
from server.processes.managed_process import ManagedProcess, ProcessCommand
from tests.server.blocks import link_block, state_block, truth_block


class MonitorRig:
    """A health monitor, and processes with a settable state."""

    def __init__(self, settings: Settings, store: Store, *names: str) -> None:
        self.clock = SimulatedClock(1000.0)
        self.parts = {
            name: ManagedProcess(
                ProcessCommand(name, name, ()),
                ProcessLog(settings.data.logs),
                settings.data.run,
                self.clock,
                lambda *_: None,
            )
            for name in names
        }
        self.monitor = HealthMonitor(settings, self.clock, store, self.parts)  # type: ignore[arg-type]

    def run_all(self) -> None:
        for part in self.parts.values():
            part._set("running")

    def receive(self, number: int, **state: Any) -> None:
        """Feed everything that arrives while all is well."""
        for block in (
            state_block(number, **state),
            link_block(number, 100 * number + 1),
            truth_block(number),
        ):
            self.monitor.see(block)

    def state(self, name: str) -> str:
        return next(part.state for part in self.monitor.health().parts if part.name == name)

    def text(self, name: str) -> str:
        return next(part.text for part in self.monitor.health().parts if part.name == name)

    @property
    def status(self) -> str:
        return self.monitor.health().status
