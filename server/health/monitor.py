"""Health of the parts, from living processes and arriving samples."""

import asyncio
import json
from collections.abc import Callable
from typing import Any, Literal

from pydantic import Field

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import LINK, MISSION, STATE, TIME, TRUTH, AnyTopic
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.transport.blocks import Block
from server import VERSION
from server.platform.errors import UnavailableError
from server.platform.schema_base import Schema
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.managed_process import ManagedProcess
from server.processes.supervisor import ProcessSupervisor

STATE_SECONDS = 2.5
"""The runtime sends its state every second."""
CATCH_UP_SECONDS = 0.3
"""After a command the runtime sends its state at once: after this time it is here, or will not come."""
CATCH_UP_PAUSE = 0.01
TRUTH_SECONDS = 2.0
LINK_SECONDS = 3.0
GRACE_SECONDS = 10.0
"""The time for which a part that has just been started may be silent."""

NO_PICTURE = "no picture"
"""The beginning of the runtime's words for a camera that fails."""

PartName = Literal[
    "server",
    "database",
    "runtime",
    "link",
    "board",
    "simulator",
    "scene",
    "camera",
    "events",
    "router",
    "robots",
]
PartState = Literal["ok", "starting", "failed", "absent", "unknown"]
Condition = tuple[PartState, str]
"""The state of a part, and a sentence about it."""


class PartHealth(Schema):
    """The health of a part: its state, and a sentence about it."""

    name: PartName
    state: PartState
    text: str
    here: bool | None = Field(
        default=None, description="true if a simulator that can be started and ended runs on this computer"
    )


class Health(Schema):
    """The health of all parts: "failed" if one has failed, else "starting" if one starts, else "ok"."""

    status: Literal["ok", "starting", "failed"]
    version: str
    robot: str
    parts: list[PartHealth] = Field(
        description="server and database; of a robot also runtime, link, board, simulator, scene, camera, "
        "and events where `[events]` in robot.toml names a broker; of a lab also router and robots"
    )


class HealthMonitor:
    """Monitor of each part's health by its process and the newest block of each topic."""

    def __init__(
        self,
        settings: Settings,
        clock: Clock,
        store: Store,
        processes: ProcessSupervisor,
    ) -> None:
        self.more: dict[PartName, Callable[[], Condition | None]] = {}
        """Parts of features: a function for each, which returns None where there is nothing to say."""
        self._settings = settings
        self._clock = clock
        self._store = store
        self._processes = processes
        self._began = clock.now()
        self._newest: dict[AnyTopic, tuple[float, Block]] = {}
        self._bytes_received = -1
        self._bytes_grew = float("-inf")
        self._unrenderable = missing()
        self.last_heard = {"runtime": float("-inf"), "simulator": float("-inf")}
        """s; the arrival of the last block from these processes."""
        self.firmware_away: str | None = None
        """Reason why the board does not run the robot's firmware, and the remedy; None if it does."""

    def see(self, block: Block) -> None:
        """Record a block."""
        now = self._clock.now()
        self._newest[block.topic] = (now, block)
        if block.topic.sender in self.last_heard:
            self.last_heard[block.topic.sender] = now
        if block.topic is LINK:
            self._see_link(block, now)

    def state(self) -> dict[str, Any] | None:
        """Return the newest `state` document; None without a readable one."""
        return self._document(STATE)

    def silence(self) -> float | None:
        """Return the age of the newest state (s) where it is too old to be the present one; else None."""
        if STATE not in self._newest or self._fresh(STATE, STATE_SECONDS, None):
            return None
        return self._clock.now() - self._newest[STATE][0]

    def require_heard(self) -> None:
        """Raise UnavailableError where the newest state is too old to be the robot's present one."""
        if (age := self.silence()) is not None:
            raise UnavailableError(
                f"The robot's state is unknown: its runtime has said nothing for {age:.0f} s. "
                "/api/health says why."
            )

    def mission(self) -> dict[str, Any] | None:
        """Return the newest `mission` document; None without a readable one."""
        return self._document(MISSION)

    async def catch_up(self, topic: AnyTopic, moment: float) -> None:
        """Wait until a document of this moment (s, steady clock) or later has arrived, or is overdue."""
        while self._clock.now() < moment + CATCH_UP_SECONDS:
            document = self._document(topic)
            if document is not None and document.get("time", 0.0) >= moment:
                return
            await asyncio.sleep(CATCH_UP_PAUSE)

    def record(self, topic: AnyTopic, seconds: float) -> Any:
        """Return the newest record of a topic of rows; None where it is older than so many seconds."""
        if topic not in self._newest or not self._fresh(topic, seconds, None):
            return None
        return _last_record(self._newest[topic][1])

    def _document(self, topic: AnyTopic) -> dict[str, Any] | None:
        if topic not in self._newest:
            return None
        try:
            document = json.loads(self._newest[topic][1].payload)[-1]
        except (ValueError, IndexError, KeyError, RecursionError):
            return None
        return document if isinstance(document, dict) else None

    def require_disarmed(self, why: str) -> None:
        """Refuse heavy work while the robot is armed. Raise RefusedError, with the reason `why`."""
        state = self.state()
        if state is not None and state.get("armed"):
            raise RefusedError(f"{why} It is refused while the robot is armed: press STOP first.")

    @property
    def alive(self) -> bool:
        """False where the database or the robot's runtime has failed."""
        parts = (self._database(),) if self._settings.lab else (self._database(), self._runtime())
        return all(state != "failed" for state, _ in parts)

    def health(self) -> Health:
        """Return the health of every part now."""
        conditions: dict[PartName, Condition] = {
            "server": ("ok", "Answers requests."),
            "database": self._database(),
        }
        if not self._settings.lab:
            conditions |= {
                "runtime": self._runtime(),
                "link": self._link(),
                "board": self._board(),
                "simulator": self._simulator(),
                "scene": self._scene(),
                "camera": self._camera(),
            }
        for name, ask in self.more.items():
            if (condition := ask()) is not None:
                conditions[name] = condition
        parts = [PartHealth(name=name, state=state, text=text) for name, (state, text) in conditions.items()]
        simulator = self._processes.get("simulator")
        if self._settings.in_the_loop and simulator is not None:
            part = next(part for part in parts if part.name == "simulator")
            part.here = simulator.state != "paused"
        states = {part.state for part in parts}
        status: Literal["ok", "starting", "failed"] = "ok"
        if "failed" in states:
            status = "failed"
        elif "starting" in states:
            status = "starting"
        return Health(status=status, version=VERSION, robot=self._settings.robot.name, parts=parts)

    def _see_link(self, block: Block, now: float) -> None:
        received = _last_record(block).bytes_received
        # A smaller number counts from 0 again, since the line was opened anew.
        if received > self._bytes_received >= 0 or 0 < received < self._bytes_received:
            self._bytes_grew = now
        self._bytes_received = received

    def _database(self) -> Condition:
        if self._store.failing is not None:
            return "failed", f"Nothing can be stored: {self._store.failing}."
        return "ok", "Stores data."

    def _runtime(self) -> Condition:
        process = self._processes.get("runtime")
        if process is not None and process.state == "failed":
            return "failed", f"It {process.problem}."
        if process is not None and process.state == "paused":
            return "absent", process.problem
        if self._fresh(STATE, STATE_SECONDS, process):
            return "ok", "Sends data."
        return self._silent(process, "Runs, but sends nothing.")

    def _link(self) -> Condition:
        runtime = self._processes.get("runtime")
        if runtime is not None and runtime.state == "paused":
            return "absent", runtime.problem
        if (unknown := self._unknown(runtime)) is not None:
            return unknown
        state = self.state() or {}
        text = str(state.get("connection", ""))
        if state.get("connected") is True:
            return "ok", text
        if self.firmware_away is not None:
            return "failed", self.firmware_away
        return self._silent(runtime, text)

    def _board(self) -> Condition:
        process, runtime = self._processes.get("board"), self._processes.get("runtime")
        if process is not None and process.state == "failed":
            return "failed", f"It {process.problem}."
        if runtime is not None and runtime.state == "paused":
            return "absent", runtime.problem
        if self._is_recent(self._bytes_grew, LINK_SECONDS, process or runtime):
            return "ok", "Sends data."
        known = self._fresh(LINK, LINK_SECONDS, runtime)
        return (None if known else self._unknown(runtime)) or self._silent(
            process or runtime, "Nothing arrives from it."
        )

    def _simulator(self) -> Condition:
        if self._settings.robot.mode == "robot":
            return "absent", "A real robot swims in real water."
        process = self._processes.get("simulator")
        if process is not None and process.state == "failed":
            return "failed", f"It {process.problem}."
        # Hardware in the loop may be fed by a simulator on another computer.
        if self._fresh(TRUTH, TRUTH_SECONDS, process):
            return "ok", "Simulates the water."
        if process is not None and process.state == "paused":
            return "absent", process.problem
        return self._silent(process, "Runs, but the simulated water stands still.")

    def _scene(self) -> Condition:
        if self._settings.robot.mode == "robot":
            return "absent", "A real robot has a real camera."
        if self._unrenderable is not None:
            return "absent", f"Not rendered: {self._unrenderable}."
        process = self._processes.get("scene")
        if process is None or process.state == "paused":
            return "absent", "Does not run on this computer."
        if process.state == "failed":
            return "failed", f"It {process.problem}."
        if process.state == "running":
            return "ok", "Renders on demand."
        return self._silent(process, "")

    def _camera(self) -> Condition:
        runtime = self._processes.get("runtime")
        if (unknown := self._unknown(runtime)) is not None:
            return unknown
        text = str((self.state() or {}).get("camera", ""))
        # A robot without pictures swims all the same.
        return (
            "absent" if text.startswith(NO_PICTURE) else "ok"
        ), f"{text[:1].upper()}{text[1:]}." if text else "Starting."

    def _unknown(self, runtime: ManagedProcess | None) -> Condition | None:
        """Return the condition of a part that only a silent runtime knows; None where it is not silent."""
        if self._fresh(STATE, STATE_SECONDS, runtime):
            return None
        state, text = self._silent(runtime, "The runtime sends nothing.")
        return "unknown" if state == "failed" else state, text

    def _fresh(self, topic: AnyTopic, seconds: float, process: ManagedProcess | None) -> bool:
        return topic in self._newest and self._is_recent(self._newest[topic][0], seconds, process)

    def _is_recent(self, moment: float, seconds: float, process: ManagedProcess | None) -> bool:
        """Return True if the moment lies within the last `seconds` and the present run of the process."""
        return self._clock.now() - moment < seconds and (process is None or moment >= process.since)

    def _silent(self, process: ManagedProcess | None, text: str) -> Condition:
        if process is not None and process.state == "waiting":
            absent = ", ".join(path.name for path in process.command.needs if not path.exists())
            return "starting", f"Waits for {absent or 'its turn'}."
        since = self._began if process is None else process.since
        if (process is None or process.state == "running") and self._clock.now() - since < GRACE_SECONDS:
            return "starting", text or "Starting."
        return "failed", text or "It sends nothing."


def _last_record(block: Block) -> Any:
    row = block.data[len(block.data) - block.topic.row_bytes + TIME.size :]
    return block.topic.record.from_bytes(row)
