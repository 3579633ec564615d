"""What the figures should come to."""

from typing import NamedTuple


class Goal(NamedTuple):
    """A limit of a figure: the least that it should be, or the most."""

    limit: float
    is_least: bool

    def met(self, value: float) -> bool:
        """Whether a figure of this value is good enough."""
        return value >= self.limit if self.is_least else value <= self.limit

    def __str__(self) -> str:
        return f"{'≥' if self.is_least else '≤'} {self.limit:.3g}"


def _least(limit: float) -> Goal:
    return Goal(limit, is_least=True)


def _most(limit: float) -> Goal:
    return Goal(limit, is_least=False)


def _goodput(name: str) -> dict[str, Goal]:
    bauds = (1200, 9600, 115_200, 250_000)
    small = {f"{name}.{baud}.6": _least(0.60 if baud == 1200 else 0.70) for baud in bauds}
    large = {f"{name}.{baud}.18": _least(0.70 if baud == 1200 else 0.80) for baud in bauds}
    return small | large | {f"{name}_ber_1e-4": _least(0.70), f"{name}_ber_1e-3": _least(0.40)}


GOALS = {
    "camera.fps": _least(25),
    "codec.ratio_to_cobs_zlib": _most(1.3),
    "codec.ratio_to_pymavlink": _most(1 / 6),
    "compare.open_ms": _most(1500),
    "export.csv_1h_ratio": _most(1.3),
    "export.mcap_1h_ratio": _most(1.3),
    "firmware.missed_ticks": _most(0),
    "firmware.missed_ticks.500000": _most(0),
    "link.table6_min_success": _least(1.0),
    "link.undetected_corruptions": _most(0),
    "replay.seek_ms_p95": _most(150),
    **_goodput("link.goodput"),
    **_goodput("link.goodput_chip"),
    "scenario.speed_x": _least(15),
    "scenario.speed_board_x": _least(6),
    "store.ingest_ratio": _least(50),
}
