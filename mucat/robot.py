"""A running robot: its state, its samples, commands with control, and STOP."""

import json
import threading
import time
from collections.abc import AsyncIterator, Generator, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from typing import Any, Literal
from urllib.parse import quote

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

from mucat.address import RobotAddress
from mucat.errors import RobotError
from mucat.live import LiveSample, open_live, read_live, read_live_async

DRIVE_SECONDS = 0.05
"""Between two commands of the sticks, each of which counts for 0.2 s."""
POLL_SECONDS = 0.5


class Robot:
    """A robot at an address; `token` is one of `mucat access token`. Every method raises RobotError."""

    def __init__(self, url: str, token: str) -> None:
        self.address = RobotAddress(url, token)

    def state(self) -> dict[str, Any]:
        """Return the robot's newest state: the topic `state`."""
        state: dict[str, Any] = self.address.ask("GET", "/robot")
        return state

    def health(self) -> dict[str, Any]:
        """Return the health of every part."""
        health: dict[str, Any] = self.address.ask("GET", "/health")
        return health

    def stop(self) -> None:
        """Stop the robot: disarm at once. This needs no control."""
        self.address.ask("POST", "/robot/stop")

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Return the parameters by name, each with its `value`, range, unit and meaning."""
        listed = self.address.ask("GET", "/parameters")["parameters"]
        return {parameter["name"]: parameter for parameter in listed}

    def picture(self, topic: str = "picture") -> Any:
        """Return the next picture of a topic as an array, height × width × 3: red, green, blue."""
        with closing(self.live(topic)) as samples:
            return next(samples).picture()

    @contextmanager
    def record(self, name: str = "", note: str = "") -> Iterator["SessionRecording"]:
        """Record a session, which the block's end stops; its default name is its date and time."""
        session = int(self.address.ask("POST", "/sessions", {"name": name, "note": note})["id"])
        try:
            yield SessionRecording(self.address, session)
        finally:
            self.address.ask("POST", f"/sessions/{session}/stop")

    def live(self, *topics: str) -> Generator[LiveSample, None, None]:
        """Return the samples of these topics from now on, as they come."""
        return read_live(self.address, topics)

    def live_async(self, *topics: str) -> AsyncIterator[LiveSample]:
        """Return the samples of these topics, for `async for`."""
        return read_live_async(self.address, topics)

    @contextmanager
    def control(self, *, over: bool = False) -> Iterator["RobotControl"]:
        """Take control, with `over` also from somebody else; the block's end stops and releases the robot."""
        with open_live(self.address) as socket:
            hello: dict[str, Any] = json.loads(socket.recv())
            steady = hello["steady"] - time.monotonic()
            reader = threading.Thread(target=_read_all, args=(socket,), daemon=True)
            reader.start()
            path = f"/control/take{'?over=true' if over else ''}"
            lease = self.address.ask("POST", path, client=hello["client_key"])["epoch"]
            try:
                yield RobotControl(self.address, socket, hello["client_key"], lease, steady)
            finally:
                self.stop()

    def run_scenario(self, text: str) -> int:
        """Run a scenario (TOML) in simulated time on the robot's computer; return its session's number."""
        asked = {"text": text, "place": "simulated", "board": "host"}
        run = self.address.ask("POST", "/scenarios/runs", asked)["run"]
        while True:
            state = self.address.ask("GET", "/scenarios/state")
            last = state["last"]
            if last is not None and last["run"] == run:
                if last["state"] != "complete":
                    raise RobotError(f"The scenario ended as {last['state']}: {last['problem']}")
                return int(last["session"])
            if run not in (
                entry["run"] for entry in (state["active"], *state["queued"]) if entry is not None
            ):
                raise RobotError(
                    "The scenario is over, and another one or the server's restart has followed. "
                    "The newest sessions have its result."
                )
            time.sleep(POLL_SECONDS)

    def try_mission(self, text: str, seeds: int = 20) -> list[dict[str, Any]]:
        """Try a mission (TOML) in simulated water, once for each seed; return the outcome of each."""
        trial = self.address.ask("POST", "/missions/trial", {"text": text, "seeds": seeds})
        while trial["running"]:
            time.sleep(POLL_SECONDS)
            trial = self.address.ask("GET", "/missions/trial")
        if trial["problem"]:
            raise RobotError(trial["problem"])
        outcomes: list[dict[str, Any]] = trial["results"]
        return outcomes


class SessionRecording:
    """A session that records, within the block of `Robot.record`; `session` is its number."""

    def __init__(self, address: RobotAddress, session: int) -> None:
        self._address = address
        self.session = session

    def mark(self, text: str = "") -> None:
        """Bookmark this moment, with a note in Markdown if one is given. Raise RobotError."""
        self._address.ask("POST", f"/sessions/{self.session}/markers", {"time": None, "text": text})


class RobotControl:
    """The control of a robot within the block of `Robot.control`."""

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
        """Send a command of docs/reference/commands.md with its fields. Raise RobotError."""
        return self._address.ask("POST", f"/robot/commands/{quote(name, safe='')}", fields, self._key)

    def set_parameters(self, values: Mapping[str, Any]) -> None:
        """Set parameters by name, all or none, between two control ticks. Raise RobotError."""
        self.command("parameters", values=dict(values))

    def arm(self, mode: Literal["automatic", "manual"] = "automatic", unwatched: float | None = None) -> None:
        """Arm the robot. Raise RobotError with all reasons against it.

        `unwatched`: s for which it may go on while nobody watches; 0: without an end; None: `[control]
        unwatched` of the robot. Within the block of `Robot.control` this program watches.
        """
        self.command("arm", mode=mode, unwatched=unwatched)

    def run_mission(self, text: str) -> dict[str, Any]:
        """Arm the robot, run a mission (TOML) and wait for its end; return its last state.

        `phase` is "succeeded", "failed" or "ended". Raise RobotError with all reasons against a start.
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
        state: dict[str, Any] | None = self._address.ask("GET", "/missions/state")
        return state

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
        """Hold the sticks for some seconds: shares of the most, -1 to 1; forward, to the right, down.

        Raise RobotError.
        """
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end:
            self._sequence += 1
            message = {
                "op": "drive",
                "lease": self._lease,
                "sequence": self._sequence,
                "taken": now + self._steady,
                "axes": [x, y, z, roll, pitch, yaw],
            }
            try:
                self._socket.send(json.dumps(message))
            except ConnectionClosed as problem:
                raise RobotError("The connection is lost, and control with it.") from problem
            time.sleep(min(DRIVE_SECONDS, max(0.0, end - time.monotonic())))


def _began(mission: dict[str, Any]) -> float:
    """Return the time at which a mission began, s of the steady clock."""
    return float(mission["time"] - mission["elapsed"] - mission["paused"])


def _read_all(socket: ClientConnection) -> None:
    """Read all messages: the server disconnects clients that do not read."""
    with suppress(ConnectionClosed):
        for _ in socket:
            pass
