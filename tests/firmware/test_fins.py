"""The fin law and the position loop."""

import ctypes
import math
from collections.abc import Iterator
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.devices import MotorDevice

TICK = 0.01
ZEROS, SIGNS = (188, 161, 726, 356), (1, 1, -1, -1)
angles = st.floats(-3.125, 3.125, width=32)
counts = st.integers(0, 1023)
fins = st.integers(0, 3)


def between(angle: float, other: float) -> float:
    """Return the shortest angle from one to the other."""
    return abs(math.remainder(angle - other, math.tau))


class Law:
    """One fin's law, and its share of the phase."""

    def __init__(self, firmware: ctypes.CDLL, angle: float = 0.0) -> None:
        self.firmware = firmware
        self.law = firmware.law_create(angle)
        self.phase = 0

    def step(self, direction: float, amplitude: float) -> float:
        self.phase = (self.phase + self.firmware.law_phase_per_tick()) % 65536
        return float(self.firmware.law_step(self.law, direction, amplitude, self.phase))

    def flapping(self) -> bool:
        return bool(self.firmware.law_flapping(self.law))


@pytest.fixture
def law(firmware: ctypes.CDLL) -> Iterator[Law]:
    made = Law(firmware)
    yield made
    firmware.law_destroy(made.law)


def test_fin_flaps_about_its_direction_at_the_published_frequency(law: Law) -> None:
    for _ in range(50):
        law.step(-0.5, 1.6)
    expected = [law.step(-0.5, 1.6) for _ in range(1000)]
    assert max(expected) == pytest.approx(-0.5 + 0.8, abs=2e-3)
    assert min(expected) == pytest.approx(-0.5 - 0.8, abs=2e-3)
    rising = sum(a < -0.5 <= b for a, b in pairwise(expected))
    assert rising == 13
    # The law itself, a second and a half later: direction + amplitude / 2 · sin(2π f t).
    start = 1050 * TICK
    for tick in range(1, 150):
        now = law.step(-0.5, 1.6)
        assert now == pytest.approx(-0.5 + 0.8 * math.sin(math.tau * 1.3 * (start + tick * TICK)), abs=5e-3)


def test_phases_are_the_published_ones(firmware: ctypes.CDLL) -> None:
    phases = [firmware.law_fin_phase(fin) / 65536 * math.tau for fin in range(4)]
    assert phases == pytest.approx([math.pi, 0, 0, math.pi])


@given(start=angles, goal=angles)
def test_direction_turns_no_faster_than_80_counts_in_a_tenth_of_a_second(
    firmware: ctypes.CDLL, start: float, goal: float
) -> None:
    law = Law(firmware, start)
    before = start
    for _ in range(10):
        now = law.step(goal, 0.0)
        assert between(now, before) <= 8 / 1024 * math.tau + 1e-5
        before = now
    turned = between(now, start)
    assert turned == pytest.approx(min(between(goal, start), 80 / 1024 * math.tau), abs=1e-4)
    # The shortest way: what was turned and what is left make up the whole.
    assert turned + between(goal, now) == pytest.approx(between(goal, start), abs=1e-4)
    for _ in range(70):
        now = law.step(goal, 0.0)
    firmware.law_destroy(law.law)
    assert between(now, goal) == pytest.approx(0, abs=1e-5)


def test_flapping_begins_and_ends_within_130_ms(firmware: ctypes.CDLL, law: Law) -> None:
    quarter = 0x4000
    growing = [firmware.law_step(law.law, 0.0, 1.6, quarter) for _ in range(13)]
    assert growing == pytest.approx([min(0.8, 0.8 * tick / 12) for tick in range(1, 14)], abs=1e-5)
    assert law.flapping()
    fading = [firmware.law_step(law.law, 0.0, 0.0, quarter) for _ in range(13)]
    assert fading == pytest.approx([max(0.0, 0.8 - 0.8 * tick / 12) for tick in range(1, 14)], abs=1e-5)
    assert fading[-1] == 0
    assert not law.flapping()


@given(value=st.integers(-(2**15), 2**15 - 513))
def test_counts_wrap(firmware: ctypes.CDLL, value: int) -> None:
    assert firmware.firmware_wrap_counts(value) == (value + 512) % 1024 - 512


@given(fin=fins, angle=angles)
def test_counts_and_angles_agree_with_the_convention(firmware: ctypes.CDLL, fin: int, angle: float) -> None:
    """Counts are zero - φ · 1024 / 2π, and the fin's angle is rotation_sign · φ."""
    shaft = SIGNS[fin] * angle
    match = firmware.firmware_counts_from_angle(fin, angle)
    assert match == pytest.approx(ZEROS[fin] - shaft * 1024 / math.tau, abs=0.51)
    assert between(firmware.firmware_angle_from_counts(fin, match % 1024), angle) <= math.tau / 1024


class FinLoop:
    def __init__(self, firmware: ctypes.CDLL) -> None:
        self.firmware = firmware
        self.loop = firmware.loop_create()

    def step(self, fin: int, goal: int, measured: int) -> int:
        return int(self.firmware.loop_step(self.loop, fin, goal, measured))


@pytest.fixture
def loop(firmware: ctypes.CDLL) -> Iterator[FinLoop]:
    made = FinLoop(firmware)
    yield made
    firmware.loop_destroy(made.loop)


@given(fin=fins, goal=st.integers(-1024, 2047), measured=counts)
def test_loop_drives_the_shortest_way_round(
    firmware: ctypes.CDLL, fin: int, goal: int, measured: int
) -> None:
    error = (goal - measured + 512) % 1024 - 512
    loop = FinLoop(firmware)
    drive = loop.step(fin, goal, measured)
    firmware.loop_destroy(loop.loop)
    # A positive drive lowers the counts: the encoder sign is -1.
    if abs(error) <= 3:
        assert drive == 0
    else:
        assert math.copysign(1, drive) == -math.copysign(1, error)
        assert 6 <= abs(drive) <= 40
    if abs(error) >= 64:
        assert abs(drive) == 40


def test_loop_crosses_the_encoders_end(loop: FinLoop) -> None:
    assert loop.step(0, 1020, 4) > 0
    assert loop.step(0, 1020 - 1024, 4) > 0


def test_loop_damps_a_fin_that_approaches_fast(firmware: ctypes.CDLL) -> None:
    slow, fast = FinLoop(firmware), FinLoop(firmware)
    for loop, before in ((slow, 160), (fast, 120)):
        loop.step(0, 200, before)
    drives = [loop.step(0, 200, 162) for loop in (slow, fast)]
    for loop in (slow, fast):
        firmware.loop_destroy(loop.loop)
    assert abs(drives[1]) < abs(drives[0])


@pytest.mark.parametrize("fin", range(4))
@pytest.mark.parametrize("goal", [0.0, 1.57, -1.57, 3.1, -3.1])
@pytest.mark.parametrize("start", [-2.5, 0.3, 3.0])
def test_loop_brings_every_fin_to_its_angle_and_rests(
    firmware: ctypes.CDLL, fin: int, goal: float, start: float
) -> None:
    motor = MotorDevice(ZEROS[fin], SIGNS[fin], shaft=SIGNS[fin] * start)
    loop = FinLoop(firmware)
    expected = firmware.firmware_counts_from_angle(fin, goal)
    drives = []
    for _ in range(150):
        drives.append(loop.step(fin, expected, motor.counts % 1024))
        motor.turn(drives[-1], TICK)
    firmware.loop_destroy(loop.loop)
    assert between(motor.fin, goal) < math.radians(2)
    assert drives[-20:] == [0] * 20
