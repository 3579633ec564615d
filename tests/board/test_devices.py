"""The devices on the chip's buses and pins, as a program sees them."""

import math
import struct

import pytest

from robot_runtime.simulation.boards.emulator_process import STILL_WATER, BoardError
from tests.board.monitor import (
    ACKNOWLEDGED_ADDRESS,
    ACKNOWLEDGED_DATA,
    ARBITRATION_LOST,
    LAST_DATA,
    REFUSED_ADDRESS,
    REFUSED_DATA,
    REFUSED_READ_ADDRESS,
    SerialMonitor,
)
from tests.board.rig import CLOCK, BoardRig

IMU = 0x69
PRESSURE = 0x76
BRIDGES = (0x64, 0x60, 0x61, 0x63)
MOTOR_POWER, LED = 1 << 3, 1 << 1
GRAVITY = 9.80665
GYRO_START = 0.03
"""s."""
NO_LOAD, SLOPE, INERTIA = 0.315, 0.0102, 3.06e-4
"""A motor's rad/s for each step of drive, N m for each rad/s below that, and kg m² with its fin."""
FRICTION = 2 * 0.8
"""Steps of drive that the friction of a turning motor takes, of the 2 that it needs to break away."""
DRAG = 0.5 * 1000 * 2.0 * 0.0045 * 0.088**3 / 4
"""N m s², of the water on a fin: ½ρ·C_N·S·R³/4."""


# The I2C bus


def test_an_absent_device_refuses_its_address(monitor: SerialMonitor) -> None:
    assert monitor.transfer(0x42, b"\0")[0] == REFUSED_ADDRESS
    assert monitor.transfer(0x42, count=2)[0] == REFUSED_READ_ADDRESS


def test_a_device_acknowledges(monitor: SerialMonitor) -> None:
    assert monitor.transfer(IMU)[0] == ACKNOWLEDGED_ADDRESS
    assert monitor.transfer(IMU, b"\x75")[0] == ACKNOWLEDGED_DATA
    assert monitor.transfer(IMU, b"\x75", 1)[0] == LAST_DATA


@pytest.mark.parametrize(("twbr", "hertz"), [(12, 400_000), (72, 100_000)])
def test_i2c_takes_as_long_as_its_clock_says(monitor: SerialMonitor, twbr: int, hertz: int) -> None:
    monitor.set_bit_rate(twbr)
    _, duration, _ = monitor.transfer(IMU, b"\x3b", 14)
    characters, starts = 2 + 1 + 14, 2
    least = (9 * characters + starts) / hertz
    # The program's own instructions take a few µs for every character.
    assert least < duration < least + 4e-6 * (characters + starts)


# The IMU


def imu_counts(monitor: SerialMonitor) -> tuple[int, ...]:
    counts: tuple[int, ...] = struct.unpack(">7h", monitor.transfer(IMU, b"\x3b", 14)[2])
    return counts


def test_the_imu_sleeps_until_it_is_woken(monitor: SerialMonitor) -> None:
    assert monitor.transfer(IMU, b"\x75", 1)[2] == b"\x68"
    assert monitor.transfer(IMU, b"\x6b", 1)[2] == b"\x40"
    assert imu_counts(monitor) == (0,) * 7
    monitor.transfer(IMU, b"\x6b\0")
    assert imu_counts(monitor)[2] == -16384


@pytest.mark.parametrize("scale", [0, 1, 2, 3])
def test_the_imu_applies_its_configured_ranges(rig: BoardRig, monitor: SerialMonitor, scale: int) -> None:
    rig.board.sense(STILL_WATER._replace(force=(1.0, -2.0, -GRAVITY), rate=(0.5, -1.0, 2.0)))
    monitor.transfer(IMU, bytes([0x6B, 0]))
    monitor.transfer(IMU, bytes([0x1B, scale << 3, scale << 3]))
    x, y, z, temperature, p, q, r = imu_counts(monitor)
    force, rate = 16384 / 2**scale / GRAVITY, 131.072 / 2**scale * 180 / math.pi
    assert (x, y, z) == tuple(round(value * force) for value in (1.0, -2.0, -GRAVITY))
    assert (p, q, r) == tuple(round(value * rate) for value in (0.5, -1.0, 2.0))
    assert temperature == round((20 - 36.53) * 340)


def test_the_imu_saturates(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.transfer(IMU, b"\x6b\0")
    rig.board.run(GYRO_START)
    rig.board.sense(STILL_WATER._replace(force=(1000.0, -1000.0, 0.0), rate=(100.0, -100.0, 0.0)))
    x, y, _, _, p, q, _ = imu_counts(monitor)
    assert (x, y, p, q) == (32767, -32768, 32767, -32768)


def test_the_gyroscope_starts_30_ms_after_the_accelerometer(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.sense(STILL_WATER._replace(rate=(0.5, 0.5, 0.5)))
    wake = b"T" + bytes([IMU, 2, 0x6B, 0, 0])
    read = b"T" + bytes([IMU, 1, 0x3B, 14])
    counts = struct.unpack(">7h", rig.exchange(wake + read, 0.025)[-14:])
    assert counts[2] != 0
    assert counts[4:] == (0, 0, 0)
    rig.board.run(0.006)
    assert min(imu_counts(monitor)[4:]) > 0


def test_the_imu_repeats_a_reading_until_its_next_sample(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.transfer(IMU, bytes([0x6B, 0]))
    monitor.transfer(IMU, bytes([0x19, 99, 3]))  # 1 kHz by the filter, and every 100th of it
    before = imu_counts(monitor)
    rig.board.sense(STILL_WATER._replace(force=(0.0, 0.0, 5.0)))
    assert imu_counts(monitor)[2] == before[2]
    rig.board.run(0.1)
    assert imu_counts(monitor)[2] > 0


@pytest.mark.parametrize(("config", "bandwidth"), [(3, None), (4, 20), (5, 10), (6, 5)])
def test_the_imu_filters_as_narrowly_as_it_is_set(
    rig: BoardRig, monitor: SerialMonitor, config: int, bandwidth: float | None
) -> None:
    """A wider filter than that of the simulated water, 44 Hz, has no effect."""
    monitor.transfer(IMU, bytes([0x6B, 0]))
    monitor.transfer(IMU, bytes([0x1A, config]))
    rig.board.run(GYRO_START)
    imu_counts(monitor)
    rig.board.sense(STILL_WATER._replace(force=(5.0, 0.0, -GRAVITY), rate=(0.0, 1.0, 0.0)))
    began = rig.board.stats()["time"]
    rig.board.run(0.01)
    imu_counts(monitor)
    passed = rig.board.run(0.005) - began
    force, _, _, _, _, rate, _ = imu_counts(monitor)
    share = 1 - math.exp(-2 * math.pi * bandwidth * passed) if bandwidth else 1
    # It samples each ms.
    step = 2 * math.pi * bandwidth * 1e-3 if bandwidth else 1e-4
    assert force / 16384 * GRAVITY / 5 == pytest.approx(share, abs=step)
    assert rate / 131.072 * math.pi / 180 == pytest.approx(share, abs=step)


# The pressure sensor


def convert(rig: BoardRig, monitor: SerialMonitor, command: int, wait: float) -> int:
    monitor.transfer(PRESSURE, bytes([command]))
    rig.board.run(wait)
    return int.from_bytes(monitor.transfer(PRESSURE, b"\0", 3)[2], "big")


def reset_pressure_sensor(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.transfer(PRESSURE, b"\x1e")
    rig.board.run(0.003)


def prom(monitor: SerialMonitor) -> list[int]:
    return [
        int.from_bytes(monitor.transfer(PRESSURE, bytes([0xA0 + 2 * word]), 2)[2], "big") for word in range(7)
    ]


def compensated(c: list[int], d1: int, d2: int) -> tuple[float, float]:
    """Return the data sheet's second-order compensation, in whole numbers as it prescribes: Pa and °C."""
    dt = d2 - (c[5] << 8)
    temp = 2000 + (dt * c[6] >> 23)
    off = (c[2] << 16) + (c[4] * dt >> 7)
    sens = (c[1] << 15) + (c[3] * dt >> 8)
    if temp < 2000:
        ti = 3 * dt * dt >> 33
        off -= 3 * (temp - 2000) ** 2 >> 1
        sens -= 5 * (temp - 2000) ** 2 >> 3
    else:
        ti = 2 * dt * dt >> 37
        off -= (temp - 2000) ** 2 >> 4
    return ((d1 * sens >> 21) - off) / 2**13 * 10, (temp - ti) / 100


def test_the_prom_is_empty_until_a_reset_and_carries_its_checksum(
    rig: BoardRig, monitor: SerialMonitor
) -> None:
    assert prom(monitor) == [0] * 7
    reset_pressure_sensor(rig, monitor)
    text = prom(monitor)
    remainder = 0
    for index, byte in enumerate(
        b"".join(word.to_bytes(2, "big") for word in [text[0] & 0xFFF, *text[1:], 0])
    ):
        assert index < 16
        remainder ^= byte
        for _ in range(8):
            remainder = (remainder << 1 ^ 0x3000 if remainder & 0x8000 else remainder << 1) & 0xFFFF
    assert remainder >> 12 == text[0] >> 12


@pytest.mark.parametrize("pressure", [101325.0, 113098.0, 250000.0])
@pytest.mark.parametrize("temperature", [4.0, 20.0, 31.5])
def test_the_compensation_returns_the_true_pressure(
    rig: BoardRig, monitor: SerialMonitor, pressure: float, temperature: float
) -> None:
    rig.board.sense(STILL_WATER._replace(pressure=pressure, temperature=temperature))
    d2 = convert(rig, monitor, 0x5A, 0.02)
    d1 = convert(rig, monitor, 0x4A, 0.02)
    reset_pressure_sensor(rig, monitor)
    computed = compensated(prom(monitor), d1, d2)
    assert computed[0] == pytest.approx(pressure, abs=10)
    assert computed[1] == pytest.approx(temperature, abs=0.01)


def test_a_conversion_read_too_early_is_zero(rig: BoardRig, monitor: SerialMonitor) -> None:
    ready = convert(rig, monitor, 0x4A, 0.02)
    assert ready > 0
    # Asking already takes 20 ms, so the read is sent along with the command.
    command = b"T" + bytes([PRESSURE, 1, 0x4A, 0])
    read = b"T" + bytes([PRESSURE, 1, 0x00, 3])
    assert rig.exchange(command + read, 0.02)[-3:] == b"\0\0\0"
    # It goes on, and its result is wrong.
    assert 0 < int.from_bytes(rig.exchange(read, 0.02)[-3:], "big") < 0.6 * ready


def test_a_reset_takes_a_while(rig: BoardRig, monitor: SerialMonitor) -> None:
    command = b"T" + bytes([PRESSURE, 1, 0x1E, 0])
    read = b"T" + bytes([PRESSURE, 1, 0xA2, 2])
    assert rig.exchange(command + read, 0.02)[-2:] == b"\0\0"
    assert prom(monitor)[1] == 34982


# The encoders


def test_an_encoder_shows_the_fins_angle_with_parity(rig: BoardRig, monitor: SerialMonitor) -> None:
    zeros, rotations = (188, 161, 726, 356), (1, 1, -1, -1)
    angles = rig.board.fins().angles
    for fin in range(4):
        duration, word = monitor.encoder(fin)
        shaft = rotations[fin] * angles[fin]
        assert word >> 6 == round(zeros[fin] - shaft * 1024 / math.tau) % 1024
        assert word & 0b111110 == 0b100000
        assert word.bit_count() % 2 == 0
        assert 24 * 16 / CLOCK < duration < 24 * 16 / CLOCK + 6e-6


def test_an_encoder_is_ready_50_ms_after_power_on(rig: BoardRig) -> None:
    monitor = SerialMonitor(rig)
    monitor.boot()
    offset_compensated = 1 << 5
    assert not monitor.encoder(0)[1] & offset_compensated
    rig.board.run(0.05)
    assert monitor.encoder(0)[1] & offset_compensated


def test_an_encoder_has_the_offset_that_the_water_sets(rig: BoardRig, monitor: SerialMonitor) -> None:
    def ticks() -> list[int]:
        rig.board.run(0.002)
        return [monitor.encoder(fin)[1] >> 6 for fin in range(4)]

    before = ticks()
    quarter = math.pi / 2
    rig.board.sense(STILL_WATER._replace(encoders=(quarter, quarter, -quarter, 0.0)))
    # An encoder counts down as its shaft turns on, and the left shafts turn against their fins.
    moved = [(late - early) % 1024 for early, late in zip(before, ticks(), strict=True)]
    assert moved == [768, 768, 768, 0]


def test_an_encoder_without_a_reading_shows_the_last_one(rig: BoardRig, monitor: SerialMonitor) -> None:
    before = monitor.encoder(0)[1]
    rig.board.sense(STILL_WATER._replace(encoders=(math.nan, 0.0, 0.0, 0.0)))
    monitor.outputs(MOTOR_POWER)
    drive(monitor, 0, 40)
    rig.board.run(0.1)
    assert rig.board.fins().angles[0] > 0.5
    assert monitor.encoder(0)[1] == before
    rig.board.sense(STILL_WATER)
    rig.board.run(0.002)
    assert monitor.encoder(0)[1] != before


def test_an_absent_encoder_leaves_the_line_high(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.fault("encoder2", "absent")
    assert monitor.encoder(2)[1] == 0xFFFF
    assert monitor.encoder(1)[1] != 0xFFFF


def test_in_spi_mode_0_an_encoder_s_word_comes_a_bit_late(monitor: SerialMonitor) -> None:
    right = monitor.encoder_bits(0)[1]
    monitor.set_spi_mode(clock_rests_high=False, second_edge=False)
    wrong = monitor.encoder_bits(0)[1]
    assert wrong == 1 << 23 | right >> 1
    monitor.set_spi_mode(clock_rests_high=True, second_edge=True)
    assert monitor.encoder_bits(0)[1] == right


def test_a_weak_magnet_shows_in_the_status_bits(rig: BoardRig, monitor: SerialMonitor) -> None:
    before = monitor.encoder(1)[1]
    rig.board.fault("encoder1", "weak")
    assert monitor.encoder(1)[1] == before | 0b110


# The motors


def drive(monitor: SerialMonitor, fin: int, steps: int) -> int:
    direction = 1 if steps > 0 else 2
    return monitor.transfer(BRIDGES[fin], bytes([0, abs(steps) << 2 | direction]))[0]


def steady_speed(steps: float, load: float = 1.0) -> float:
    """rad/s at which the water takes all the torque that a motor has at this drive."""
    drag = load * DRAG
    return (math.sqrt(SLOPE**2 + 4 * drag * SLOPE * NO_LOAD * (steps - FRICTION)) - SLOPE) / (2 * drag)


def test_a_motor_turns_its_fin_in_the_water_as_it_is_driven(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    for fin, steps in enumerate((40, -40, 20, 1)):
        assert drive(monitor, fin, steps) == ACKNOWLEDGED_DATA
    rig.board.run(0.3)
    before = rig.board.fins()
    full, half = steady_speed(40), steady_speed(20)
    assert full == pytest.approx(7.67, abs=0.01)
    assert before.drives == (40, -40, 20, 0)
    assert before.speeds == pytest.approx((full, -full, -half, 0), rel=0.001)
    rig.board.run(0.1)
    after = rig.board.fins()
    turned = [math.remainder(b - a, math.tau) for a, b in zip(before.angles, after.angles, strict=True)]
    assert turned == pytest.approx((0.1 * full, -0.1 * full, -0.1 * half, 0), abs=0.01)


@pytest.mark.parametrize("load", [0.5, 2.0])
def test_other_fins_load_their_motors_more_or_less(
    rig: BoardRig, monitor: SerialMonitor, load: float
) -> None:
    rig.board.sense(STILL_WATER._replace(fin_load=load))
    monitor.outputs(MOTOR_POWER)
    drive(monitor, 0, 40)
    rig.board.run(0.3)
    assert rig.board.fins().speeds[0] == pytest.approx(steady_speed(40, load), rel=0.001)


def test_a_motor_speeds_up_against_inertia_and_water(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    rig.port.write(b"T" + bytes([BRIDGES[0], 2, 0, 40 << 2 | 1, 0]))
    rig.run_until(lambda: rig.board.fins().drives[0] == 40, step=1e-4, limit=0.01)
    rig.board.run(0.020)
    # From rest, of J dw/dt = slope (w0 - w) - drag w^2 with the roots `end` and `-end - slope / drag`.
    end = steady_speed(40)
    other = end + SLOPE / DRAG
    decay = math.exp(-DRAG * (end + other) / INERTIA * 0.020)
    assert rig.board.fins().speeds[0] == pytest.approx(
        end * (1 - decay) / (1 + end / other * decay), rel=0.04
    )


def test_a_bridge_coasts_at_00_and_brakes_at_11(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    drive(monitor, 0, 40)
    drive(monitor, 1, 40)
    rig.board.run(0.3)
    monitor.transfer(BRIDGES[0], b"\0\0")
    monitor.transfer(BRIDGES[1], b"\0\xa3")
    rig.board.run(0.04)
    coasting, braking, *_ = rig.board.fins().speeds
    assert coasting > 1.8
    assert braking < 0.7
    rig.board.run(0.2)
    assert rig.board.fins().speeds == (0, 0, 0, 0)


def test_without_power_no_motor_turns_and_the_bridges_are_dead(rig: BoardRig, monitor: SerialMonitor) -> None:
    assert drive(monitor, 0, 40) == REFUSED_ADDRESS
    monitor.outputs(MOTOR_POWER)
    drive(monitor, 0, 40)
    assert rig.board.fins().drives[0] == 40
    monitor.outputs(0)
    rig.board.run(0.3)
    fins = rig.board.fins()
    assert (fins.drives[0], fins.speeds[0], fins.powered) == (0, 0, False)
    monitor.outputs(MOTOR_POWER)
    assert rig.board.fins().drives[0] == 0  # its registers are reset


def test_the_bridges_go_on_while_the_chip_is_reset_only_as_long_as_they_have_power(
    rig: BoardRig, monitor: SerialMonitor
) -> None:
    monitor.outputs(MOTOR_POWER)
    drive(monitor, 0, 40)
    rig.board.run(0.2)
    rig.board.reset()
    fins = rig.board.fins()
    assert not fins.powered
    assert fins.drives == (0, 0, 0, 0)


# Pins


def test_led_beacons_and_battery(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(LED)
    assert rig.board.led()
    monitor.outputs(0)
    assert not rig.board.led()
    right, left = 1 << 4, 1 << 5
    assert monitor.inputs() & (right | left) == 0
    rig.board.sense(STILL_WATER._replace(beacon_left=True, battery=6.1))
    assert monitor.inputs() & (right | left) == left
    assert monitor.adc(2) == pytest.approx(6.1 / 2 / 5 * 1023, abs=1)
    rig.board.sense(STILL_WATER._replace(beacon_right=True))
    assert monitor.inputs() & (right | left) == right
    assert monitor.adc(2) == pytest.approx(7.4 / 2 / 5 * 1023, abs=1)


def test_inputs_survive_a_reset(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.sense(STILL_WATER._replace(beacon_right=True, battery=8.0))
    rig.board.reset()
    monitor.boot()
    assert monitor.inputs() & (1 << 4)
    assert monitor.adc(2) == pytest.approx(8.0 / 2 / 5 * 1023, abs=1)


# Faults


def test_a_dip_of_the_supply_puts_the_imu_to_sleep(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.transfer(IMU, b"\x6b\0")
    assert imu_counts(monitor)[2] != 0
    rig.board.fault("imu", "dip")
    assert monitor.transfer(IMU, b"\x6b", 1)[2] == b"\x40"
    assert imu_counts(monitor) == (0,) * 7


@pytest.mark.parametrize("identity", ["0x70", "0x71"])
def test_a_dip_of_the_supply_leaves_a_newer_imu_awake_at_its_own_ranges(
    rig: BoardRig, monitor: SerialMonitor, identity: str
) -> None:
    rig.board.mistake(f"imu-clone:{identity}")
    monitor.transfer(IMU, b"\x1c\x08")
    assert imu_counts(monitor)[2] == -8192
    rig.board.fault("imu", "dip")
    assert monitor.transfer(IMU, b"\x6b", 1)[2] == b"\x01"
    assert monitor.transfer(IMU, b"\x1b", 2)[2] == b"\0\0"
    assert imu_counts(monitor)[2] == -16384


def test_a_tripped_bridge_coasts_until_its_fault_is_cleared(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    drive(monitor, 0, 40)
    rig.board.fault("bridge0", "tripped")
    assert rig.board.fins().drives[0] == 0
    assert monitor.transfer(BRIDGES[0], b"\x01", 1)[2] == b"\x03"
    monitor.transfer(BRIDGES[0], b"\x01\x80")
    assert monitor.transfer(BRIDGES[0], b"\x01", 1)[2] == b"\0"
    assert rig.board.fins().drives[0] == 40


def test_a_bus_that_refuses_data(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.fault("i2c", "refused")
    assert monitor.transfer(IMU, b"\x6b\0")[0] == REFUSED_DATA
    rig.board.fault("i2c", "none")
    assert monitor.transfer(IMU, b"\x6b\0")[0] == ACKNOWLEDGED_DATA


def test_a_bus_whose_arbitration_is_lost(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.fault("i2c", "contested")
    assert monitor.transfer(IMU, b"\x6b\0")[0] == ARBITRATION_LOST
    assert monitor.transfer(IMU, count=1)[0] == ARBITRATION_LOST
    rig.board.fault("i2c", "none")
    assert monitor.transfer(IMU, b"\x6b", 1)[2] == b"\x40"  # nothing was written


def test_a_bus_that_stretches_its_clock(rig: BoardRig, monitor: SerialMonitor) -> None:
    usual = monitor.transfer(IMU, b"\x6b\0")[1]
    rig.board.fault("i2c", "stretched")
    assert monitor.transfer(IMU, b"\x6b\0")[1] == pytest.approx(usual + 3 * 200e-6, abs=5e-6)


def test_absent_devices_refuse_their_addresses(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    for name, address in {"imu": IMU, "pressure": PRESSURE, "bridge3": BRIDGES[3]}.items():
        assert monitor.transfer(address)[0] == ACKNOWLEDGED_ADDRESS
        rig.board.fault(name, "absent")
        assert monitor.transfer(address)[0] == REFUSED_ADDRESS
        rig.board.fault(name, "none")
        assert monitor.transfer(address)[0] == ACKNOWLEDGED_ADDRESS


def test_stuck_sensors_repeat_their_last_reading(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.transfer(IMU, b"\x6b\0")
    before = imu_counts(monitor), convert(rig, monitor, 0x4A, 0.02)
    rig.board.fault("imu", "stuck")
    rig.board.fault("pressure", "stuck")
    rig.board.sense(STILL_WATER._replace(force=(5.0, 5.0, 5.0), pressure=200000.0))
    assert (imu_counts(monitor), convert(rig, monitor, 0x4A, 0.02)) == before
    rig.board.fault("imu", "none")
    rig.board.fault("pressure", "none")
    assert imu_counts(monitor)[0] > 0
    assert convert(rig, monitor, 0x4A, 0.02) > before[1]


def test_a_stuck_encoder_and_a_stuck_bridge(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    before = monitor.encoder(0)[1]
    rig.board.fault("encoder0", "stuck")
    drive(monitor, 0, 40)
    rig.board.fault("bridge0", "stuck")
    drive(monitor, 0, -40)
    rig.board.run(0.1)
    assert rig.board.fins().drives[0] == 40
    assert monitor.encoder(0)[1] == before
    rig.board.fault("encoder0", "none")
    rig.board.run(0.01)
    assert monitor.encoder(0)[1] != before


@pytest.mark.parametrize(
    ("device", "kind"),
    [
        ("imu", "broken"),
        ("encoder4", "none"),
        ("", ""),
        ("imu", "weak"),
        ("pressure", "dip"),
        ("encoder0", "tripped"),
        ("bridge0", "weak"),
        ("i2c", "absent"),
    ],
)
def test_unknown_faults_are_refused(rig: BoardRig, device: str, kind: str) -> None:
    with pytest.raises(BoardError, match="fault takes imu"):
        rig.board.fault(device, kind)  # type: ignore[arg-type]
