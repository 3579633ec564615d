"""The battery's time: an estimate of how long it lasts, from its voltage and its capacity."""

from collections.abc import Callable
from math import exp

from robot_runtime.contract.battery_pack import seconds_left
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.packets import Status
from robot_runtime.contract.power_budget import dive_power
from robot_runtime.contract.topics import STATUS
from robot_runtime.transport.bus import Bus

MEASURED = 1.0
"""V; a battery that shows less has no divider on the board's input, so that it is not measured."""
SMOOTHING = 30.0
"""s, time constant of the voltage's filter: some forty strokes."""
_FIRST = 5.0
"""s of readings after a start that are neither filtered nor estimated from: the board begins to measure."""


class BatteryGauge:
    """The time until the low-battery alarm, as if all fins swam at the most from now on.

    Nothing measures the current, so the load is the power budget's. The bus fills it from any thread.
    """

    def __init__(self, bus: Bus) -> None:
        self.capacity = 0.0
        """Ah of the pack; 0: not known, so that there is no estimate."""
        self.alarm: Callable[[], float] = lambda: 0.0
        """Returns the V of the low-battery alarm."""
        self._power = dive_power(Craft())
        self._volts: float | None = None
        self._begun = self._seen = 0.0
        bus.on_row(STATUS, self._take_status)

    @property
    def left(self) -> float | None:
        """The time (s) until the alarm; None where the capacity or the voltage is not known."""
        if not self.capacity or self._volts is None or self._seen - self._begun < _FIRST:
            return None
        return seconds_left(self._volts, self.alarm(), self.capacity, self._power)

    def _take_status(self, time: float, record: bytes) -> None:
        volts = Status.from_bytes(record).battery
        if volts < MEASURED:
            self._volts = None
        elif self._volts is None:
            self._volts, self._begun = volts, time
        elif time - self._begun < _FIRST:
            self._volts = volts
        else:
            self._volts += (volts - self._volts) * (1 - exp(-max(time - self._seen, 0.0) / SMOOTHING))
        self._seen = time
