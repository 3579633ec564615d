"""The lab's end of Zenoh: presences of all robots come in, two questions go out."""

import json
import logging
import time
from collections.abc import Callable
from typing import Any

import zenoh

from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.transport.zenoh_transport import describe_problem, open_session
from server.platform.lab_network import ALIVE, CLOCK, PRESENCE, STOP, key_of

log = logging.getLogger(__name__)

PRESENCE_BYTES_MAX = 100_000
CLOCK_SECONDS = 1.0
CLOCK_QUERIES = 10


class FleetSession:
    """One Zenoh session, through the lab's router at `endpoint`, which must be there when it opens.

    It comes back by itself after the router was away. `see` is called with a robot's name and its presence,
    `see_alive` with a name and if it is there; both in Zenoh's own threads. Raises OSError.
    """

    def __init__(
        self, endpoint: str, see: Callable[[str, bytes], None], see_alive: Callable[[str, bool], None]
    ) -> None:
        self._session = open_session("client", connect=[endpoint])

        def receive(sample: zenoh.Sample) -> None:
            data = sample.payload.to_bytes()
            if len(data) <= PRESENCE_BYTES_MAX:
                see(_robot_of(sample), data)

        def receive_alive(sample: zenoh.Sample) -> None:
            see_alive(_robot_of(sample), sample.kind == zenoh.SampleKind.PUT)

        self._presences = self._session.declare_subscriber(key_of("*", PRESENCE), receive)
        self._alive = self._session.liveliness().declare_subscriber(
            key_of("*", ALIVE), receive_alive, history=True
        )

    def stop(self, robot: str, seconds: float) -> None:
        """Stop a robot. Raise RefusedError, NoAnswerError after so many seconds, OSError."""
        self._ask(robot, STOP, seconds)

    def measure_clock(self, robot: str) -> float:
        """Return by how much a robot's clock is ahead of this computer's, s.

        Of ten questions the one that was answered soonest counts. Raise as `stop`.
        """
        answers: list[tuple[float, float]] = []
        for _ in range(CLOCK_QUERIES):
            began, sent = time.monotonic(), time.time()
            there = float(self._ask(robot, CLOCK, CLOCK_SECONDS)["time"])
            took = time.monotonic() - began
            answers.append((took, there - (sent + took / 2)))
        return min(answers)[1]

    def close(self) -> None:
        """Close the session."""
        self._session.close()  # type: ignore[no-untyped-call]

    def _ask(self, robot: str, name: str, seconds: float) -> dict[str, Any]:
        try:
            replies = self._session.get(key_of(robot, name), payload=b"{}", timeout=seconds)
        except zenoh.ZError as problem:
            raise OSError(describe_problem(problem)) from problem
        for reply in replies:
            if reply.ok is not None:
                answer: dict[str, Any] = json.loads(reply.ok.payload.to_bytes())
                if not answer.get("accepted"):
                    raise RefusedError(str(answer.get("reason", "refused without a reason")))
                return answer
        raise NoAnswerError(f"{robot} has not answered within {seconds:g} s")


def _robot_of(sample: zenoh.Sample) -> str:
    return str(sample.key_expr).split("/")[1]
