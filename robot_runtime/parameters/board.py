"""The board's own parameters: what is wanted of them, and whether the board has confirmed it.

A reset makes the board forget them, and another runtime may have set them before: so all of them are said
anew after each greeting, and the robot is not armed before all are confirmed.
"""

import threading
from collections.abc import Iterator
from functools import partial
from typing import Protocol

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import CHIP_PARAMETERS, Packet, Parameter
from robot_runtime.link.timing import airtime
from robot_runtime.parameters.entry import Entry

_ANSWER_SECONDS = 1.0
"""After which what the board has not confirmed is said again. The line loses nothing of it; a board that is
armed may have refused."""
_BYTES = len(CHIP_PARAMETERS) * (1 + Parameter.layout.size) + 64
"""What it takes to say all, and what may be on the line before."""


class Send(Protocol):
    """Hands packets to the line; False where nobody is there to take them."""

    def __call__(self, *packets: Packet) -> bool:
        """Do so."""
        ...


class BoardParameters:
    """Every method may be called from any thread."""

    def __init__(self, clock: Clock, send: Send, baud: int) -> None:
        self._clock = clock
        self._send = send
        self._patience = _ANSWER_SECONDS + 2 * airtime(_BYTES, baud)
        self._values = [one.default for one in CHIP_PARAMETERS]
        self._unconfirmed = set(range(len(CHIP_PARAMETERS)))
        self._rounded = float("-inf")
        self._lock = threading.Lock()

    def entries(self) -> Iterator[Entry]:
        """The parameters for the registry."""
        for number, one in enumerate(CHIP_PARAMETERS):
            yield Entry(
                name=one.name,
                get=partial(self._values.__getitem__, number),
                set=partial(self._want, number),
                minimum=one.minimum,
                maximum=one.maximum,
                unit=one.unit,
                meaning=one.meaning,
                where="firmware",
                while_armed=one.while_armed,
                pending=partial(self._is_open, number),
            )

    def see_greeting(self) -> None:
        """The board may have been another one, or forgotten all."""
        with self._lock:
            self._unconfirmed = set(range(len(CHIP_PARAMETERS)))
            self._rounded = float("-inf")

    def see(self, answer: Parameter) -> bool:
        """The board said what is in force; whether that settles what was open."""
        with self._lock:
            requested = [_rounded(self._values[number]) for number in self._unconfirmed & {answer.number}]
            if _rounded(answer.value) not in requested:
                return False
            self._unconfirmed.discard(answer.number)
            return True

    def tick(self) -> None:
        """Say what is not confirmed, where it was not said lately; to be called several times a second."""
        with self._lock:
            if self._unconfirmed and self._clock.now() - self._rounded >= self._patience:
                self._say()

    def refusals(self) -> list[str]:
        """Why the robot may not be armed; empty where the board has confirmed everything."""
        with self._lock:
            names = [CHIP_PARAMETERS[number].name for number in sorted(self._unconfirmed)]
        return [f"The board has not confirmed {', '.join(names)} yet. Wait a moment."] if names else []

    def _is_open(self, number: int) -> bool:
        return number in self._unconfirmed

    def _want(self, number: int, value: float) -> None:
        with self._lock:
            # What the line carries is what is in force.
            self._values[number] = _rounded(value) / 1000
            self._unconfirmed.add(number)
            self._say()

    def _say(self) -> None:
        packets = [
            Parameter(number=number, value=self._values[number]) for number in sorted(self._unconfirmed)
        ]
        if self._send(*packets):
            self._rounded = self._clock.now()


def _rounded(value: float) -> int:
    return round(value * 1000)
