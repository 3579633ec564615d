"""A scenario on the running robot: the state of before, its processes, and the end of a killed server's."""

import asyncio
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water.surroundings import Current
from server.features.scenarios.live_run import LiveExecutor
from server.features.scenarios.live_setup import SavedState
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import new_row
from tests.server.features.scenarios.direct_bridge import STATE, DirectBridge
from tests.server.recording.recorder_rig import RecorderRig


class ScriptedMonitor:
    """Returns these states one after the other, and then the last of them."""

    def __init__(self, *states: dict[str, Any] | None) -> None:
        self._states: Iterator[dict[str, Any] | None] = iter(states)
        self._newest: dict[str, Any] | None = None

    def state(self) -> dict[str, Any] | None:
        self._newest = next(self._states, self._newest)
        return self._newest

    def silence(self) -> None:
        """A state that comes is a present one."""


def executor(settings: Settings, monitor: ScriptedMonitor) -> LiveExecutor:
    nobody = cast(Any, None)
    clock = SimulatedClock(100.0)
    return LiveExecutor(
        settings, nobody, nobody, nobody, nobody, cast(Any, monitor), nobody, clock, notify=nobody
    )


def test_a_state_from_before_the_start_may_lack_the_last_change_and_is_not_taken(settings: Settings) -> None:
    before, after = {"time": 99.9, "set_point_default": 0.3}, {"time": 100.1, "set_point_default": 0.9}
    live = executor(settings, ScriptedMonitor(None, before, before, after))
    assert asyncio.run(live._next_state()) == after


class Killed:
    """A server after one that was killed during a scenario with a current."""

    def __init__(self, store: Store, settings: Settings) -> None:
        # A real board: an emulated one's line would be cleaned.
        self.settings = replace(settings, robot=replace(settings.robot, mode="robot"))
        self.simulator = Simulator(SimulationParameters(), seed=1)
        self.bridge = DirectBridge(self.simulator)
        self.rig = RecorderRig(store, settings)
        self.notices: list[tuple[str, ...]] = []

    async def recover(self, run: str = "the same") -> list[tuple[str, ...]]:
        """Recover beside this run of the runtime; return the notices."""
        water = await self.bridge.ask_simulator("surroundings", {})
        SavedState({**STATE, "run": "the same"}, water, None).write(self.settings.data.scenario_before)
        self.simulator.set_current(Current(north=0.2))
        row = new_row(self.settings, self.rig.clock, "cut off", "", "null")
        row.origin = "scenario"
        await self.rig.recorder.start(row)
        live = LiveExecutor(
            self.settings,
            self.rig.store,
            self.rig.recorder,
            cast(Any, self.bridge),
            cast(Any, SimpleNamespace(put_back=self.bridge.send)),
            cast(Any, ScriptedMonitor({"run": run})),
            cast(Any, None),
            self.rig.clock,
            notify=lambda *arguments: self.notices.append(arguments),
        )
        await live.recover()
        return self.notices


RESTORED = (
    "scenario",
    "caution",
    "The server was killed during a scenario. The robot is disarmed and has its previous settings.",
)


def test_after_a_killed_server_the_robot_is_disarmed_and_restored_on_a_full_disk(
    store: Store, settings: Settings
) -> None:
    with closing(sqlite3.connect(settings.data.database)) as database:
        full = "SELECT RAISE(FAIL, 'database or disk is full')"
        database.execute(f"CREATE TRIGGER full BEFORE INSERT ON marker BEGIN {full}; END")
    killed = Killed(store, settings)
    assert asyncio.run(killed.recover()) == [RESTORED]
    assert killed.bridge.commands[0] == ("stop", {})
    assert ("steering", {"by": "beacons"}) in killed.bridge.commands
    assert killed.simulator.surroundings().current == Current()
    assert killed.rig.recorder.session is None
    assert not killed.settings.data.scenario_before.exists()


def test_the_water_is_restored_also_where_the_runtime_was_restarted(store: Store, settings: Settings) -> None:
    killed = Killed(store, settings)
    assert asyncio.run(killed.recover(run="another")) == [RESTORED]
    assert killed.simulator.surroundings().current == Current()
    assert killed.bridge.commands == [("stop", {})]


def test_a_robot_that_cannot_be_disarmed_after_a_killed_server_is_not_called_disarmed(
    store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def refuse() -> None:
        raise RefusedError("No.")

    killed = Killed(store, settings)
    monkeypatch.setattr(killed.bridge, "disarm", refuse)
    assert asyncio.run(killed.recover()) == [
        ("scenario", "alarm", "The robot could not be disarmed after the scenario: No."),
        ("scenario", "caution", "The server was killed during a scenario."),
    ]
