"""Mistakes of wiring and imperfections of parts, as a program on the board sees them."""

import math
import struct
import subprocess
from itertools import product
from pathlib import Path
from statistics import fmean

import pytest

from robot_runtime.simulation.boards.emulator_process import STILL_WATER, BoardError
from robot_runtime.simulation.boards.mistakes import FINS, MISTAKES, PARTS, check_mistake
from tests.board.conftest import Make
from tests.board.monitor import ACKNOWLEDGED_ADDRESS, ACKNOWLEDGED_DATA, REFUSED_ADDRESS, SerialMonitor
from tests.board.rig import PROGRAM, BoardRig, EmulatedPort

IMU, PRESSURE = 0x69, 0x76
BRIDGES = (0x64, 0x60, 0x61, 0x63)
WRONG_BRIDGE, WRONG_IMU = 0x62, 0x68
MOTOR_POWER = 1 << 3
ABSENT = 0xFFFF
AXES = [
    f"{a}x{b}y{c}z".translate(str.maketrans("xyz", axes))
    for axes in ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
    for a, b, c in product("+-", repeat=3)
]
EXAMPLES = [
    *(f"{name}:{fin}" for name in ("leads-reversed", "encoder-reversed", "strap-wrong") for fin in FINS),
    *(
        f"{name}:{FINS[0]},{other}"
        for name in ("motors-swapped", "encoders-swapped", "strap-shared")
        for other in FINS[1:]
    ),
    *(f"missing:{part}" for part in PARTS),
    *("imu-strap", "beacons-inverted", "beacons-swapped", "imu-clone:0x72", "imu-clone:255"),
    *(
        "divider-wrong:0.5",
        "divider-wrong:10",
        "regulator-off:-5",
        "gyro-offset:20,-20,0.5",
        "gyro-drift:0.1,-1,0",
    ),
    *("encoder-noise:3", "backlash:0.05", "stiction:12", "pack-resistance:0.2"),
]
REFUSED = [
    *("", "nothing", "imu-strap:", "imu-strap:0", "leads-reversed", "leads-reversed:", "leads-reversed:left"),
    *("motors-swapped:front-right", "motors-swapped:front-right,front-right", "missing:led"),
    *("missing:motor", "missing:motor-0", "imu-clone:0", "imu-clone:256", "imu-clone:x", "imu-turned:xyz"),
    *("divider-wrong:0", "divider-wrong:11", "regulator-off:11", "gyro-offset:1,2", "gyro-offset:1,2,21"),
    *("gyro-offset:1,2,3,4", "backlash:-0.1", "backlash:0.1x", "encoder-noise:nan", "pack-resistance:3"),
    *("stiction:64", "gyro-drift:1.1,0,0", "gyro-drift:1"),
]


def drive(monitor: SerialMonitor, address: int, steps: int) -> int:
    return monitor.transfer(address, bytes([0, abs(steps) << 2 | (1 if steps > 0 else 2)]))[0]


def shaft_ticks(monitor: SerialMonitor, fin: int) -> int:
    return monitor.encoder(fin)[1] >> 6


def turned_ticks(rig: BoardRig, monitor: SerialMonitor, seconds: float = 0.02) -> list[int]:
    """Return the ticks by which the encoders change in this time."""
    before = [shaft_ticks(monitor, fin) for fin in range(4)]
    rig.board.run(seconds)
    return [(shaft_ticks(monitor, fin) - before[fin] + 512) % 1024 - 512 for fin in range(4)]


# Names


@pytest.mark.usefixtures("built")
def test_board_and_python_have_the_same_list(rig: BoardRig) -> None:
    for text in (*EXAMPLES, *AXES, *REFUSED):
        try:
            check_mistake(text)
            known = True
        except ValueError:
            known = False
        try:
            rig.board.mistake(text)
        except BoardError:
            assert not known, text
        else:
            assert known, text
    assert {text.partition(":")[0] for text in EXAMPLES} | {"imu-turned"} == MISTAKES.keys()


@pytest.mark.parametrize("text", EXAMPLES)
def test_each_mistake_can_be_written(text: str) -> None:
    check_mistake(text)


@pytest.mark.parametrize("text", REFUSED)
def test_other_words_are_refused_with_what_there_is(text: str) -> None:
    with pytest.raises(ValueError, match=r"there is no mistake .*; there are |is written "):
        check_mistake(text)


def test_an_imu_can_lie_in_24_ways(rig: BoardRig) -> None:
    accepted = 0
    for axes in AXES:
        try:
            rig.board.mistake(f"imu-turned:{axes}")
            accepted += 1
        except BoardError:
            continue
    assert accepted == 24


@pytest.mark.usefixtures("built")
def test_the_command_line_takes_mistakes_and_lists_them(make_rig: Make, tmp_path: Path) -> None:
    listed = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True, check=True).stdout
    names = [line.split()[0].partition(":")[0] for line in listed.partition("Mistakes:")[2].splitlines()[1:]]
    assert [name for name in names if name in MISTAKES] == list(MISTAKES)
    places = ("--tty", str(tmp_path / "tty"), "--socket", str(tmp_path / "board"))
    command = [str(PROGRAM), "--elf", "none", *places, "--mistake", "no"]
    refused = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (refused.returncode, refused.stderr.strip()) == (
        2,
        "board: there is no mistake 'no'; see `board --help`",
    )
    rig = make_rig("monitor", "--mistake", "imu-strap", "--mistake", "beacons-inverted")
    monitor = SerialMonitor(rig)
    monitor.boot()
    assert monitor.transfer(WRONG_IMU)[0] == ACKNOWLEDGED_ADDRESS
    assert monitor.inputs() >> 4 & 3 == 3


def test_mistakes_survive_a_power_cut_and_can_be_undone(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.mistake("encoders-swapped:front-right,back-right")
    rig.board.run(0.001)
    before = [shaft_ticks(monitor, fin) for fin in range(2)]
    rig.board.power()
    rig.port.close()
    rig.port = EmulatedPort(rig.process.tty, rig.board, 115200)
    monitor.boot()
    rig.board.run(0.05)
    assert [shaft_ticks(monitor, fin) for fin in range(2)] == before
    rig.board.mistake("none")
    rig.board.run(0.001)
    assert [shaft_ticks(monitor, fin) for fin in range(2)] == before[::-1]


# Motors and encoders


def test_swapped_motors(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.mistake("motors-swapped:front-right,back-left")
    monitor.outputs(MOTOR_POWER)
    drive(monitor, BRIDGES[0], 30)
    speeds = rig.board.fins().speeds
    assert speeds[0] == 0
    assert speeds[2] < -1  # its shaft turns against its fin
    assert [bool(ticks) for ticks in turned_ticks(rig, monitor)] == [False, False, True, False]


def test_reversed_leads_and_a_reversed_encoder(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    rig.board.mistake("leads-reversed:front-right")
    rig.board.mistake("encoder-reversed:back-right")
    for fin in range(3):
        drive(monitor, BRIDGES[fin], 20)
    rig.board.run(0.1)
    first, second, third, _ = rig.board.fins().speeds
    assert (first < 0, second > 0, third < 0) == (True, True, True)
    assert [math.copysign(1, ticks) for ticks in turned_ticks(rig, monitor)[:3]] == [1, 1, -1]


def test_swapped_encoders(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    rig.board.mistake("encoders-swapped:back-right,front-left")
    drive(monitor, BRIDGES[1], 20)
    assert rig.board.fins().speeds[1] > 1
    assert [bool(ticks) for ticks in turned_ticks(rig, monitor)] == [False, False, False, True]


def test_a_motor_that_is_not_connected(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    rig.board.mistake("missing:motor-back-left")
    assert drive(monitor, BRIDGES[2], 40) == ACKNOWLEDGED_DATA
    rig.board.run(0.1)
    assert rig.board.fins().speeds[2] == 0


def test_an_encoder_that_is_not_connected(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.mistake("missing:encoder-back-left")
    assert [monitor.encoder(fin)[1] == ABSENT for fin in range(4)] == [False, False, True, False]


# Addresses


def test_wrong_straps_and_what_is_not_connected(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    rig.board.mistake("strap-wrong:back-right")
    rig.board.mistake("missing:bridge-front-left")
    rig.board.mistake("missing:pressure")
    rig.board.mistake("imu-strap")
    there = {address for address in range(0x08, 0x78) if monitor.transfer(address)[0] == ACKNOWLEDGED_ADDRESS}
    assert there == {BRIDGES[0], BRIDGES[2], WRONG_BRIDGE, WRONG_IMU}
    rig.board.mistake("missing:imu")
    assert monitor.transfer(WRONG_IMU)[0] == REFUSED_ADDRESS


def test_two_bridges_at_one_address_both_obey(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    rig.board.mistake("strap-shared:front-right,back-right")
    assert monitor.transfer(BRIDGES[0])[0] == REFUSED_ADDRESS
    assert drive(monitor, BRIDGES[1], 30) == ACKNOWLEDGED_DATA
    assert rig.board.fins().drives == (30, 30, 0, 0)
    assert monitor.transfer(BRIDGES[1], b"\0", 1)[2] == bytes([30 << 2 | 1])


def test_devices_at_one_address_answer_with_their_common_ones(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    drive(monitor, BRIDGES[0], 0b101100)
    drive(monitor, BRIDGES[1], 0b001110)
    rig.board.mistake("strap-shared:front-right,back-right")
    assert monitor.transfer(BRIDGES[1], b"\0", 1)[2] == bytes([0b001100 << 2 | 1])


# The IMU


def imu_counts(monitor: SerialMonitor) -> tuple[int, ...]:
    counts: tuple[int, ...] = struct.unpack(">7h", monitor.transfer(IMU, b"\x3b", 14)[2])
    return counts


def test_a_turned_imu(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.transfer(IMU, b"\x6b\0")
    rig.board.sense(STILL_WATER._replace(force=(1.0, 2.0, 3.0), rate=(0.1, 0.2, 0.3)))
    rig.board.run(0.03)
    right = imu_counts(monitor)
    rig.board.mistake("imu-turned:-y+x+z")
    turned = imu_counts(monitor)
    assert turned[:3] == (-right[1], right[0], right[2])
    assert turned[4:] == (-right[5], right[4], right[6])


def test_a_clone_and_its_gyroscope_s_offset(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.mistake("imu-clone:0x72")
    rig.board.mistake("gyro-offset:20,-5,0.5")
    assert monitor.transfer(IMU, b"\x75", 1)[2] == b"\x72"
    monitor.transfer(IMU, b"\x6b\0")
    rig.board.run(0.03)
    assert imu_counts(monitor)[4:] == (round(20 * 131.072), round(-5 * 131.072), round(0.5 * 131.072))


@pytest.mark.parametrize("temperature", [10.0, 25.0, 32.0])
def test_a_gyroscope_s_offset_drifts_with_the_temperature(
    rig: BoardRig, monitor: SerialMonitor, temperature: float
) -> None:
    rig.board.mistake("gyro-offset:1,0,0")
    rig.board.mistake("gyro-drift:0.1,-0.2,0")
    rig.board.sense(STILL_WATER._replace(temperature=temperature))
    monitor.transfer(IMU, b"\x6b\0")
    rig.board.run(0.03)
    warmer = temperature - 25
    shown = (1 + 0.1 * warmer, -0.2 * warmer, 0)
    assert imu_counts(monitor)[4:] == pytest.approx([rate * 131.072 for rate in shown], abs=1)


# Beacons and battery


def test_the_beacon_detectors(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.sense(STILL_WATER._replace(beacon_right=True))
    right, left = 1, 2
    assert monitor.inputs() >> 4 & 3 == right
    for mistake, shown in (
        ("beacons-swapped", left),
        ("beacons-inverted", right),  # both at once
        ("missing:beacon-right", 0),
    ):
        rig.board.mistake(mistake)
        assert monitor.inputs() >> 4 & 3 == shown
    rig.board.mistake("none")
    assert monitor.inputs() >> 4 & 3 == right


@pytest.mark.parametrize(
    ("mistake", "factor"),
    [
        ("divider-wrong:0.5", 0.5),
        ("regulator-off:5", 1 / 1.05),
        ("regulator-off:-5", 1 / 0.95),
        ("missing:battery", 0),
    ],
)
def test_the_battery_s_divider_and_the_converter_s_reference(
    rig: BoardRig, monitor: SerialMonitor, mistake: str, factor: float
) -> None:
    rig.board.mistake(mistake)
    assert monitor.adc(2) == pytest.approx(factor * 7.4 / 10 * 1023, abs=1)


def test_the_battery_sags_under_the_motors(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.mistake("pack-resistance:0.2")
    assert monitor.adc(2) == pytest.approx(7.4 / 10 * 1023, abs=1)
    monitor.outputs(MOTOR_POWER)
    for address in BRIDGES:
        drive(monitor, address, 40)
    rig.board.run(0.3)
    speed = abs(rig.board.fins().speeds[0])
    # A motor's current follows its torque, 1.5 A at 0.235 N m; the bridge passes on its power at 3.2 V.
    amperes = 1.5 / 0.235 * 0.0102 * (12.6 - speed)
    pack = 4 * amperes * 0.0803 * 40 / 7.4
    assert 0.05 < 0.2 * pack < 0.5
    assert monitor.adc(2) == pytest.approx((7.4 - 0.2 * pack) / 10 * 1023, abs=1.5)


def test_a_motor_has_no_more_voltage_than_the_sagging_battery(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(MOTOR_POWER)
    drive(monitor, BRIDGES[0], 40)
    rig.board.run(0.3)
    full = rig.board.fins().speeds[0]
    rig.board.sense(STILL_WATER._replace(battery=1.6))
    rig.board.run(0.3)
    assert 0.4 * full < rig.board.fins().speeds[0] < 0.7 * full


# Imperfect parts


def test_noisy_encoders(rig: BoardRig, monitor: SerialMonitor) -> None:
    true = shaft_ticks(monitor, 0)
    rig.board.mistake("encoder-noise:3")
    shown = [shaft_ticks(monitor, 0) - true for _ in range(60)]
    assert (min(shown), max(shown)) == (-3, 3)
    assert abs(fmean(shown)) < 1


@pytest.mark.parametrize("steps", [6, 12, 18])
def test_a_stiff_fin_turns_only_above_its_breakaway_drive(
    rig: BoardRig, monitor: SerialMonitor, steps: int
) -> None:
    rig.board.mistake(f"stiction:{steps + 0.5}")
    monitor.outputs(MOTOR_POWER)
    drive(monitor, BRIDGES[0], steps)
    rig.board.run(0.2)
    assert rig.board.fins().speeds[0] == 0
    drive(monitor, BRIDGES[0], steps + 1)
    rig.board.run(0.2)
    slow = rig.board.fins().speeds[0]
    # What is left of the drive is used up by the water and by the motor's own speed.
    assert 0.1 < slow < 0.315 * (steps + 1 - 0.8 * (steps + 0.5))
    drive(monitor, BRIDGES[0], steps)
    rig.board.run(0.2)
    assert 0 < rig.board.fins().speeds[0] < slow


def test_backlash_delays_a_fin_that_reverses(rig: BoardRig, monitor: SerialMonitor) -> None:
    rig.board.mistake("backlash:0.3")
    monitor.outputs(MOTOR_POWER)
    drive(monitor, BRIDGES[0], 10)
    rig.board.run(0.3)
    assert rig.board.fins().speeds[0] > 1
    rig.port.write(b"T" + bytes([BRIDGES[0], 2, 0, 10 << 2 | 2, 0]))
    speeds = []
    for _ in range(300):
        rig.board.run(0.001)
        speeds.append(rig.board.fins().speeds[0])
    rest = speeds.index(0)
    gap = next(index for index, speed in enumerate(speeds) if speed < 0) - rest
    # 0.3 rad at no more than 3.15 rad/s without load.
    assert 0.095 < gap * 1e-3 < 0.2
