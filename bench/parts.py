"""The parts of the measurement, in their order."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BenchPart:
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
        BenchPart("heap", is_emulated=True, is_long=True, prefix="page.heap_growth"),
        BenchPart("firmware", is_emulated=True, is_long=True, prefix="firmware.missed_ticks"),
        BenchPart("comm_test", is_emulated=True, is_long=True, prefix="link.table6"),
        BenchPart("sweep_rows", is_emulated=True, is_long=True, prefix="sweep_rows."),
        BenchPart("gym_episodes", is_emulated=True, is_long=True, prefix="gym_episodes."),
        BenchPart("identify", is_emulated=True),
        BenchPart("hostile", is_emulated=True),
        BenchPart("control", is_emulated=True),
        BenchPart("fault", is_emulated=True),
        BenchPart("corruption", is_emulated=True),
        BenchPart("chip", is_emulated=True),
        BenchPart("hour", is_emulated=True),
        BenchPart("setpoint", is_emulated=True),
        BenchPart("tuning", is_emulated=True),
        BenchPart("link", is_emulated=True),
        BenchPart("emulator"),
        BenchPart("physics"),
        BenchPart("scenario"),
        BenchPart("mission"),
        BenchPart("sweep"),
        BenchPart("gym"),
        BenchPart("camera"),
        BenchPart("vision"),
        BenchPart("fly"),
        BenchPart("film"),
        BenchPart("codec"),
        BenchPart("outage"),
        BenchPart("store"),
        BenchPart("export"),
        BenchPart("archive"),
        BenchPart("connection"),
        BenchPart("start"),
        BenchPart("latency", draws=True),
        BenchPart("compare", draws=True),
        BenchPart("story", draws=True),
        BenchPart("replay", draws=True),
        BenchPart("stack"),
        BenchPart("quota", is_long=True, prefix="quota."),
        BenchPart("decoder", is_long=True, prefix="decoder."),
        BenchPart("router"),
        BenchPart("hub"),
        BenchPart("doors"),
        BenchPart("flight", draws=True),
        BenchPart("page", draws=True),
        BenchPart("session_list", draws=True),
    )
}
