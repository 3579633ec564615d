"""The board's calibration: requested after each greeting, and stored on request."""

import threading
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.contract.calibration import STEPS, CalibrationValues
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.packets import Calibration, RequestCalibration
from robot_runtime.errors import RefusedError
from robot_runtime.link.timing import airtime
from robot_runtime.parameters.board import Send

_RETRY_SECONDS = 1.0
"""Until the board is asked again: the link loses nothing, but a board may restart before it answers."""
_STORE_SECONDS = 1.2
"""In which a board has written and read its calibration; it writes for 0.3 s. The server waits for 2 s."""
_BYTES = 2 * Calibration.layout.size + 128
"""On the line for a calibration and its answer, and what may be queued before them."""


class BoardCalibration:
    """The calibration in force. Every method may be called from any thread."""

    def __init__(self, clock: Clock, send: Send, baud: int, on_change: Callable[[], None]) -> None:
        self._clock = clock
        self._send = send
        self._patience = 2 * airtime(_BYTES, baud)
        self._on_change = on_change
        self._stored: CalibrationValues | None = None
        self._problem = ""
        self._answers = 0
        self._asked = 0
        self._asked_at = float("-inf")
        self._changed = threading.Condition()

    @property
    def values(self) -> CalibrationValues | None:
        """The calibration that the board stores; None until the board has answered."""
        return self._stored

    def forget(self) -> None:
        """Forget the calibration after a greeting: the board may be another one."""
        with self._changed:
            self._stored, self._problem = None, ""
            self._asked_at = float("-inf")
            self._asked = 0

    def see(self, packet: Calibration) -> None:
        """Take the board's answer."""
        with self._changed:
            try:
                self._stored, self._problem = CalibrationValues.from_packet(packet), ""
            except ConfigError as problem:
                self._stored, self._problem = None, str(problem)
            self._answers += 1
            self._asked = max(self._asked - 1, 0)
            self._changed.notify_all()
        self._on_change()

    def tick(self) -> None:
        """Ask the board again when that is due; called several times a second."""
        with self._changed:
            due = self._clock.now() - self._asked_at >= _RETRY_SECONDS + self._patience
            if self._stored is None and due and self._send(RequestCalibration()):
                self._asked_at = self._clock.now()
                self._asked += 1

    def refusals(self) -> list[str]:
        """Return the reasons against arming; empty if the board stores a whole calibration."""
        with self._changed:
            if self._problem:
                return [f"The board's calibration cannot be used: {self._problem}. Calibrate it again."]
            if self._stored is None:
                return ["The board has not told its calibration yet. Wait a moment."]
            missing = [STEPS[name] for name in self._stored.missing]
            return [f"The board is not calibrated. Missing: {'; '.join(missing)}."] if missing else []

    def require(self) -> CalibrationValues:
        """Return the calibration that the board stores. Raise RefusedError until the board has answered."""
        stored = self._stored
        if stored is None:
            raise RefusedError("The board has not told its calibration. Check the connection.")
        return stored

    def store(self, values: CalibrationValues) -> None:
        """Store a calibration in the board, and wait until the board confirms it.

        Raise RefusedError where it does not: there is no connection, it is armed, or its EEPROM fails.
        """
        requested = values.packet()
        with self._changed:
            before = self._answers
            # What was asked before is answered first, with what the board kept until then.
            last = before + self._asked + 1
            if not self._send(requested):
                raise RefusedError("There is no connection to the board, so nothing was stored.")
            self._changed.wait_for(lambda: self._answers >= last, _STORE_SECONDS + self._patience)
            if self._answers == before:
                raise RefusedError("The board did not answer. Look at what it keeps before you go on.")
            stored = self._stored
        if stored is None or stored.packet().to_bytes() != requested.to_bytes():
            raise RefusedError(
                "The board did not store it: it is in the loop or armed, or its EEPROM fails. It keeps what "
                "the page shows."
            )
