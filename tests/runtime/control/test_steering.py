"""Steering by two detectors that report only if they see a light."""

from robot_runtime.control.steering import SEARCH_SECONDS, BeaconSteering


def test_a_light_ahead_gives_straight_motion() -> None:
    surge, yaw = BeaconSteering().step(right=True, left=True, seconds=0.1)
    assert surge > 0
    assert yaw == 0


def test_it_turns_to_the_side_that_sees_the_light() -> None:
    steering = BeaconSteering()
    assert steering.step(right=True, left=False, seconds=0.1)[1] > 0
    assert steering.step(right=False, left=True, seconds=0.1)[1] < 0


def test_a_lost_light_is_searched_on_its_last_side_for_a_limited_time() -> None:
    steering = BeaconSteering()
    steering.step(right=False, left=True, seconds=0.1)
    looking = [steering.step(right=False, left=False, seconds=1.0) for _ in range(int(SEARCH_SECONDS) + 1)]
    assert all(surge == 0 for surge, _ in looking)
    assert all(yaw < 0 for _, yaw in looking[:-1])
    assert looking[-1] == (0.0, 0.0)
    steering.step(right=True, left=False, seconds=0.1)
    assert steering.step(right=False, left=False, seconds=1.0)[1] > 0
