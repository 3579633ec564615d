"""A running robot: its state, its samples, commands with control, and STOP."""

import json
import threading
import time
from collections.abc import AsyncIterator, Generator, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Literal
from urllib.parse import quote

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

from mucat.address import RobotAddress
from mucat.errors import RobotError
from mucat.live import LiveReader, LiveSample, open_live, read_live, read_live_async

DRIVE_SECONDS = 0.05
"""Between two commands of the sticks, each of which counts for 0.2 s."""
POLL_SECONDS = 0.5


class Robot:
    """A robot at an address; `token` is one of `mucat access token`. Every method raises RobotError."""

    def __init__(self, url: str, token: str) -> None:
        self.address = RobotAddress(url, token)

    def state(self) -> dict[str, Any]:
        """The robot's newest state: the topic `state`."""
        found: dict[str, Any] = self.address.ask("GET", "/robot")
        return found

    def health(self) -> dict[str, Any]:
        """The health of every part."""
        found: dict[str, Any] = self.address.ask("GET", "/health")
        return found

    def stop(self) -> None:
        """STOP: disarm at once. Needs no control."""
        self.address.ask("POST", "/robot/stop")

    def live(self, *topics: str) -> Generator[LiveSample, None, None]:
        """The samples of these topics from now on, as they come."""
        return read_live(self.address, topics)

    def live_async(self, *topics: str) -> AsyncIterator[LiveSample]:
        """The same for `async for`."""
        return read_live_async(self.address, topics)

    @contextmanager
    def control(self, *, over: bool = False) -> Iterator["Control"]:
        """Take control, `over` also from somebody else; the end of the block stops and releases it."""
        with open_live(self.address) as socket:
            hello = LiveReader(("state",)).greet(socket.recv())
            steady = hello["steady"] - time.monotonic()
            reader = threading.Thread(target=_read_all, args=(socket,), daemon=True)
            reader.start()
            path = f"/control/take{'?over=true' if over else ''}"
            lease = self.address.ask("POST", path, client=hello["client_key"])["epoch"]
            try:
                yield Control(self.address, socket, hello["client_key"], lease, steady)
            finally:
                self.stop()

    def run_scenario(self, text: str) -> int:
        """Run a scenario (TOML) in simulated time on the robot's computer; returns its session's number."""
        asked = {"text": text, "place": "simulated", "board": "host"}
        run = self.address.ask("POST", "/scenarios/runs", asked)["run"]
        while True:
            state = self.address.ask("GET", "/scenarios/state")
            last = state["last"]
            if last is not None and last["run"] == run:
                if last["state"] != "complete":
                    raise RobotError(f"The scenario ended as {last['state']}: {last['problem']}")
                return int(last["session"])
            if run not in (one["run"] for one in (state["active"], *state["queued"]) if one is not None):
                raise RobotError(
                    "The scenario is over, and another one or the server's restart has followed. "
                    "The newest sessions have its result."
                )
            time.sleep(POLL_SECONDS)

    def try_mission(self, text: str, seeds: int = 20) -> list[dict[str, Any]]:
        """Try a mission (TOML) in simulated water, once for each seed; returns the outcome of each."""
        trial = self.address.ask("POST", "/missions/trial", {"text": text, "seeds": seeds})
        while trial["running"]:
            time.sleep(POLL_SECONDS)
            trial = self.address.ask("GET", "/missions/trial")
        if trial["problem"]:
            raise RobotError(trial["problem"])
        outcomes: list[dict[str, Any]] = trial["results"]
        return outcomes


class Control:
    """The control of a robot, as long as the block of `Robot.control` lasts."""

    def __init__(
        self, address: RobotAddress, socket: ClientConnection, key: str, lease: int, steady: float
    ) -> None:
        self._address = address
        self._socket = socket
        self._key = key
        self._lease = lease
        self._steady = steady
        self._sequence = 0

    def command(self, name: str, /, **fields: Any) -> Any:
        """Send a command of docs/reference/commands.md with its fields. Raises RobotError."""
        return self._address.ask("POST", f"/robot/commands/{quote(name, safe='')}", fields, self._key)

    def arm(self, mode: Literal["automatic", "manual"] = "automatic") -> None:
        """Arm the robot. Raises RobotError with every reason against it."""
        self.command("arm", mode=mode)

    def run_mission(self, text: str) -> dict[str, Any]:
        """Arm the robot, run a mission (TOML) and wait for its end; returns its last state.

        `phase` is "succeeded", "failed" or "ended". Raises RobotError with every reason against a start.
        """
        last = self._mission()
        before = float("-inf") if last is None else last["time"]
        self._address.ask("POST", "/missions/start", {"text": text}, self._key)
        while True:
            mission = self._mission()
            # Not by its number: a runtime that was restarted counts from 1 again.
            begun = mission is not None and _began(mission) > before
            if mission is not None and begun and mission["phase"] not in ("running", "paused"):
                return mission
            time.sleep(POLL_SECONDS)

    def _mission(self) -> dict[str, Any] | None:
        found: dict[str, Any] | None = self._address.ask("GET", "/missions/state")
        return found

    def drive(
        self,
        seconds: float,
        *,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        roll: float = 0.0,
        pitch: float = 0.0,
        yaw: float = 0.0,
    ) -> None:
        """Hold the sticks for some seconds: shares of the most, -1 to 1; forwards, to the right, down.

        Raises RobotError.
        """
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end:
            self._sequence += 1
            said = {
                "op": "drive",
                "lease": self._lease,
                "sequence": self._sequence,
                "taken": now + self._steady,
                "axes": [x, y, z, roll, pitch, yaw],
            }
            try:
                self._socket.send(json.dumps(said))
            except ConnectionClosed as problem:
                raise RobotError("The connection is lost, and control with it.") from problem
            time.sleep(min(DRIVE_SECONDS, max(0.0, end - time.monotonic())))


def _began(mission: dict[str, Any]) -> float:
    """Returns the time at which a mission began, s of the steady clock."""
    return float(mission["time"] - mission["elapsed"] - mission["paused"])


def _read_all(socket: ClientConnection) -> None:
    """Read what comes: who does not read is disconnected."""
    with suppress(ConnectionClosed):
        for _ in socket:
            pass
