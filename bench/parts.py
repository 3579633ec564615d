"""The parts of the measurement, in their order."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Part:
    """A module of this package with a function `measure`, which returns figures by name."""

    name: str
    is_emulated: bool = False
    """Its figures do not hang on how much time passes in reality, so that it may share the computer."""
    draws: bool = False
    """It draws in a browser."""
    is_long: bool = False
    """It takes many minutes; `make proofs` runs it, or whoever names it."""
    prefix: str = ""
    """Of a long part: the beginning of its figures' names."""


PARTS = {
    part.name: part
    for part in (
        # The longest first, so that no core waits for one at the end.
        Part("heap", is_emulated=True, is_long=True, prefix="page.heap_growth"),
        Part("firmware", is_emulated=True, is_long=True, prefix="firmware.missed_ticks"),
        Part("comm_test", is_emulated=True, is_long=True, prefix="link.table6"),
        Part("identify", is_emulated=True),
        Part("hostile", is_emulated=True),
        Part("control", is_emulated=True),
        Part("fault", is_emulated=True),
        Part("corruption", is_emulated=True),
        Part("chip", is_emulated=True),
        Part("hour", is_emulated=True),
        Part("setpoint", is_emulated=True),
        Part("tuning", is_emulated=True),
        Part("link", is_emulated=True),
        Part("emulator"),
        Part("physics"),
        Part("scenario"),
        Part("mission"),
        Part("camera"),
        Part("vision"),
        Part("codec"),
        Part("outage"),
        Part("store"),
        Part("export"),
        Part("connection"),
        Part("start"),
        Part("latency", draws=True),
        Part("compare", draws=True),
        Part("replay", draws=True),
        Part("stack"),
        Part("quota", is_long=True, prefix="quota."),
        Part("decoder", is_long=True, prefix="decoder."),
        Part("hub"),
        Part("doors"),
        Part("page", draws=True),
    )
}
