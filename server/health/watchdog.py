"""Checks the robot's processes and disk four times a second, and raises the server's alarms."""

import asyncio
import shutil
from collections.abc import Callable
from math import inf

from robot_runtime.clock import Clock
from robot_runtime.control.alarms import Alarms
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.platform.store import Store
from server.platform.supply_voltage import UNDERVOLTAGE_NOW, UNDERVOLTAGE_SINCE, read_throttled
from server.processes.supervisor import ProcessSupervisor

PERIOD = 0.25
SILENT_SECONDS = 1.5
"""The runtime sends its state every second, if nothing else; the water sends 20 times as often."""
HUNG_SECONDS = 10.0
"""Silence of a running runtime after which it is killed; the board has disarmed long before that."""
STARTING_SECONDS = 10.0
"""Permitted silence of a process that has just started; a Raspberry Pi Zero is slow."""
DISK_LOW_BYTES = 500_000_000
DISK_LOW_SHARE = 0.05
"""The alarm limit is the smaller of both: hours of recording, less on a small disk."""
SUPPLY_SECONDS = 2.0
"""Interval of looks at the supply, which ask the Raspberry Pi's firmware."""
DISK_WELL = 1.2
"""Times the limit that must be free for the alarm to end, so that a file that comes and goes is one alarm."""
DOWN = {name: f"{name}_down" for name in ("runtime", "board", "simulator", "scene")}
"""The alarms of ended processes."""


class Watchdog:
    """Watchdog that raises and clears alarms, and ends a runtime that hangs."""

    def __init__(
        self,
        settings: Settings,
        clock: Clock,
        monitor: HealthMonitor,
        processes: ProcessSupervisor,
        store: Store,
        alarms: Alarms,
        throttled: Callable[[], int | None] = read_throttled,
    ) -> None:
        self._settings = settings
        self._clock = clock
        self._monitor = monitor
        self._processes = processes
        self._store = store
        self._alarms = alarms
        self._throttled = throttled
        self._supply: int | None = None
        self._supply_seen = -inf
        self._checked = clock.now()
        self._is_disk_low = False
        self._silent = 0.0
        """s; for which this server, itself awake, has heard nothing of the runtime, beyond what is normal."""

    async def run(self) -> None:
        """Check every `PERIOD`, for ever."""
        while True:
            self.check_once()
            await asyncio.sleep(PERIOD)

    def check_once(self) -> None:
        """Check once, now."""
        previous, self._checked = self._checked, self._clock.now()
        if self._checked - previous > SILENT_SECONDS / 2:
            # A stalled server has received nothing either.
            return
        see = self._alarms.see
        for name, fault in DOWN.items():
            process = self._processes.get(name)
            see(fault, process is not None and process.state == "failed")
        see("runtime_silent", silent := self._is_silent("runtime"))
        self._silent = self._silent + self._checked - previous if silent else 0.0
        runtime = self._processes.get("runtime")
        if runtime is not None and self._silent > HUNG_SECONDS - SILENT_SECONDS:
            self._silent = 0.0
            runtime.end_hung(f"said nothing for {HUNG_SECONDS:g} s, and was ended")
        see("simulator_silent", self._does_water_stand())
        disk_there = self._look_at_disk()
        see("disk_low", self._is_disk_low)
        see("store_failing", self._store.failing is not None or not disk_there)
        see("configuration_damaged", bool(problem := self._settings.configuration_problem), problem)
        if self._checked - self._supply_seen >= SUPPLY_SECONDS:
            see("undervoltage", self._is_supply_low())
        see("server_restarted", False)

    def _does_water_stand(self) -> bool:
        """Return True if the simulator is silent and the runtime has no alarm of it: one fault, one alarm."""
        if self._settings.robot.mode == "robot" or not self._is_silent("simulator"):
            return False
        listed = (self._monitor.state() or {}).get("alarms", []) if self._monitor.silence() is None else []
        return not any(alarm["fault"] == "simulator_silent" and alarm["active"] for alarm in listed)

    def _look_at_disk(self) -> bool:
        """Update the alarm of an almost full disk; return False where the disk is gone (a pulled stick)."""
        try:
            disk = shutil.disk_usage(self._settings.data.path)
        except OSError:
            return False
        limit = min(DISK_LOW_BYTES, DISK_LOW_SHARE * disk.total)
        self._is_disk_low = disk.free < (DISK_WELL * limit if self._is_disk_low else limit)
        return True

    def _is_supply_low(self) -> bool:
        """Return True where the supply is too low now, or was too low since the last check."""
        before, self._supply = self._supply, self._throttled()
        self._supply_seen = self._checked
        if self._supply is None:
            return False
        dipped = before is not None and self._supply & ~before & UNDERVOLTAGE_SINCE
        return bool(self._supply & UNDERVOLTAGE_NOW or dipped)

    def _is_silent(self, name: str) -> bool:
        process, last_heard = self._processes.get(name), self._monitor.last_heard[name]
        if process is None or process.state != "running":
            return False
        if last_heard <= process.since:
            return self._checked - process.since > STARTING_SECONDS
        return self._checked - last_heard > SILENT_SECONDS
