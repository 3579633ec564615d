"""The robot's own firmware on the emulated board: its drivers, its pace and its safety, in emulated time."""

import math
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from robot_runtime.contract.board_events import describe_event
from robot_runtime.contract.calibration import EMULATED, RECORD_ADDRESS, CalibrationValues, record
from robot_runtime.contract.packets import (
    CHIP_PARAMETERS,
    Beacon,
    BoardEvent,
    BoardEventKind,
    Countdown,
    Depth,
    DeviceFault,
    Hello,
    Imu,
    Motor,
    Navigation,
    Parameter,
    ResetCause,
    Start,
    Status,
    StatusFlag,
)
from robot_runtime.simulation.boards.emulator_process import STILL_WATER
from robot_runtime.simulation.boards.mistakes import FINS
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion
from tests.board.host import EmulatedRobot, all_of, last, start
from tests.board.rig import ROOT, build

DOWN = Navigation(x=0.0, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=0.0)
COMMANDS = [
    Navigation(**dict.fromkeys(("x", "y", "z", "roll", "pitch", "yaw"), 0.0) | {axis: sign})
    for axis in ("z", "x", "yaw", "roll", "y", "pitch")
    for sign in (1.0, -1.0)
]
FLAPPING = 1.3
"""Hz."""
BOOT_SECONDS = 2.0
"""The boot loader waits a second for an upload after the reset pin."""


@pytest.fixture(scope="session")
def firmware(built: None) -> None:  # noqa: ARG001 - the board comes first
    build(ROOT / "firmware", "robot", "hang")


@pytest.fixture
def programs(firmware: None, tmp_path: Path) -> Iterator["Programs"]:  # noqa: ARG001 - it must be built first
    with ExitStack() as boards:
        yield Programs(boards, tmp_path)


class Programs:
    """Starts boards with programs of the firmware's, and ends them with the test."""

    def __init__(self, boards: ExitStack, folder: Path) -> None:
        self._boards = boards
        self._folder = folder

    def start(self, name: str, *options: str) -> EmulatedRobot:
        robot = EmulatedRobot(self._boards.enter_context(start(name, self._folder, *options)))
        robot.listen(0.3)
        return robot


@pytest.fixture
def robot(programs: Programs) -> EmulatedRobot:
    """The booted robot in still water."""
    return programs.start("robot")


# Drivers


def test_it_finds_every_device(robot: EmulatedRobot) -> None:
    status = robot.status()
    assert status.faults == 0
    assert status.reset_cause == ResetCause.POWER_ON
    assert not status.flags & (StatusFlag.ARMED | StatusFlag.MOTOR_POWER)
    assert robot.board.stats()["framing_errors_host"] == 0


def test_a_host_that_comes_late_reads_what_is_and_no_line_is_lost(robot: EmulatedRobot) -> None:
    """At power-on the encoders do not answer for 50 ms; nobody is there who would read of it."""
    robot.listen(1.0)
    robot.greet()
    robot.converse(0.5)
    lines = [describe_event(event).text for event in all_of(robot.heard, BoardEvent)]
    devices = ("IMU", "pressure sensor", *(f"encoder {fin.replace('-', ' ')}" for fin in FINS))
    assert lines == ["boot 1, power on", *(f"{device}: ok" for device in devices)]
    assert robot.status().debug_lost == 0


def test_its_drivers_return_the_true_readings(robot: EmulatedRobot) -> None:
    robot.listen(1.0)  # at the surface, whose pressure it takes as zero depth
    reading = Reading(
        pressure=101325.0 + 1.5 * 9810,
        temperature=12.5,
        force=(1.0, -2.0, -9.5),
        rate=(0.1, -0.2, 0.3),
        beacon_right=True,
        beacon_left=False,
        battery=7.1,
    )
    robot.board.sense(reading)
    packets = robot.listen(0.3)
    imu, depth, beacon = last(packets, Imu), last(packets, Depth), last(packets, Beacon)
    assert imu.force == pytest.approx(reading.force, abs=0.0013)
    assert imu.rate == pytest.approx(reading.rate, abs=0.0003)
    assert depth.pressure == pytest.approx(reading.pressure, abs=20)
    assert depth.temperature == pytest.approx(12.5, abs=0.011)
    assert depth.depth == pytest.approx(1.5, abs=0.004)
    assert (beacon.right, beacon.left) == (1, 0)
    assert last(packets, Status).battery == pytest.approx(7.1, abs=0.01)


def test_it_measures_the_fins(robot: EmulatedRobot) -> None:
    motor = last(robot.listen(0.1), Motor)
    assert motor.angle == pytest.approx(robot.board.fins().angles, abs=math.tau / 1024)


def test_its_attitude_follows_the_turn_rate(robot: EmulatedRobot) -> None:
    robot.board.sense(STILL_WATER._replace(rate=(0.0, 0.0, 0.5)))
    before = last(robot.listen(0.1), Imu).attitude
    after = last(robot.listen(1.0), Imu).attitude
    turned = 2 * (math.atan2(after[3], after[0]) - math.atan2(before[3], before[0]))
    assert turned == pytest.approx(0.5, abs=0.01)


# Pace


def test_it_keeps_100_hz(robot: EmulatedRobot) -> None:
    robot.arm()
    packets = robot.converse(5.0, DOWN)
    times = [imu.time for imu in all_of(packets, Imu)]
    assert len(times) == pytest.approx(500, abs=1)
    gaps = [later - earlier for earlier, later in pairwise(times)]
    assert max(gaps) < 12_000  # µs
    assert len(all_of(packets, Motor)) == pytest.approx(250, abs=1)
    assert len(all_of(packets, Depth)) == pytest.approx(250, rel=0.15)
    status = last(packets, Status)
    assert status.missed_ticks == 0
    assert status.loop_worst < 10_000
    assert (status.frames_invalid, status.bytes_lost) == (0, 0)
    assert robot.board.stats()["overruns"] == 0


def test_its_parameters_are_taken_and_clamped_while_it_swims(robot: EmulatedRobot) -> None:
    numbers = {parameter.name: number for number, parameter in enumerate(CHIP_PARAMETERS)}
    robot.arm()
    robot.converse(1.0, DOWN)
    for name, value in (("fins.amplitude", 0.4), ("fins.gain", 1.3), ("battery.alarm", 7.0)):
        robot.send(Parameter(number=numbers[name], value=value))
    answers = all_of(robot.converse(0.5, DOWN), Parameter)
    in_force = {answer.number: answer.value for answer in answers}
    # The second is out of range, and the third waits for the disarmed robot.
    assert in_force == {
        numbers["fins.amplitude"]: pytest.approx(0.4),
        numbers["fins.gain"]: pytest.approx(0.625),
        numbers["battery.alarm"]: pytest.approx(6.2),
    }
    packets = robot.converse(1.6, DOWN)
    set_points = [motor.wanted[0] for motor in all_of(packets, Motor)]
    assert max(set_points) - min(set_points) == pytest.approx(0.4, abs=0.02)
    status = last(packets, Status)
    assert status.loop_worst < 10_000
    assert status.stack_free > 50


def test_a_motor_packet_carries_the_time_of_its_measurement(robot: EmulatedRobot) -> None:
    robot.arm()
    packets = robot.converse(1.0, DOWN)
    # They share a frame, and the fins' turn in a tick comes first.
    pairs = [(first, second) for first, second in pairwise(packets) if isinstance(second, Motor)]
    for imu, motor in pairs:
        assert isinstance(imu, Imu)
        assert 0 < imu.time - motor.time < 10_000
    assert len(pairs) > 40


# Safety


def test_start_is_refused_without_steady_traffic_or_with_another_epoch(robot: EmulatedRobot) -> None:
    hello = robot.greet()
    robot.send(Start(epoch=hello.epoch))
    assert not robot.status().flags & StatusFlag.ARMED
    robot.converse(0.7)
    robot.send(Start(epoch=hello.epoch + 1))
    assert not robot.status().flags & StatusFlag.ARMED
    robot.send(Start(epoch=hello.epoch))
    assert robot.status().flags & StatusFlag.ARMED
    refusals = [event for event in all_of(robot.heard, BoardEvent) if event.kind == BoardEventKind.REFUSED]
    assert len(refusals) == 2


def record_fins(robot: EmulatedRobot, period: float = 0.01) -> list[FinMotion]:
    fins: list[FinMotion] = []

    def water(motion: FinMotion) -> Reading:
        fins.append(motion)
        return STILL_WATER

    robot.board.attach(period, water)
    return fins


def test_the_fins_follow_a_command(robot: EmulatedRobot) -> None:
    robot.arm()
    robot.converse(1.5, DOWN)
    fins = record_fins(robot)
    robot.converse(4.0, DOWN)
    assert all(motion.powered for motion in fins)
    for fin in range(4):
        angles = [motion.angles[fin] for motion in fins]
        # The thrust is down with the tips up; the amplitude is 1.6 rad from peak to peak.
        middle = (max(angles) + min(angles)) / 2
        assert middle == pytest.approx(-math.pi / 2, abs=0.15)
        assert 1.3 < max(angles) - min(angles) < 1.7
        assert frequency(angles, middle, 0.01) == pytest.approx(FLAPPING, rel=0.03)


def frequency(values: list[float], middle: float, period: float) -> float:
    """Frequency in Hz, from the upward crossings of the middle."""
    rising = [i for i in range(1, len(values)) if values[i - 1] < middle <= values[i]]
    return (len(rising) - 1) / ((rising[-1] - rising[0]) * period)


def test_a_silent_host_leads_to_rest_and_then_to_disarming(robot: EmulatedRobot) -> None:
    robot.arm()
    robot.converse(1.5, DOWN)
    fins = record_fins(robot)
    neutral = robot.until(lambda status: bool(status.flags & StatusFlag.NEUTRAL), limit=0.62)
    # A Status comes every 100 ms, and the last command was up to 100 ms old.
    assert neutral >= 0.25 - 0.1
    disarmed = neutral + robot.until(lambda status: not status.flags & StatusFlag.ARMED, limit=1.0)
    assert 0.9 <= disarmed <= 1.12
    robot.listen(0.1)
    resting = [motion for motion in fins[50:90] if max(map(abs, motion.speeds)) > 1.5]
    assert not resting
    assert fins[-1].drives == (0, 0, 0, 0)
    assert not fins[-1].powered


def test_stop_stops_within_a_tick(robot: EmulatedRobot) -> None:
    robot.arm()
    robot.converse(1.5, DOWN)
    robot.stop()
    fins = record_fins(robot, 0.001)
    robot.listen(0.3)
    assert not any(motion.powered for motion in fins[5:])
    assert fins[-1].speeds == pytest.approx((0, 0, 0, 0), abs=0.01)
    assert not robot.status().flags & StatusFlag.ARMED


def test_the_watchdog_brings_a_hung_board_back_disarmed(programs: Programs) -> None:
    robot = programs.start("robot_hang")
    robot.arm()
    assert robot.board.stats()["watchdog_resets"] == 0
    first_epoch = last(robot.heard, Status).epoch
    silences = [0.0]
    for _ in range(400):
        packets = robot.converse(0.01, DOWN)
        silences.append(0.0 if packets else silences[-1] + 0.01)
        if all_of(packets, Hello):
            break
    assert 0.2 < max(silences) < 0.5
    assert last(packets, Hello).epoch == first_epoch + 1
    assert robot.board.stats()["watchdog_resets"] == 1
    packets = robot.converse(0.3, DOWN)
    status = last(packets, Status)
    assert status.reset_cause == ResetCause.WATCHDOG
    assert not status.flags & (StatusFlag.ARMED | StatusFlag.MOTOR_POWER)
    assert not robot.board.fins().powered


@pytest.mark.parametrize(
    ("device", "fault"),
    [
        ("imu", DeviceFault.IMU),
        ("pressure", DeviceFault.PRESSURE),
        ("encoder0", DeviceFault.ENCODER_FRONT_RIGHT),
        ("encoder1", DeviceFault.ENCODER_BACK_RIGHT),
        ("encoder2", DeviceFault.ENCODER_BACK_LEFT),
        ("encoder3", DeviceFault.ENCODER_FRONT_LEFT),
    ],
)
def test_an_absent_device_shows_and_heals(robot: EmulatedRobot, device: str, fault: DeviceFault) -> None:
    robot.board.fault(device, "absent")
    assert last(robot.listen(0.4), Status).faults == fault
    robot.board.fault(device, "none")
    assert last(robot.listen(0.6), Status).faults == 0


@pytest.mark.parametrize("fin", range(4))
@pytest.mark.parametrize("mistake", ["leads-reversed", "encoder-reversed"])
def test_a_fin_with_swapped_leads_or_encoder_is_stopped_within_300_ms(
    robot: EmulatedRobot, mistake: str, fin: int
) -> None:
    robot.board.mistake(f"{mistake}:{FINS[fin]}")
    robot.arm()
    motors = all_of(robot.converse(1.5, DOWN), Motor)
    driven = [motor.time for motor in motors if motor.drive[fin]]
    assert driven[-1] - driven[0] < 300_000  # µs
    assert robot.status().faults == DeviceFault.TRACKING_FRONT_RIGHT << fin
    assert robot.board.fins().speeds[fin] == pytest.approx(0, abs=0.02)
    assert all(max(abs(motor.drive[other]) for motor in motors[-20:]) > 10 for other in {0, 1, 2, 3} - {fin})


@pytest.mark.parametrize("gain", [0.3, 1.2])
@pytest.mark.parametrize("frequency", [0.3, 2.0])
def test_no_sound_fin_is_stopped_by_any_command(robot: EmulatedRobot, gain: float, frequency: float) -> None:
    numbers = {parameter.name: number for number, parameter in enumerate(CHIP_PARAMETERS)}
    robot.arm()
    for name, value in (("fins.gain", gain), ("fins.frequency", frequency)):
        robot.send(Parameter(number=numbers[name], value=value))
    for command in (*COMMANDS, *COMMANDS[::5]):
        robot.converse(0.7, command)
        assert robot.status().faults == 0


IMPERFECT = [
    ["encoder-noise:3", "backlash:0.1", "pack-resistance:0.5"],
    ["stiction:6"],
    ["stiction:12"],
    ["stiction:18"],
    ["stiction:18", "backlash:0.05", "pack-resistance:0.5"],
]


@pytest.mark.parametrize("mistakes", IMPERFECT, ids=" ".join)
def test_no_sound_fin_with_imperfect_parts_is_stopped(robot: EmulatedRobot, mistakes: list[str]) -> None:
    numbers = {parameter.name: number for number, parameter in enumerate(CHIP_PARAMETERS)}
    for mistake in mistakes:
        robot.board.mistake(mistake)
    robot.arm()
    for gain, frequency in ((0.3, 0.3), (1.2, 2.0)):
        for name, value in (("fins.gain", gain), ("fins.frequency", frequency)):
            robot.send(Parameter(number=numbers[name], value=value))
        for command in COMMANDS[:6]:
            robot.converse(0.7, command)
            assert robot.status().faults == 0


def test_fins_that_hardly_turn_are_stopped_within_300_ms(robot: EmulatedRobot) -> None:
    robot.board.mistake("stiction:40")
    robot.arm()
    motors = all_of(robot.converse(1.0, DOWN), Motor)
    driven = [motor.time for motor in motors if any(motor.drive)]
    assert driven[-1] - driven[0] < 300_000  # µs
    assert robot.status().faults == sum(DeviceFault.TRACKING_FRONT_RIGHT << fin for fin in range(4))


def test_an_absent_bridge_shows_while_it_has_power(robot: EmulatedRobot) -> None:
    robot.arm()
    robot.board.fault("bridge2", "absent")
    assert robot.status().faults == DeviceFault.BRIDGE_BACK_LEFT
    robot.board.fault("bridge2", "none")
    robot.converse(0.4)
    assert robot.status().faults == 0


def test_no_reset_under_water_moves_the_surface(programs: Programs) -> None:
    robot = programs.start("robot_hang")
    robot.listen(1.0)  # at the surface, whose pressure it takes as zero depth
    robot.board.sense(STILL_WATER._replace(pressure=STILL_WATER.pressure + 1.5 * 9810))
    for _ in range(3):
        robot.board.reset()
        robot.listen(BOOT_SECONDS)
        robot.greet()
        assert robot.status().reset_cause == ResetCause.EXTERNAL
        assert last(robot.heard, Depth).depth == pytest.approx(1.5, abs=0.01)
    robot.arm()
    robot.converse(3.0, DOWN)
    assert robot.status().reset_cause == ResetCause.WATCHDOG
    assert last(robot.heard, Depth).depth == pytest.approx(1.5, abs=0.01)


def test_the_boot_counter_survives(programs: Programs, tmp_path: Path) -> None:
    options = ("--eeprom", str(tmp_path / "eeprom"))
    first = programs.start("robot", *options)
    epoch = last(first.heard, Hello).epoch
    first.rig.process.stop()
    second = programs.start("robot", *options)
    assert last(second.heard, Hello).epoch == epoch + 1


@pytest.mark.parametrize(
    ("counted", "next_epochs"), [(0, (1, 2, 3)), (1234, (1235, 1236, 1237)), (0xFFFE, (1, 2, 3))]
)
def test_no_two_boots_in_a_row_write_the_counter_at_one_place(
    programs: Programs, tmp_path: Path, counted: int, next_epochs: tuple[int, ...]
) -> None:
    contents = eeprom(EMULATED)  # an erased place looks like the epoch 0xFFFF, which is left out
    contents[:2] = counted.to_bytes(2, "little")
    file = tmp_path / "eeprom"
    file.write_bytes(contents)
    robot = programs.start("robot", "--eeprom", str(file))
    written: list[int] = []
    for epoch in next_epochs:
        assert robot.status().epoch == epoch
        after = file.read_bytes()
        written += [at for at in (0, *range(256, 766, 2)) if after[at : at + 2] != contents[at : at + 2]]
        contents = bytearray(after)
        robot.board.reset()
        robot.listen(BOOT_SECONDS)
        robot.greet()
    assert len(written) == len(next_epochs)
    assert all(before != after for before, after in pairwise(written))


def test_the_boot_counter_begins_anew_where_its_room_is_full(programs: Programs, tmp_path: Path) -> None:
    contents = eeprom(EMULATED)
    contents[:2] = b"\7\0"
    contents[256:766] = b"".join(epoch.to_bytes(2, "little") for epoch in range(8, 263))
    file = tmp_path / "eeprom"
    file.write_bytes(contents)
    robot = programs.start("robot", "--eeprom", str(file))
    assert robot.status().epoch == 263
    robot.board.reset()
    robot.listen(BOOT_SECONDS)
    robot.greet()
    assert robot.status().epoch == 264
    assert file.read_bytes()[:2] == (263).to_bytes(2, "little")


@pytest.mark.parametrize("index", [RECORD_ADDRESS, RECORD_ADDRESS + 20], ids=["another layout", "torn"])
def test_a_calibration_that_the_firmware_refuses_is_replaced(
    programs: Programs, tmp_path: Path, index: int
) -> None:
    contents = eeprom(EMULATED)
    contents[index] ^= 0x55
    file = tmp_path / "eeprom"
    file.write_bytes(contents)
    programs.start("robot", "--eeprom", str(file)).arm()


def test_a_calibration_that_is_not_complete_stays(programs: Programs, tmp_path: Path) -> None:
    contents = eeprom(replace(EMULATED, done=("fins",)))
    file = tmp_path / "eeprom"
    file.write_bytes(contents)
    programs.start("robot", "--eeprom", str(file))
    stored = slice(RECORD_ADDRESS, RECORD_ADDRESS + 30)
    assert file.read_bytes()[stored] == contents[stored]


def eeprom(calibration: CalibrationValues) -> bytearray:
    """Return the contents of an EEPROM with this calibration."""
    return bytearray(RECORD_ADDRESS * b"\xff" + record(calibration.packet())).ljust(1024, b"\xff")


def test_the_led_of_the_chip_counts_down_and_shows_a_fault_first(programs: "Programs") -> None:
    robot = programs.start("robot")
    robot.listen(BOOT_SECONDS)

    def levels(countdown: bool) -> str:
        """Return the LED's levels in the tenths of the last 5 s of a countdown."""
        seen = ""
        for tenth in range(50, 0, -1):
            if countdown:
                robot.send(Countdown(remaining=tenth / 10))
            robot.converse(0.1)
            seen += str(int(robot.board.led()))
        return seen

    robot.arm()
    assert levels(countdown=False) == "1" * 50
    assert levels(countdown=True) == "01100" * 4 + "1111111000" * 3
    robot.converse(0.4)
    assert robot.board.led(), "armed, and the countdown is over"
    robot.board.fault("leak", "wet")
    robot.converse(0.3)
    assert levels(countdown=True).replace("10", "") in ("", "0", "1"), "five blinks a second"
