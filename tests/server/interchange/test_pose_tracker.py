"""The times at which there is a pose."""

from robot_runtime.contract import topics
from server.interchange.pose_tracker import PERIOD_NS, PoseTracker


def test_poses_go_on_after_the_clock_was_set_back() -> None:
    tracker = PoseTracker()
    tracker.see(topics.TRUTH.name, 0, {"position": (0.0, 0.0, 1.0)}.get)

    def count(start: int) -> int:
        times = range(start, start + 10 * PERIOD_NS, PERIOD_NS // 5)
        level = {"attitude": (1.0, 0.0, 0.0, 0.0)}.get
        return sum(tracker.see(topics.IMU.name, time, level) is not None for time in times)

    assert count(600_000_000_000) == 10
    assert count(0) == 10
