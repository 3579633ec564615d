"""Faults of simulated sensors."""

from dataclasses import dataclass
from math import isfinite
from typing import Literal, get_args

Kind = Literal["none", "stuck", "dropout", "spike", "drift", "bus", "wet"]
FaultOfDevice = Literal["absent", "wet"]
"""A fault of a device of the emulated board."""

DEVICES = {
    "pressure": "pressure",
    "gyroscope": "imu",
    "accelerometer": "imu",
    **{f"encoder{fin}": f"encoder{fin}" for fin in range(4)},
}
"""The emulated board's device behind each sensor on a bus. Gyroscope and accelerometer are one chip."""
LEAK = "leak"
"""The leak sensor, a device of the board: it measures nothing of the water outside, and is dry or wet."""
SENSORS = (*DEVICES, "beacon_right", "beacon_left", "battery", LEAK)

_NUMBERS: dict[str, tuple[str, ...]] = {
    "dropout": ("share",),
    "spike": ("share", "size"),
    "drift": ("speed",),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedFault:
    """A sensor's fault. Raises ValueError if the numbers do not belong to the kind."""

    kind: Kind = "none"
    """stuck: repeats its last reading. dropout: some readings are lost, and the last one is repeated.
    spike: some readings jump up or down. drift: the offset grows steadily. bus: the part does not answer.
    wet: there is water at the leak sensor."""
    share: float | None = None
    """Share of the readings that drop out or jump, above 0, at most 1."""
    size: float | None = None
    """Jump of a reading, in the sensor's unit, above 0."""
    speed: float | None = None
    """Growth of the offset, in the sensor's unit per second."""

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise ValueError(f"there is no fault {self.kind!r}; there are {', '.join(get_args(Kind))}")
        allowed = _NUMBERS.get(self.kind, ())
        for name in ("share", "size", "speed"):
            value = getattr(self, name)
            if (value is not None) != (name in allowed):
                takes = " and ".join(allowed) or "no numbers"
                raise ValueError(f"the fault {self.kind} takes {takes}")
            if value is not None and not isfinite(value):
                raise ValueError(f"a fault's {name} is {value}; it must be finite")
        if self.share is not None and not 0 < self.share <= 1:
            raise ValueError(f"a fault's share is {self.share:g}; it must be above 0 and at most 1")
        if self.size is not None and not self.size > 0:
            raise ValueError(f"a fault's size is {self.size:g}; it must be above 0")


NO_FAULT = SimulatedFault()


def check_sensor(sensor: str, fault: SimulatedFault) -> None:
    """Raise ValueError if there is no such sensor, or it cannot have this fault."""
    if sensor not in SENSORS:
        raise ValueError(f"there is no sensor {sensor!r}; there are {', '.join(SENSORS)}")
    if fault.kind != "none" and (fault.kind == "wet") != (sensor == LEAK):
        raise ValueError(f"{sensor} cannot be {fault.kind}: the leak sensor has the fault wet, and no other")
    if fault.kind == "bus" and sensor not in DEVICES:
        raise ValueError(f"{sensor} is on no bus; choose stuck or dropout")
