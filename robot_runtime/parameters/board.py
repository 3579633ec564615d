"""The board's parameters: their requested values, and which of them the board has confirmed.

The board forgets them at a reset, and another runtime may have set them before. So all are sent again after
each greeting, and the robot is not armed before all are confirmed.
"""

import threading
from collections.abc import Iterator
from functools import partial
from typing import Protocol

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import CHIP_PARAMETERS, Packet, Parameter
from robot_runtime.link.timing import airtime
from robot_runtime.parameters.entry import Entry

_RETRY_SECONDS = 1.0
"""Until an unconfirmed value is sent again: the link loses nothing, but an armed board may refuse a value."""
_ALL_BYTES = len(CHIP_PARAMETERS) * (1 + Parameter.layout.size) + 64
"""To send all values, and what may be queued on the line before them."""


class Send(Protocol):
    """The function that sends packets to the board."""

    def __call__(self, *packets: Packet) -> bool:
        """Send the packets; return False without a connection."""
        ...


class BoardParameters:
    """The requested and confirmed values. Every method may be called from any thread."""

    def __init__(self, clock: Clock, send: Send, baud: int) -> None:
        self._clock = clock
        self._send = send
        self._retry_after = _RETRY_SECONDS + 2 * airtime(_ALL_BYTES, baud)
        self._values = [parameter.default for parameter in CHIP_PARAMETERS]
        self._unconfirmed = set(range(len(CHIP_PARAMETERS)))
        self._sent_at = float("-inf")
        self._lock = threading.Lock()

    def entries(self) -> Iterator[Entry]:
        """Yield the parameters for the registry."""
        for number, parameter in enumerate(CHIP_PARAMETERS):
            yield Entry(
                name=parameter.name,
                get=partial(self._values.__getitem__, number),
                set=partial(self._request, number),
                minimum=parameter.minimum,
                maximum=parameter.maximum,
                unit=parameter.unit,
                meaning=parameter.meaning,
                where="firmware",
                while_armed=parameter.while_armed,
                pending=partial(self._is_pending, number),
            )

    def requested(self, name: str) -> float:
        """Return the requested value of the parameter with this name."""
        return self._values[[parameter.name for parameter in CHIP_PARAMETERS].index(name)]

    def forget_confirmations(self) -> None:
        """Mark all values as unconfirmed, after a greeting."""
        with self._lock:
            self._unconfirmed = set(range(len(CHIP_PARAMETERS)))
            self._sent_at = float("-inf")

    def confirm(self, answer: Parameter) -> bool:
        """Take the board's answer; return True if it confirms a value that was unconfirmed."""
        with self._lock:
            requested = [_to_wire(self._values[number]) for number in self._unconfirmed & {answer.number}]
            if _to_wire(answer.value) not in requested:
                return False
            self._unconfirmed.discard(answer.number)
            return True

    def tick(self) -> None:
        """Send unconfirmed values again when that is due; called several times a second."""
        with self._lock:
            if self._unconfirmed and self._clock.now() - self._sent_at >= self._retry_after:
                self._send_unconfirmed()

    def refusals(self) -> list[str]:
        """Return the reasons against arming; empty if the board has confirmed all values."""
        with self._lock:
            names = [CHIP_PARAMETERS[number].name for number in sorted(self._unconfirmed)]
        return [f"The board has not confirmed {', '.join(names)} yet. Wait a moment."] if names else []

    def _is_pending(self, number: int) -> bool:
        return number in self._unconfirmed

    def _request(self, number: int, value: float) -> None:
        with self._lock:
            # The value in force is the rounded one of the packet.
            self._values[number] = _to_wire(value) / 1000
            self._unconfirmed.add(number)
            self._send_unconfirmed()

    def _send_unconfirmed(self) -> None:
        packets = [
            Parameter(number=number, value=self._values[number]) for number in sorted(self._unconfirmed)
        ]
        if self._send(*packets):
            self._sent_at = self._clock.now()


def _to_wire(value: float) -> int:
    return round(value * 1000)
