"""The times at which the doors have a pose."""

from server.features.doors.channels import Sample
from server.features.doors.pose_tracker import PoseTracker
from server.features.exports.pose import PERIOD_NS
from tests.server.features.doors.rig import imu, truth

LEVEL = (1.0, 0.0, 0.0, 0.0)


def test_poses_go_on_after_the_clock_was_set_back() -> None:
    tracker = PoseTracker()
    tracker.see(Sample("truth", 0, truth((0.0, 0.0, 1.0), LEVEL)))

    def count(start: int) -> int:
        times = range(start, start + 10 * PERIOD_NS, PERIOD_NS // 5)
        return sum(tracker.see(Sample("imu", time, imu(LEVEL))) is not None for time in times)

    assert count(600_000_000_000) == 10
    assert count(0) == 10
