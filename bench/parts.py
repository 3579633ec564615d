"""The parts of the measurement, in their order."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Part:
    """A module of this package with a function `measure`, which returns figures by name."""

    name: str
    is_emulated: bool = False
    """Its figures hang on emulated or simulated time alone, so that it may share the computer with others."""
    draws: bool = False
    """It draws in a browser."""
    is_long: bool = False
    """It takes longer than all others together; `make proofs` runs it, or whoever names it."""


PARTS = {
    part.name: part
    for part in (
        Part("corruption", is_emulated=True),
        Part("chip", is_emulated=True),
        Part("link", is_emulated=True),
        Part("setpoint", is_emulated=True),
        Part("control", is_emulated=True),
        Part("tuning", is_emulated=True),
        Part("firmware", is_emulated=True, is_long=True),
        Part("comm_test", is_emulated=True, is_long=True),
        Part("emulator"),
        Part("physics"),
        Part("scenario"),
        Part("camera"),
        Part("vision"),
        Part("codec"),
        Part("fault"),
        Part("store"),
        Part("export"),
        Part("connection"),
        Part("start"),
        Part("stack"),
        Part("latency", draws=True),
        Part("compare", draws=True),
        Part("replay", draws=True),
        Part("jitter"),
        Part("hub"),
        Part("page", draws=True),
    )
}
