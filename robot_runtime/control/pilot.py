"""The pilot's input: the newest valid command of the client that holds the control lease."""

import json
import math
from collections import Counter
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import Navigation
from robot_runtime.errors import RefusedError

PILOT = "pilot"
"""The Zenoh topic of the input, which the server publishes."""
AGE_MAX = 0.3
"""s by which an input may be older or newer than this clock."""
PATIENCE = 0.2
"""s for which an input is valid. While a stick is held, 20 arrive in a second, so that some may be late.

Flapping fins take 0.25 s to rest: together less than 0.5 s.
"""
PILOT_LOOK = 0.05
"""s between two checks of the pilot's silence, at most."""
EPOCHS_AHEAD = 1000
"""Epochs by which a lease may be ahead of this clock's milliseconds, which the server's never are."""
NUMBER_MAX = 2**53
"""Greatest sequence number, as JavaScript counts them."""
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
NEUTRAL = Navigation(x=0.0, y=0.0, z=0.0, roll=0.0, pitch=0.0, yaw=0.0)


class Pilot:
    """The pilot's newest input, taken from any thread; `dropped` counts the rejected ones by reason."""

    def __init__(self, clock: Clock) -> None:
        self.lease = 0
        """Epoch of the control lease; input of another epoch is dropped."""
        self.taken = float("-inf")
        """s; time at which the newest input left the sticks, or manual control began."""
        self.dropped: Counter[str] = Counter()
        self._clock = clock
        self._sequence = -1
        self._command = NEUTRAL

    def begin(self) -> None:
        """Start manual control with neutral sticks."""
        self.taken, self._command = self._clock.now(), NEUTRAL

    def change_lease(self, epoch: int) -> None:
        """Accept only input of this lease from now on. Raise RefusedError for an older or a future epoch.

        An epoch of the far future would refuse every later one.
        """
        if not 0 <= epoch <= self._clock.now() * 1000 + EPOCHS_AHEAD:
            raise RefusedError("the lease is not of this time")
        if epoch < self.lease:
            raise RefusedError(f"the lease {epoch} is older than {self.lease}, the present one")
        if epoch > self.lease:
            self.lease, self._sequence, self._command = epoch, -1, NEUTRAL

    def take(self, payload: bytes) -> bool:
        """Take an input as JSON: lease, sequence, taken (s, steady clock), axes (six shares, -1 to 1).

        Return True if it is valid.
        """
        try:
            lease, sequence, taken, axes = _read(json.loads(payload))
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            self.dropped["invalid"] += 1
            return False
        now = self._clock.now()
        if lease != self.lease:
            self.dropped["lease"] += 1
        elif sequence <= self._sequence:
            self.dropped["sequence"] += 1
        elif not abs(now - taken) <= AGE_MAX:
            self.dropped["age"] += 1
        else:
            self._sequence = sequence
            self.taken, self._command = min(taken, now), Navigation(**dict(zip(AXES, axes, strict=True)))
            return True
        return False

    @property
    def quiet(self) -> bool:
        """True if the newest input is too old to use."""
        return not self._clock.now() - self.taken <= PATIENCE

    @property
    def next_check(self) -> float:
        """The time (s, steady clock) at which to look again whether the pilot is quiet."""
        now = self._clock.now()
        return now + PILOT_LOOK if self.quiet else min(now + PILOT_LOOK, self.taken + PATIENCE)

    def command(self) -> Navigation:
        """Return the newest input; neutral if it is too old."""
        return NEUTRAL if self.quiet else self._command


def _read(table: Any) -> tuple[int, int, float, list[float]]:
    """Return the fields of an input. Raise ValueError, TypeError, KeyError or OverflowError."""
    lease, sequence, taken, axes = (table[name] for name in ("lease", "sequence", "taken", "axes"))
    if type(lease) is not int or type(sequence) is not int or type(axes) is not list:
        raise TypeError("lease and sequence are whole numbers, axes a list")
    if not 0 <= sequence <= NUMBER_MAX:
        raise ValueError("sequence counts from 0")
    numbers = [taken, *axes]
    if len(axes) != len(AXES) or not all(type(number) in (int, float) for number in numbers):
        raise TypeError("taken and six axes are numbers")
    if not all(math.isfinite(number) for number in numbers) or not all(abs(axis) <= 1 for axis in axes):
        raise ValueError("taken and axes are finite, axes between -1 and 1")
    return lease, sequence, float(taken), [float(axis) for axis in axes]
