"""The goals of the figures: every one that was ever set, also those that are missed."""

from dataclasses import dataclass

from bench.calibration import Slowness, Work


@dataclass(frozen=True, slots=True)
class Goal:
    """The limit of a figure: the least value that is good enough, or the greatest.

    `work` names the calibration by which the limit is scaled: a machine that takes twice as long for that
    work as the reference machine may take twice as long, or do half as much. Without it the limit is the same
    everywhere: ratios to a peer of the same run, counts, and times that people or the robot's safety ask for.
    """

    limit: float
    is_least: bool
    work: Work | None = None

    def scaled(self, slowness: Slowness) -> "Goal":
        """Return the goal of a machine so slow."""
        if self.work is None:
            return self
        factor = slowness.get(self.work, 1.0)
        return Goal(self.limit / factor if self.is_least else self.limit * factor, self.is_least)

    def is_met(self, value: float) -> bool:
        """Return True for a good enough figure."""
        return value >= self.limit if self.is_least else value <= self.limit

    def __str__(self) -> str:
        return f"{'≥' if self.is_least else '≤'} {self.limit:.3g}"


def _least(limit: float, work: Work | None = None) -> Goal:
    return Goal(limit, is_least=True, work=work)


def _most(limit: float, work: Work | None = None) -> Goal:
    return Goal(limit, is_least=False, work=work)


def _goodput(name: str) -> dict[str, Goal]:
    bauds = (1200, 9600, 115_200, 250_000)
    small = {f"{name}.{baud}.6": _least(0.60 if baud == 1200 else 0.70) for baud in bauds}
    large = {f"{name}.{baud}.18": _least(0.70 if baud == 1200 else 0.80) for baud in bauds}
    return small | large | {f"{name}_ber_1e-4": _least(0.70), f"{name}_ber_1e-3": _least(0.40)}


def _fault(name: str, noticed: float, off: float | None = None, rest: float | None = None) -> dict[str, Goal]:
    """Return the goals in s until a fault is noticed, the motors have no power, and the fins rest."""
    limits = {
        f"fault.{name}_ms_max": noticed,
        f"fault.{name}_off_ms_max": off,
        f"fault.{name}_rest_ms_max": rest,
    }
    return {figure: _most(1000 * limit) for figure, limit in limits.items() if limit is not None}


_CHIP = {"off": 1.015, "rest": 0.5}
"""It disarms 1 s after the last valid frame, at its next tick of 10 ms."""
_AGAIN = 2.0
"""s until a killed process is back."""

GOALS = {
    "camera.fps": _least(25, "memory"),
    # Peers as they are used: COBS and CRC-32 around a payload, and MAVLink from fields to fields. Python
    # meets neither goal: the shortest code that makes our frames takes 2.7 times as long as the first peer
    # (3.3, of which `ratio_to_same_frame` is 1.24); a sixth of the second's 9.1 µs is less than the 1.7 µs
    # that a frame takes there and back without any field.
    "codec.ratio_to_cobs_zlib": _most(1.3),
    "codec.ratio_to_pymavlink": _most(1 / 6),
    "compare.open_ms": _most(1500, "python"),
    "compare.page_open_ms": _most(1500, "python"),
    "control.crossing_ratio_max": _most(1.2),
    "control.overshoot_max": _most(0.05),
    "control.steady_cm_max": _most(2),
    # Missed; docs/run/computers.md has the figures. What remains are some thirty rounds a second from
    # the line to the viewer, each of which costs mostly its waking up. Fewer of them make the controllers
    # swing wider, and by an estimate would miss `latency.sample_to_page_ms_p95`.
    "cpu.robot_stack_percent": _most(2.5, "python"),
    "cpu.robot_stack_lean_percent": _most(1.5, "python"),
    "decoder.alarm_s.hang": _most(1.5),
    "decoder.armed_at_the_end": _least(1),
    "decoder.named_s.crash": _most(1),
    "decoder.pictures_again_s.crash": _most(_AGAIN),
    **{f"doors.{door}.latency_ms_p95.10": _most(80) for door in ("rosbridge", "foxglove", "ros2")},
    **{f"doors.{door}.stalled_ratio": _most(1.5) for door in ("rosbridge", "foxglove", "ros2")},
    "export.csv_1h_ratio": _most(1.3),
    "export.mcap_1h_ratio": _most(1.3),
    "fly.redraws_per_s": _least(55),
    **_fault("pilot_quiet", 0.5, rest=0.5),
    **_fault("pilot_lost", 3, 3),
    **_fault("server_silent", 5, 5),
    **_fault("unwatched", 30, 30),
    **_fault("pi_silent", 1.2, **_CHIP),
    **_fault("line_cut", 1, **_CHIP),
    **_fault("board_silent", 1, 1),
    **_fault("loop_hung", 1, 0.5),
    **_fault("board_restarted", 1),
    **_fault("depth_stale", 0.5, 0.5),
    **_fault("depth_frozen", 0.5, 0.5),
    **_fault("depth_range", 0.5, 0.5),
    **_fault("too_deep", 0.5, 0.5),
    **_fault("imu_stale", 0.2, 0.2),
    **_fault("imu_frozen", 0.5, 0.5),
    **_fault("capsized", 2, 2),
    **_fault("vision_stale", 1),
    **_fault("not_rising", 20),
    # Until the motors have no power, 20.5 before: the host's STOP cut it, and no fin turned down.
    **_fault("battery_low", 20.5, 22.0),
    **_fault("leak", 0.5, 0.3),
    **_fault("memory_low", 0.5, 0.5),
    **_fault("runtime_killed", _AGAIN, 1.1),
    **_fault("server_killed", _AGAIN),
    **_fault("server_hung", _AGAIN, 5),
    **_fault("simulator_killed", _AGAIN, 1),
    **_fault("scene_killed", _AGAIN),
    **_fault("vision_killed", _AGAIN),
    **_fault("board_killed", _AGAIN),
    "fault.restart_s_max": _most(_AGAIN),
    "firmware.hostile_missed_ticks": _most(0),
    "firmware.missed_ticks": _most(0),
    "firmware.missed_ticks.500000": _most(0),
    "firmware.stack_margin_bytes": _least(100),
    # Of the full size, 640 × 480; smaller ones come where the computer has no time.
    "fly.picture_age_ms_p95": _most(150, "memory"),
    "fly.picture_hz": _least(14.5),
    "film.picture_hz": _least(14.5),
    "film.export_speed": _least(5),
    "film.export_speed_lines": _least(5),
    "film.seek_ms_p95": _most(200),
    "latency.key_to_fin_ms_p95": _most(150),
    "latency.sample_to_page_ms_p95": _most(80),
    # Ten times as fast as the water; a hundred episodes of each agent.
    "gym.steps_per_s": _least(100, "python"),
    "gym_episodes.pid": _least(100),
    "gym_episodes.pid_share": _least(0.9),
    "gym_episodes.random": _least(100),
    "hub.latency_ms_p50.50": _most(15, "python"),
    # Missed: 1.37, 0.87 and 0.47; on a busy machine 1.6, 1.0 and 0.54. foxglove-sdk, written
    # in Rust, serves from the process that makes the samples. Our server gets them over Zenoh from another
    # process; with one viewer a third of its time goes to Zenoh's thread and to that of its callback.
    "hub.ratio_to_foxglove.1": _most(1.0),
    "hub.ratio_to_foxglove.10": _most(0.7),
    "hub.ratio_to_foxglove.50": _most(0.4),
    # In percent of the true number; of the buoyancy, of its surplus over the weight. Missed for numbers that
    # are weakly seen: up to 25 over 8 crafts; 3.5 for those that are seen well. The robot moves sideways and
    # backwards in curves and drifts only, so that sessions show little of these dampings' split.
    "identify.error_percent_max": _most(5),
    "identify.weak_error_percent_max": _most(10),
    "identify.prediction_gain_min": _least(5),
    "link.table6_min_success": _least(1.0),
    "link.undetected_corruptions": _most(0),
    "archive.ingest_sqlite_s": _most(3),
    "archive.ingest_postgresql_s": _most(3),
    "archive.query_sqlite_s": _most(1),
    "archive.query_postgresql_s": _most(1),
    "archive.comparison_sqlite_s": _most(1),
    "archive.comparison_postgresql_s": _most(1),
    "list.frame_ms_max": _most(50, "drawing"),
    "list.open_ms": _most(500),
    # A Raspberry Pi Zero takes some thirty times as long: 4 % of it at 10 Hz, and 2 s for the first load.
    "mission.tick_us": _most(0.04 / 10 / 30 * 1e6, "python"),
    "mission.load_ms": _most(2000 / 30, "python"),
    "page.heap_growth_mb_per_h": _most(2),
    # The traces are drawn anew at each half pixel that they move, which is 45 times a second over a minute.
    "page.redraws_per_s": _least(45),
    "page.redraws_per_s.10s": _least(55),
    "page.redraw_ms": _most(8, "drawing"),
    "physics.speed_x": _least(25, "python"),
    # The goal is 90 MB on 32 bits, which are 118 MB on 64, by the same processes on both. Missed: 101 MB on
    # 32 bits, 137 MB on 64. Of the server's 57 MB 43 are libraries and code that it has loaded; Debian's
    # OpenCV takes 15 of the runtime's 37 MB, since it is linked to 384 libraries.
    "quota.anonymous_mb.natively": _most(118),
    # Missed: 46 and 74 ms, on a machine so busy that it was 13 and 38 ms without the quota. The quota is
    # used up, and the kernel then stops all threads for up to 24 ms, the control loop's as well.
    "quota.jitter_ms_p99.quota": _most(20),
    "quota.samples_lost.quota": _most(0),
    "quota.ticks_left_out.quota": _most(0),
    "quota.viewer_lost.quota": _most(0),
    "replay.page_seek_ms_p95": _most(150, "python"),
    "replay.seek_ms_p95": _most(150, "python"),
    **_goodput("link.goodput"),
    **_goodput("link.goodput_chip"),
    "router.cpu_percent": _most(2, "python"),
    "router.presences_heard": _least(0.99),
    "router.stop_ms_max": _most(500),
    "scenario.speed_x": _least(15, "python"),
    "scenario.speed_board_x": _least(6, "python"),
    # Missed since they were set: both services together take some 3.5 s of a processor here until page and
    # board are there, which is 88 s with 1/25 of a core.
    "start.quota_linked_s": _most(8, "python"),
    "start.quota_page_s": _most(15, "python"),
    "story.hour_ms": _most(1000, "python"),
    "story.eight_hours_ms": _most(2000, "python"),
    "store.ingest_ratio": _least(50, "python"),
    # 8 x 5 gains with 3 seeds.
    "sweep_rows.equal": _least(120),
    **{
        f"sweep.{on}{name}": goal
        for on in ("", "dask_")
        for name, goal in (("overhead_percent", _most(3)), ("speed_up_two_x", _least(1.8)))
    },
    # A Raspberry Pi Zero takes some thirty times as long, and looks four times a second in the thesis.
    "vision.ms_per_frame": _most(250 / 30, "memory"),
    # A tick of the control node, and a picture and a half; in the thesis a picture alone is 250 ms.
    "vision.latency_ms_p99": _most(150),
}
