"""The last frames in each direction."""

from robot_runtime.link.frame_ring import FrameRing


def test_the_last_hundred_each_way_stand_in_order_of_time() -> None:
    ring = FrameRing()
    for number in range(250):
        ring.add_sent(bytes([number, 1, 0]), 7, number + 0.5)
        ring.add_received(bytes([number, 2]), 7, number)
    lines = ring.dump().splitlines()
    assert len(lines) == 200
    assert lines[:2] == ["150.000 <- 9602", "150.500 -> 9601"]
    assert lines[-1] == "249.500 -> f901"
