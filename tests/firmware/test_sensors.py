"""The sensors' arithmetic: encoder words, pressure compensation, attitude, battery."""

import ctypes
import math
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.experiments.bring_up.checks import OF_02BA
from tests.firmware.devices import PressureSensor, compensate, encoder_word

PROM = PressureSensor().prom


@given(counts=st.integers(0, 1023))
def test_encoder_gives_its_counts(firmware: ctypes.CDLL, counts: int) -> None:
    assert firmware.firmware_encoder_counts(encoder_word(counts)) == counts


@given(counts=st.integers(0, 1023), bit=st.integers(0, 15))
def test_encoder_word_with_a_flipped_bit_is_refused(firmware: ctypes.CDLL, counts: int, bit: int) -> None:
    assert firmware.firmware_encoder_counts(encoder_word(counts) ^ 1 << bit) == -1


@pytest.mark.parametrize(
    "word",
    [
        0xFFFF,
        0x0000,
        encoder_word(500, ready=0),
        encoder_word(500, overflow=1),
        encoder_word(500, nonlinear=1, increase=1, decrease=1),
    ],
)
def test_readings_of_a_missing_or_faulty_encoder_are_refused(firmware: ctypes.CDLL, word: int) -> None:
    assert firmware.firmware_encoder_counts(word) == -1


def test_an_encoder_may_report_a_moving_or_weak_magnet(firmware: ctypes.CDLL) -> None:
    assert firmware.firmware_encoder_counts(encoder_word(500, increase=1, decrease=1)) == 500
    assert firmware.firmware_encoder_counts(encoder_word(500, increase=1)) == 500
    assert firmware.firmware_encoder_counts(encoder_word(500, decrease=1)) == 500


def as_array(prom: list[int]) -> ctypes.Array[ctypes.c_uint16]:
    return (ctypes.c_uint16 * 7)(*prom)


def pressure_of(firmware: ctypes.CDLL, d1: int, d2: int, prom: list[int] = PROM) -> tuple[int, int]:
    pressure, temperature = ctypes.c_int32(), ctypes.c_int16()
    firmware.firmware_compensate(as_array(prom), d1, d2, ctypes.byref(pressure), ctypes.byref(temperature))
    return pressure.value, temperature.value


def test_pressure_of_the_data_sheets_example(firmware: ctypes.CDLL) -> None:
    """D1 = 4958179, D2 = 6815414 give 3999.8 mbar at 19.81 °C."""
    pressure, temperature = pressure_of(firmware, 4958179, 6815414)
    assert temperature == 1981
    assert pressure // 10 == 39998


def test_a_sensor_for_2_bar_seems_to_feel_20_times_the_pressure(firmware: ctypes.CDLL) -> None:
    """The example of the MS5837-02BA's data sheet: 1100.02 mbar, 20.00 °C. The bring-up knows it by that."""
    prom = [0, 46372, 43981, 29059, 27842, 31553, 28165]
    pressure, temperature = pressure_of(firmware, 6465444, 8077636, prom)
    assert pressure == pytest.approx(OF_02BA * 110_002, rel=1e-4)
    assert temperature == 2000


@given(d1=st.integers(3_000_000, 9_000_000), celsius=st.floats(-30, 80))
def test_pressure_follows_the_data_sheets_formulas(firmware: ctypes.CDLL, d1: int, celsius: float) -> None:
    d2 = round(PROM[5] * 2**8 + (celsius * 100 - 2000) * 2**23 / PROM[6])
    assert pressure_of(firmware, d1, d2) == compensate(PROM, d1, d2)


def test_proms_checksum_holds(firmware: ctypes.CDLL) -> None:
    assert firmware.firmware_prom_valid(as_array(PROM))


@given(word=st.integers(0, 6), bit=st.integers(0, 15))
def test_prom_with_a_flipped_bit_is_refused(firmware: ctypes.CDLL, word: int, bit: int) -> None:
    flipped = list(PROM)
    flipped[word] ^= 1 << bit
    assert not firmware.firmware_prom_valid(as_array(flipped))


class Filter:
    """The attitude filter at 100 Hz."""

    def __init__(self, firmware: ctypes.CDLL) -> None:
        self.firmware = firmware
        self.filter = firmware.attitude_create()
        self.quaternion = [1.0, 0.0, 0.0, 0.0]

    def run(self, ticks: int, rate: tuple[float, ...], force: tuple[float, ...]) -> None:
        out = (ctypes.c_float * 4)()
        three = ctypes.c_float * 3
        for _ in range(ticks):
            self.firmware.attitude_update(self.filter, three(*rate), three(*force), 0.01, out)
        self.quaternion = list(out)

    @property
    def euler(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw in rad."""
        w, x, y, z = self.quaternion
        roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
        yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        return roll, pitch, yaw


@pytest.fixture
def attitude(firmware: ctypes.CDLL) -> Iterator[Filter]:
    made = Filter(firmware)
    yield made
    firmware.attitude_destroy(made.filter)


def force_at(roll: float, pitch: float) -> tuple[float, float, float]:
    """Specific force at rest, in g, body axes forward, right, down."""
    return math.sin(pitch), -math.sin(roll) * math.cos(pitch), -math.cos(roll) * math.cos(pitch)


LEVEL = force_at(0, 0)
STILL = (0.0, 0.0, 0.0)


@pytest.mark.parametrize("roll", [-2.0, -0.5, 0.0, 0.7])
@pytest.mark.parametrize("pitch", [-1.2, 0.0, 0.4])
def test_attitude_is_right_from_the_first_reading(attitude: Filter, roll: float, pitch: float) -> None:
    attitude.run(1, STILL, force_at(roll, pitch))
    assert attitude.euler[:2] == pytest.approx((roll, pitch), abs=1e-2)


def test_attitude_upside_down(attitude: Filter) -> None:
    attitude.run(1, STILL, (0, 0, 1))
    assert abs(attitude.euler[0]) == pytest.approx(math.pi, abs=1e-3)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("rate", [0.5, -1.0])
def test_attitude_follows_a_turn(attitude: Filter, axis: int, rate: float) -> None:
    """Half a second about each axis, gravity turning along."""
    for tick in range(50):
        turned = rate * 0.01 * (tick + 1)
        force = force_at(turned if axis == 0 else 0, turned if axis == 1 else 0)
        attitude.run(1, tuple(rate if i == axis else 0.0 for i in range(3)), force)
    expected = [0.0] * 3
    expected[axis] = rate * 0.5
    assert attitude.euler == pytest.approx(expected, abs=0.02)


def test_attitude_converges_to_gravity(attitude: Filter) -> None:
    attitude.run(1, STILL, LEVEL)
    attitude.run(1, (60.0, -40.0, 0.0), LEVEL)
    assert attitude.euler[:2] == pytest.approx((0.6, -0.4), abs=0.1)
    attitude.run(100, STILL, LEVEL)
    after_a_second = [abs(angle) for angle in attitude.euler[:2]]
    assert 0.05 < max(after_a_second) < 0.45
    attitude.run(3000, STILL, LEVEL)
    assert attitude.euler[:2] == pytest.approx((0, 0), abs=0.02)


def test_attitude_finds_the_gyroscopes_offset(attitude: Filter) -> None:
    attitude.run(12000, (0.05, -0.03, 0.0), LEVEL)
    assert attitude.euler[:2] == pytest.approx((0, 0), abs=2e-3)


def test_attitude_does_not_take_acceleration_for_gravity(attitude: Filter) -> None:
    attitude.run(1, STILL, LEVEL)
    attitude.run(100, STILL, (1.5, 0.0, -1.0))
    assert attitude.euler == pytest.approx((0, 0, 0), abs=1e-3)


@given(
    rates=st.lists(st.tuples(*[st.floats(-8, 8, width=32)] * 3), min_size=1, max_size=20),
    force=st.tuples(*[st.floats(-4, 4, width=32)] * 3),
)
def test_attitude_stays_a_unit_quaternion(
    firmware: ctypes.CDLL, rates: list[tuple[float, ...]], force: tuple[float, ...]
) -> None:
    attitude = Filter(firmware)
    for rate in rates:
        attitude.run(10, rate, force)
    firmware.attitude_destroy(attitude.filter)
    assert math.hypot(*attitude.quaternion) == pytest.approx(1, abs=1e-5)


@given(counts=st.integers(0, 1023))
def test_battery_is_twice_the_converters_voltage(firmware: ctypes.CDLL, counts: int) -> None:
    assert firmware.firmware_battery_millivolts(counts, 10000) == pytest.approx(
        counts / 1023 * 10000, abs=0.5
    )
