"""Stops the robot when the server, and with it whoever looks after the robot, is gone."""

import threading

from robot_runtime.clock import Clock
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.lifetime import HEARTBEAT
from robot_runtime.messages import Messages

_LOOK_SECONDS = 0.5


class Heartbeat:
    """Listens for the server from the start on; where it is silent for `seconds`, an armed robot is stopped.

    Stopped fins mean that the robot rises. It runs on otherwise, and can be armed again by the next server.
    """

    def __init__(self, supervisor: Supervisor, messages: Messages, clock: Clock, seconds: float) -> None:
        self._supervisor = supervisor
        self._clock = clock
        self._seconds = seconds
        self.heard = clock.now()
        """s; when the server was last heard."""
        messages.subscribe(HEARTBEAT, self._hear)

    def start(self) -> None:
        """Look from now on, in a thread of its own."""
        threading.Thread(target=self._watch, name="heartbeat", daemon=True).start()

    def look(self) -> None:
        """Stop the robot where it is armed and the server has been silent for too long."""
        if self._supervisor.armed and self._clock.now() - self.heard > self._seconds:
            self._supervisor.stop(f"The server has been silent for {self._seconds:g} s.", "caution")

    def _watch(self) -> None:
        pause = threading.Event()
        while not pause.wait(_LOOK_SECONDS):
            self.look()

    def _hear(self, _name: str, _payload: bytes) -> None:
        self.heard = self._clock.now()
