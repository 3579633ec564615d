"""Goals of the figures."""

from typing import NamedTuple


class Goal(NamedTuple):
    """A limit of a figure: the least that it should be, or the most."""

    limit: float
    is_least: bool

    def met(self, value: float) -> bool:
        """True if a figure of this value meets its goal."""
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


def _fault(name: str, told: float, off: float | None = None, rest: float | None = None) -> dict[str, Goal]:
    """s until a fault is noticed, the motors have no power, and the fins rest."""
    limits = {
        f"fault.{name}_ms_max": told,
        f"fault.{name}_off_ms_max": off,
        f"fault.{name}_rest_ms_max": rest,
    }
    return {figure: _most(1000 * limit) for figure, limit in limits.items() if limit is not None}


_CHIP = {"off": 1.015, "rest": 0.5}
"""It disarms 1 s after the last valid frame, at its next tick of 10 ms."""
_AGAIN = 2.0


GOALS = {
    "camera.fps": _least(25),
    "codec.ratio_to_cobs_zlib": _most(1.3),
    "codec.ratio_to_pymavlink": _most(1 / 6),
    "compare.open_ms": _most(1500),
    "control.crossing_ratio_max": _most(1.2),
    "control.overshoot_max": _most(0.05),
    "control.steady_cm_max": _most(2),
    "export.csv_1h_ratio": _most(1.3),
    "export.mcap_1h_ratio": _most(1.3),
    **_fault("pilot_quiet", 0.5, rest=0.5),
    **_fault("pilot_lost", 3, 3),
    **_fault("server_silent", 5, 5),
    **_fault("pi_silent", 1.2, **_CHIP),
    **_fault("line_cut", 1, **_CHIP),
    **_fault("board_silent", 1, 1),
    **_fault("loop_hung", 1, 0.5),
    **_fault("board_restarted", 1),
    **_fault("depth_stale", 0.5, 0.5),
    **_fault("depth_frozen", 0.5, 0.5),
    **_fault("depth_range", 0.5, 0.5),
    **_fault("imu_stale", 0.2, 0.2),
    **_fault("capsized", 2, 2),
    **_fault("vision_stale", 1),
    **_fault("not_rising", 20),
    **_fault("battery_low", 20.5, 20.5),
    **_fault("runtime_killed", _AGAIN, 1.1),
    **_fault("server_killed", _AGAIN),
    **_fault("server_hung", _AGAIN, 5),
    **_fault("simulator_killed", _AGAIN, 1),
    **_fault("board_killed", _AGAIN),
    "firmware.missed_ticks": _most(0),
    "firmware.missed_ticks.500000": _most(0),
    "latency.key_to_fin_ms_p95": _most(150),
    "latency.sample_to_page_ms_p95": _most(80),
    "hub.latency_ms_p50.50": _most(15),
    "hub.ratio_to_foxglove": _most(0.5),
    "link.table6_min_success": _least(1.0),
    "link.undetected_corruptions": _most(0),
    "page.fps": _least(55),
    "page.update_ms": _most(8),
    "replay.seek_ms_p95": _most(150),
    **_goodput("link.goodput"),
    **_goodput("link.goodput_chip"),
    "scenario.speed_x": _least(15),
    "scenario.speed_board_x": _least(6),
    "store.ingest_ratio": _least(50),
    # A Raspberry Pi Zero takes some thirty times as long, and looks four times a second in the thesis.
    "vision.ms_per_frame": _most(250 / 30),
    # A tick of the control node, and a picture and a half; in the thesis a picture alone is 250 ms.
    "vision.latency_ms_p99": _most(150),
}
