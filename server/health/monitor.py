"""Health of the parts, from living processes and arriving samples."""

import json
from typing import Any, Literal

from pydantic import BaseModel, Field

from robot_runtime.clock import Clock
from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.topics import TIME
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.transport.blocks import Block
from server import VERSION
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.supervisor import ManagedProcess, ProcessSupervisor

STATE_SECONDS = 2.5
"""The runtime sends its state every second."""
TRUTH_SECONDS = 2.0
LINK_SECONDS = 3.0
GRACE_SECONDS = 10.0
"""How long a part that has just been started may be silent."""

PartState = Literal["ok", "starting", "failed", "absent"]


class PartHealth(BaseModel):
    """One part, and how it does in words."""

    name: Literal["server", "database", "runtime", "link", "board", "simulator", "scene"]
    state: PartState
    text: str
    here: bool | None = Field(
        default=None, description="of what may be started and ended: whether it runs on this computer"
    )


class Health(BaseModel):
    """Everything together: "failed" where a part has failed, else "starting" where one starts, else "ok"."""

    status: Literal["ok", "starting", "failed"]
    version: str
    robot: str
    parts: list[PartHealth] = Field(description="server, database, runtime, link, board, simulator, scene")


class HealthMonitor:
    """Keeps the newest block of each topic, and derives the health of each part."""

    def __init__(self, settings: Settings, clock: Clock, store: Store, parts: ProcessSupervisor) -> None:
        self._settings = settings
        self._clock = clock
        self._store = store
        self._processes = parts
        self._began = clock.now()
        self._newest: dict[str, tuple[float, Block]] = {}
        self._bytes_received = -1
        self._bytes_grew: float | None = None
        self._unrenderable = missing()
        self.last_heard = {"runtime": float("-inf"), "simulator": float("-inf")}
        """s; when anything came from these processes last."""
        self.firmware_away: str | None = None
        """Why the board does not run the robot's firmware, and what to do; None where it does."""

    def see(self, block: Block) -> None:
        """Note a block."""
        now = self._clock.now()
        self._newest[block.topic.name] = (now, block)
        if block.topic.sender in self.last_heard:
            self.last_heard[block.topic.sender] = now
        if block.topic.name == "link":
            self._see_link(block, now)

    def state(self) -> dict[str, Any] | None:
        """The newest `state` document; None where there has been none that can be read."""
        if "state" not in self._newest:
            return None
        try:
            document = json.loads(self._newest["state"][1].payload)[-1]
        except (ValueError, IndexError, KeyError, RecursionError):
            return None
        return document if isinstance(document, dict) else None

    def require_disarmed(self, why: str) -> None:
        """Raises RefusedError, with this reason, where the robot is armed: heavy work waits until it
        rests.
        """
        state = self.state()
        if state is not None and state.get("armed"):
            raise RefusedError(f"{why} It is refused while the robot is armed: press STOP first.")

    def health(self) -> Health:
        """The health of every part now."""
        parts = [
            PartHealth(name="server", state="ok", text="It answers."),
            self._database(),
            self._runtime(),
            self._link(),
            self._board(),
            self._simulator(),
            self._scene(),
        ]
        states = {part.state for part in parts}
        status: Literal["ok", "starting", "failed"] = "ok"
        if "failed" in states:
            status = "failed"
        elif "starting" in states:
            status = "starting"
        return Health(status=status, version=VERSION, robot=self._settings.robot, parts=parts)

    def _see_link(self, block: Block, now: float) -> None:
        row = block.data[len(block.data) - block.topic.row_bytes + TIME.size :]
        received = LinkStatistics.from_bytes(row).bytes_received
        if received > self._bytes_received >= 0:
            self._bytes_grew = now
        self._bytes_received = received

    def _database(self) -> PartHealth:
        problem = self._store.failing
        if problem is not None:
            return PartHealth(name="database", state="failed", text=f"Nothing can be stored: {problem}.")
        return PartHealth(name="database", state="ok", text="It stores.")

    def _runtime(self) -> PartHealth:
        part = self._processes.get("runtime")
        if part is not None and part.state == "failed":
            return PartHealth(name="runtime", state="failed", text=_say_failed(part))
        if part is not None and part.state == "paused":
            return PartHealth(name="runtime", state="absent", text=part.problem)
        if self._fresh("state", STATE_SECONDS):
            return PartHealth(name="runtime", state="ok", text="It runs.")
        return self._silent("runtime", part, "It runs, but says nothing.")

    def _link(self) -> PartHealth:
        runtime = self._processes.get("runtime")
        if runtime is not None and runtime.state == "paused":
            return PartHealth(name="link", state="absent", text=runtime.problem)
        if not self._fresh("state", STATE_SECONDS):
            return self._silent("link", runtime, "Unknown: the runtime says nothing.")
        state = self.state() or {}
        text = str(state.get("connection", ""))
        if state.get("connected") is True:
            return PartHealth(name="link", state="ok", text=text)
        if self.firmware_away is not None:
            return PartHealth(name="link", state="failed", text=self.firmware_away)
        return self._silent("link", runtime, text)

    def _board(self) -> PartHealth:
        part = self._processes.get("board")
        if part is not None and part.state == "failed":
            return PartHealth(name="board", state="failed", text=_say_failed(part))
        runtime = self._processes.get("runtime")
        if runtime is not None and runtime.state == "paused":
            return PartHealth(name="board", state="absent", text=runtime.problem)
        now = self._clock.now()
        if self._bytes_grew is not None and now - self._bytes_grew < LINK_SECONDS:
            return PartHealth(name="board", state="ok", text="It sends.")
        return self._silent("board", part or runtime, "Nothing arrives from it.")

    def _simulator(self) -> PartHealth:
        health = self._water()
        part = self._processes.get("simulator")
        if self._settings.in_the_loop and part is not None:
            health.here = part.state != "paused"
        return health

    def _water(self) -> PartHealth:
        if self._settings.mode == "robot":
            return PartHealth(name="simulator", state="absent", text="A real robot swims in real water.")
        part = self._processes.get("simulator")
        if part is not None and part.state == "failed":
            return PartHealth(name="simulator", state="failed", text=_say_failed(part))
        if part is not None and part.state == "paused" and not self._fresh("truth", TRUTH_SECONDS):
            return PartHealth(name="simulator", state="absent", text=part.problem)
        if self._fresh("truth", TRUTH_SECONDS):
            return PartHealth(name="simulator", state="ok", text="The water is simulated.")
        return self._silent("simulator", part, "It runs, but the simulated water stands still.")

    def _scene(self) -> PartHealth:
        if self._settings.mode == "robot":
            return PartHealth(name="scene", state="absent", text="A real robot sees for itself.")
        if self._unrenderable is not None:
            return PartHealth(name="scene", state="absent", text=f"Not rendered: {self._unrenderable}.")
        part = self._processes.get("scene")
        if part is None or part.state == "paused":
            return PartHealth(name="scene", state="absent", text="It does not run on this computer.")
        if part.state == "failed":
            return PartHealth(name="scene", state="failed", text=_say_failed(part))
        if part.state == "running":
            return PartHealth(name="scene", state="ok", text="It renders on demand.")
        return self._silent("scene", part, "")

    def _fresh(self, topic: str, seconds: float) -> bool:
        return topic in self._newest and self._clock.now() - self._newest[topic][0] < seconds

    def _silent(self, name: Any, part: ManagedProcess | None, text: str) -> PartHealth:
        if part is not None and part.state == "waiting":
            missing = ", ".join(path.name for path in part.command.needs if not path.exists())
            return PartHealth(name=name, state="starting", text=f"Waits for {missing or 'its turn'}.")
        since = self._began if part is None else part.since
        if (part is None or part.state == "running") and self._clock.now() - since < GRACE_SECONDS:
            return PartHealth(name=name, state="starting", text=text or "It starts.")
        return PartHealth(name=name, state="failed", text=text or "It says nothing.")


def _say_failed(part: ManagedProcess) -> str:
    return f"It {part.problem}."
