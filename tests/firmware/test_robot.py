"""The whole robot: telemetry and its rates, failing devices, surface, battery, LED, debug lines."""

import math
from collections import Counter
from itertools import pairwise
from random import Random

import pytest

from robot_runtime.contract.packets import (
    Beacon,
    BoardEvent,
    BoardEventKind,
    Countdown,
    DebugLevel,
    Depth,
    DeviceFault,
    Heartbeat,
    Imu,
    Motor,
    Packet,
    ResetCause,
    Start,
    Status,
    StatusFlag,
    Stop,
    ZeroDepth,
)
from tests.firmware.devices import OVERCURRENT
from tests.firmware.robot import BRIDGES, IMU, PRESSURE, SURFACE, TICK, CompiledRobot, hello, navigation

WATER = 9810.0
"""Pa a metre."""
LOW_COUNTS = 630


def counts(packets: list[Packet]) -> Counter[str]:
    return Counter(type(packet).__name__ for packet in packets)


def test_telemetry_comes_at_its_rates(robot: CompiledRobot) -> None:
    robot.run(1000)
    came = counts(robot.run(10000))
    assert came == {"Imu": 1000, "Depth": 500, "Motor": 500, "Beacon": 100, "Status": 100}


def test_telemetry_fills_its_frames(robot: CompiledRobot) -> None:
    """One frame a tick, and one more for the status."""
    robot.run(1000)
    robot.frames = 0
    robot.run(10000)
    assert robot.frames == 1100


def test_telemetry_is_the_same_while_swimming(robot: CompiledRobot) -> None:
    robot.arm()
    robot.run(1)
    robot.swim(1000, navigation(z=1))
    robot.received.clear()
    robot.swim(2000, navigation(z=1))
    assert counts(robot.received) == {"Imu": 200, "Depth": 100, "Motor": 100, "Beacon": 20, "Status": 20}


def test_stamps_are_the_boards_clock(robot: CompiledRobot) -> None:
    robot.run(500)
    times = [packet.time for packet in robot.run(1000) if isinstance(packet, Imu)]
    assert all(later - earlier == 10_000 for earlier, later in pairwise(times))
    assert times[-1] <= robot.now * 1000


def test_devices_are_announced_to_the_first_host(robot: CompiledRobot) -> None:
    robot.run(300)
    assert robot.texts == []
    robot.greet()
    robot.run(300)
    fins = [f"encoder {fin}" for fin in ("front right", "back right", "back left", "front left")]
    assert robot.texts == [
        "boot 1, power on",
        *(f"{name}: ok" for name in ["IMU", "pressure sensor", *fins]),
    ]
    assert robot.status().faults == 0


def test_imu_is_set_up_and_passed_on_raw(robot: CompiledRobot) -> None:
    robot.imu.rate, robot.imu.force = (655, -1310, 65), (100, -200, -8190)
    robot.run(500)
    imu = robot.last(Imu)
    assert [round(rate / 0.00026632423) for rate in imu.rate] == [655, -1310, 65]
    assert [round(force / 0.0011971008) for force in imu.force] == [100, -200, -8190]
    settings = robot.imu.registers
    assert (settings[0x1A], settings[0x1B], settings[0x1C]) == (3, 1 << 3, 1 << 3)
    assert settings[0x6B] & 0x40 == 0


def test_attitude_is_level_at_rest_and_follows_a_turn(robot: CompiledRobot) -> None:
    robot.run(500)
    assert robot.last(Imu).attitude == pytest.approx((1, 0, 0, 0), abs=1e-3)
    robot.imu.rate = (0, 0, round(30 * 65.5))
    robot.run(1000)
    w, x, y, z = robot.last(Imu).attitude
    assert (w, x, y, z) == pytest.approx((0.9659, 0, 0, 0.2588), abs=3e-3)


def test_depth_is_measured_from_the_surface_at_power_on(robot: CompiledRobot) -> None:
    robot.run(1000)
    assert robot.last(Depth).depth == pytest.approx(0, abs=2e-3)
    assert robot.last(Depth).pressure == pytest.approx(SURFACE, abs=3)
    for depth in (0.5, 1.2, 0.05, 12.0):
        robot.pressure.show(SURFACE + depth * WATER)
        robot.run(50)
        assert robot.last(Depth).depth == pytest.approx(depth, abs=2e-3)
    assert robot.last(Depth).temperature == pytest.approx(19.81)


@pytest.mark.parametrize("cause", [ResetCause.WATCHDOG, ResetCause.EXTERNAL, ResetCause.BROWN_OUT])
def test_surface_outlives_a_reset_under_water(robot: CompiledRobot, cause: ResetCause) -> None:
    robot.run(1000)
    robot.pressure.show(SURFACE + 2 * WATER)
    robot.reset(cause)
    assert any(isinstance(packet, Depth) for packet in robot.run(100))
    assert robot.last(Depth).depth == pytest.approx(2, abs=2e-3)


def lose_power_under_water(robot: CompiledRobot, depth: float = 2.0) -> None:
    """Memory and its copy of the surface are lost; EEPROM is not."""
    robot.run(1000)
    robot.pressure.show(SURFACE + depth * WATER)
    robot.run(200)
    robot.reset(ResetCause.POWER_ON)
    robot.greet()
    robot.run(1000)


@pytest.mark.parametrize("depth", [0.15, 2.0])
def test_surface_is_never_measured_under_water(robot: CompiledRobot, depth: float) -> None:
    lose_power_under_water(robot, depth)
    assert robot.last(Depth).depth == pytest.approx(depth, abs=2e-3)
    assert robot.status().faults == DeviceFault.SURFACE
    assert "depth uncertain: supply failed below" in robot.texts
    robot.greet()
    robot.say(Start(epoch=2))
    robot.run(200)
    assert not robot.status().flags & StatusFlag.ARMED
    assert "START refused: depth uncertain" in robot.texts
    robot.pressure.show(SURFACE + 0.02 * WATER)
    robot.run(200)
    assert robot.status().faults == 0
    assert robot.last(Depth).depth == pytest.approx(0.02, abs=2e-3)
    assert "depth certain again" in robot.texts
    robot.arm()


def test_zero_depth_ends_the_doubt_of_a_surface(robot: CompiledRobot) -> None:
    lose_power_under_water(robot, 0.3)  # or the air is heavier now
    robot.say(ZeroDepth())
    robot.run(600)
    assert robot.last(Depth).depth == pytest.approx(0, abs=2e-3)
    assert robot.status().faults == 0
    robot.reset(ResetCause.POWER_ON)
    robot.pressure.show(SURFACE)
    robot.greet()
    robot.run(600)
    assert robot.last(Depth).depth == pytest.approx(0, abs=2e-3)
    assert robot.status().faults == 0


def test_surface_of_an_armed_robot_outlives_a_power_cut(robot: CompiledRobot) -> None:
    robot.run(500)
    robot.arm()
    robot.run(50)
    robot.reset(ResetCause.POWER_ON)
    robot.pressure.show(SURFACE + 0.08 * WATER)
    robot.greet()
    robot.run(600)
    assert robot.last(Depth).depth == pytest.approx(0.08, abs=2e-3)


@pytest.mark.parametrize("cause", [ResetCause.WATCHDOG, ResetCause.EXTERNAL, ResetCause.BROWN_OUT])
@pytest.mark.parametrize("depth", [0.09, 2.0])
def test_surface_of_a_power_cut_outlives_a_reset_once_it_is_certain(
    robot: CompiledRobot, depth: float, cause: ResetCause
) -> None:
    lose_power_under_water(robot)
    robot.pressure.show(SURFACE)
    robot.run(200)
    assert robot.texts[-1] == "depth certain again"
    robot.pressure.show(SURFACE + depth * WATER)
    robot.run(200)
    robot.reset(cause)
    robot.greet()
    robot.run(600)
    assert robot.last(Depth).depth == pytest.approx(depth, abs=2e-3)
    assert robot.status().faults == 0
    robot.arm()


def test_surface_is_taken_anew_at_power_on(robot: CompiledRobot) -> None:
    robot.run(1000)
    robot.pressure.show(SURFACE - 2000)
    robot.reset(ResetCause.POWER_ON)
    robot.run(1000)
    assert robot.last(Depth).depth == pytest.approx(0, abs=2e-3)


@pytest.mark.parametrize(
    ("address", "fault", "name"),
    [(IMU, DeviceFault.IMU, "IMU"), (PRESSURE, DeviceFault.PRESSURE, "pressure sensor")],
)
def test_lost_sensor_is_reported_and_found_again(
    robot: CompiledRobot, address: int, fault: DeviceFault, name: str
) -> None:
    robot.greet()
    robot.run(500)
    robot.absent.add(address)
    robot.run(300)
    assert robot.status().faults == fault
    assert robot.texts[-1] == f"{name}: no sensible answer"
    silent = robot.run(1000)
    assert counts(silent)["Imu" if address == IMU else "Depth"] == 0
    assert counts(silent)["Motor"] == 50
    robot.absent.clear()
    robot.run(600)
    assert robot.status().faults == 0
    assert robot.texts[-1] == f"{name}: ok"
    assert counts(robot.run(1000))["Imu" if address == IMU else "Depth"] in (50, 100)


@pytest.mark.parametrize("identity", [0x70, 0x71, 0x72, 0x98])
def test_a_chip_with_the_imus_registers_is_accepted_and_named(robot: CompiledRobot, identity: int) -> None:
    robot.imu.identity = identity
    robot.reset(ResetCause.EXTERNAL)
    robot.greet()
    robot.run(300)
    assert robot.status().faults == 0
    assert f"IMU: ok, WHO_AM_I 0x{identity:02X}" in robot.texts
    # The filter of the accelerometer, by a register of its own in these.
    assert robot.imu.registers[0x1D] == 0x03
    assert counts(robot.run(1000))["Imu"] == 100


def test_another_chip_at_the_imus_address_is_refused_and_named(robot: CompiledRobot) -> None:
    robot.imu.identity = 0xAF
    robot.reset(ResetCause.EXTERNAL)
    robot.greet()
    robot.run(300)
    assert robot.status().faults == DeviceFault.IMU
    assert "IMU: no sensible answer, WHO_AM_I 0xAF" in robot.texts


def test_an_imu_that_fell_asleep_is_woken(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    awake = robot.imu.force, robot.imu.rate
    robot.imu.force = robot.imu.rate = (0, 0, 0)
    robot.imu.registers.clear()
    heard = robot.run(100)
    assert counts(heard)["Imu"] <= 1
    assert robot.imu.registers[0x6B] == 1
    robot.imu.force, robot.imu.rate = awake
    robot.run(300)
    assert robot.status().faults == 0
    assert counts(robot.run(1000))["Imu"] == 100


@pytest.mark.parametrize("lost", [0x1B, 0x1C])
def test_an_imu_that_woke_with_other_ranges_is_set_up_again(robot: CompiledRobot, lost: int) -> None:
    robot.greet()
    robot.run(500)
    robot.imu.registers[lost] = 0
    robot.run(1100)
    assert robot.imu.registers[lost] == 0x08
    assert robot.status().faults == 0
    assert counts(robot.run(1000))["Imu"] == 100


def test_an_imu_that_answers_only_zeros_is_faulty_until_it_measures(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    awake = robot.imu.force, robot.imu.rate
    robot.imu.force = robot.imu.rate = (0, 0, 0)
    robot.run(100)
    statuses = [packet for packet in robot.run(3000) if isinstance(packet, Status)]
    assert [status.faults for status in statuses] == [DeviceFault.IMU] * 30
    robot.imu.force, robot.imu.rate = awake
    robot.run(300)
    assert robot.status().faults == 0
    assert robot.texts[-2:] == ["IMU: no sensible answer", "IMU: ok"]


def test_a_single_exchange_of_the_pressure_sensor_that_fails_costs_no_depth(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    robot.received.clear()
    for _ in range(20):
        robot.absent.add(PRESSURE)
        robot.run(10)
        robot.absent.clear()
        robot.run(90)
    # Of 100 in 2 s; each failed exchange delays the next reading by a tick.
    assert counts(robot.received)["Depth"] >= 80
    assert {packet.faults for packet in robot.received if isinstance(packet, Status)} == {0}


def test_ticks_that_come_early_spoil_no_pressure(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    answer = robot.imu.transfer

    def answer_late(out: bytes, size: int) -> bytes:
        robot.firmware.board_advance(random.choice((0, 3000, 7400)))
        return answer(out, size)

    random = Random(1)
    robot.imu.transfer = answer_late  # type: ignore[method-assign] # before the pressure sensor's turn
    robot.received.clear()
    robot.run(2000)
    depths = [packet for packet in robot.received if isinstance(packet, Depth)]
    assert len(depths) > 30
    assert {round(packet.depth, 2) for packet in depths} == {0.0}
    assert {packet.faults for packet in robot.received if isinstance(packet, Status)} == {0}


def test_a_weak_magnet_is_reported_and_its_fin_driven(robot: CompiledRobot) -> None:
    robot.yellow.add(2)
    robot.arm()
    robot.swim(500, navigation(z=1))
    assert robot.status().faults == DeviceFault.MAGNET
    assert "encoders: a magnet out of place" in robot.texts
    assert abs(robot.last(Motor).drive[2]) > 5


def test_pressure_sensor_with_a_damaged_prom_is_refused(robot: CompiledRobot) -> None:
    robot.pressure.prom[3] ^= 4
    robot.reset(ResetCause.EXTERNAL)
    robot.received.clear()
    robot.run(1000)
    assert robot.status().faults == DeviceFault.PRESSURE
    assert counts(robot.received)["Depth"] == 0


def test_fin_whose_encoder_is_silent_is_not_driven(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, navigation(x=1))
    robot.blind.add(3)
    robot.swim(500, navigation(x=1))
    assert robot.status().faults == DeviceFault.ENCODER_FRONT_LEFT
    robot.received.clear()
    robot.swim(1000, navigation(x=1))
    drives = [packet.drive for packet in robot.received if isinstance(packet, Motor)]
    assert {drive[3] for drive in drives} == {0}
    assert max(abs(drive[0]) for drive in drives) > 10


MISTAKES = [
    pytest.param({"leads": -1}, 0.3, id="leads swapped"),
    pytest.param({"counting": -1}, 0.3, id="encoder backwards"),
    pytest.param({"leads": 0}, 0.5, id="jammed"),
]


@pytest.mark.parametrize(("mistake", "limit"), MISTAKES)
@pytest.mark.parametrize("fin", range(4))
def test_a_fin_that_does_not_follow_its_drive_is_stopped(
    robot: CompiledRobot, fin: int, mistake: dict[str, int], limit: float
) -> None:
    for name, value in mistake.items():
        setattr(robot.motors[fin], name, value)
    robot.arm()
    robot.swim(1000, navigation(z=1))
    motors = [packet for packet in robot.received if isinstance(packet, Motor)]
    driven = [motor.time for motor in motors if motor.drive[fin]]
    assert (driven[-1] - driven[0]) / 1e6 < limit
    assert robot.status().faults == DeviceFault.TRACKING_FRONT_RIGHT << fin
    assert all(max(abs(motor.drive[other]) for motor in motors[-20:]) > 10 for other in {0, 1, 2, 3} - {fin})
    robot.say(Stop())
    robot.motors[fin].leads = robot.motors[fin].counting = 1
    robot.run(100)
    robot.arm()
    robot.swim(1000, navigation(z=1))
    assert robot.status().faults == 0


def test_a_fin_whose_encoder_is_back_is_not_driven_for_what_it_drifted_meanwhile(
    robot: CompiledRobot,
) -> None:
    drifted = 20
    robot.arm()
    robot.beat(500)
    robot.blind.add(1)
    robot.beat(500)
    robot.motors[1].shaft += drifted * math.tau / 1024
    robot.blind.clear()
    drives = []
    for _ in range(10):
        robot.run(TICK)
        drives.append(abs(robot.bridges[1].drive))
    # The loop's gain alone, 0.625 for each count.
    assert max(drives) == 12


FINS = ("front right", "back right", "back left", "front left")


def test_the_line_of_every_fault_arrives_whole(robot: CompiledRobot) -> None:
    robot.arm()
    for motor in robot.motors:
        motor.leads = 0
    robot.swim(1000, navigation(z=1))
    assert {f"fin {fin}: not following, stopped" for fin in FINS} <= set(robot.texts)
    robot.absent |= set(BRIDGES)
    robot.yellow = {0}
    robot.beat(1000)
    assert {f"H-bridge {fin}: silent or tripped" for fin in FINS} <= set(robot.texts)
    assert "encoders: a magnet out of place" in robot.texts
    robot.absent |= {IMU, PRESSURE}
    robot.beat(1000)
    robot.blind = set(range(4))
    robot.beat(1000)
    assert {f"encoder {fin}: no sensible answer" for fin in FINS} <= set(robot.texts)
    assert {f"{sensor}: no sensible answer" for sensor in ("IMU", "pressure sensor")} <= set(robot.texts)
    assert robot.status().debug_lost == 0


def test_silent_bridge_is_reported_while_powered(robot: CompiledRobot) -> None:
    robot.absent.add(BRIDGES[1])
    robot.run(300)
    assert robot.status().faults == 0
    robot.arm()
    robot.beat(300)
    assert robot.status().faults == DeviceFault.BRIDGE_BACK_RIGHT
    robot.say(Stop())
    robot.run(100)
    assert robot.status().faults == 0


def test_a_fault_of_a_bridge_is_reported_and_cleared(robot: CompiledRobot) -> None:
    robot.arm()
    robot.bridges[2].fault = OVERCURRENT
    robot.beat(500)
    assert robot.bridges[2].clears == 1
    assert "H-bridge back left: silent or tripped" in robot.texts
    robot.beat(500)
    assert robot.texts[-1] == "H-bridge back left: ok"
    assert robot.status().faults == 0


def test_a_bridge_that_trips_once_drives_its_fin_again(robot: CompiledRobot) -> None:
    """Its fault is read every 400 ms, while its fin stands still: at every phase of that."""
    robot.arm()
    robot.swim(500, navigation(z=1))
    for phase in range(0, 400, 10):
        robot.swim((phase - robot.now) % 400, navigation(z=1))
        robot.bridges[1].fault = OVERCURRENT
        robot.swim(2000, navigation(z=1))
        assert robot.bridges[1].fault == 0
        assert robot.status().faults == 0
        motors = [packet for packet in robot.received if isinstance(packet, Motor)]
        assert max(abs(motor.drive[1]) for motor in motors[-20:]) > 10


@pytest.mark.parametrize("phase", range(0, 400, 50))
def test_a_bridge_that_trips_again_and_again_is_not_driven_any_more(robot: CompiledRobot, phase: int) -> None:
    robot.arm()
    robot.swim(500 + phase, navigation(z=1))
    robot.received.clear()
    robot.bridges[1].shorted = True
    robot.swim(2000, navigation(z=1))
    driven = [packet.time for packet in robot.received if isinstance(packet, Motor) and packet.drive[1]]
    assert (driven[-1] - driven[0]) / 1e6 < 0.75
    assert robot.status().faults == DeviceFault.TRACKING_BACK_RIGHT


def test_motor_reports_drives_as_the_bridges_got_them(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(1000, navigation(z=1))
    for _ in range(30):
        robot.say(navigation(z=1))
        drives = tuple(bridge.drive for bridge in robot.bridges)
        # Bytes received now were sent at the tick before.
        if any(isinstance(packet, Motor) for packet in robot.run(10)):
            assert robot.last(Motor).drive == drives
            assert robot.last(Motor).angle == pytest.approx([motor.fin for motor in robot.motors], abs=0.15)
    assert max(abs(drive) for drive in robot.last(Motor).drive) <= 40


def test_beacons_are_passed_on(robot: CompiledRobot) -> None:
    for right, left in ((True, False), (False, True), (False, False)):
        robot.firmware.board_set_beacons(right, left)
        robot.run(110)
        assert (robot.last(Beacon).right, robot.last(Beacon).left) == (right, left)


def test_battery_is_measured(robot: CompiledRobot) -> None:
    robot.firmware.board_set_battery(757)
    robot.run(300)
    assert robot.last(Status).battery == pytest.approx(7.4, abs=0.01)


def test_low_battery_for_20_s_turns_the_fins_down_and_disarms(robot: CompiledRobot) -> None:
    robot.arm()
    robot.firmware.board_set_battery(LOW_COUNTS)
    robot.swim(19_900, navigation(x=1))
    assert robot.texts[-1] == "armed"
    robot.swim(400, navigation(x=1))
    assert robot.lines[-1].text == "disarmed: battery is low"
    assert robot.lines[-2].text == "battery at 6.16 V: fins down, disarmed"
    assert robot.lines[-2].level == DebugLevel.ERROR
    assert robot.power
    robot.swim(1500, navigation(x=1))
    assert not robot.power
    assert [motor.fin for motor in robot.motors] == pytest.approx([1.57] * 4, abs=0.05)
    assert robot.status().flags & (StatusFlag.BATTERY_LOW | StatusFlag.ARMED) == StatusFlag.BATTERY_LOW


def test_stop_cuts_power_while_the_fins_turn_down(robot: CompiledRobot) -> None:
    robot.arm()
    robot.firmware.board_set_battery(LOW_COUNTS)
    robot.swim(20_200, navigation(x=1))
    assert robot.power
    assert "disarmed: battery is low" in robot.texts
    robot.say(Stop())
    robot.run(1)
    assert not robot.power
    robot.run(300)
    assert not robot.power


def test_low_battery_forbids_arming_even_after_it_recovers(robot: CompiledRobot) -> None:
    robot.firmware.board_set_battery(LOW_COUNTS)
    robot.run(20_200)
    assert not robot.power
    robot.firmware.board_set_battery(700)
    robot.greet()
    assert "battery at 6.16 V: arming refused" in robot.texts
    robot.say(Start(epoch=robot.epoch))
    robot.run(30)
    assert robot.texts[-1] == "START refused: battery is low"
    assert not robot.power


def dip_with_each_stroke(robot: CompiledRobot, low: int, strokes: int) -> bool:
    """Lower the voltage for `low` ms of each stroke of 800 ms; return True if the alarm comes."""
    for _ in range(strokes):
        robot.firmware.board_set_battery(LOW_COUNTS)
        robot.run(low)
        robot.firmware.board_set_battery(700)
        robot.run(800 - low)
    return bool(robot.status().flags & StatusFlag.BATTERY_LOW)


def test_battery_that_dips_is_no_alarm(robot: CompiledRobot) -> None:
    assert not dip_with_each_stroke(robot, 100, 750)


def test_a_battery_that_was_low_for_less_than_20_s_recovers(robot: CompiledRobot) -> None:
    robot.firmware.board_set_battery(LOW_COUNTS)
    robot.run(15_000)
    assert not dip_with_each_stroke(robot, 100, 50)


@pytest.mark.parametrize(("low", "strokes"), [(330, 95), (200, 160)])
def test_a_worn_battery_is_low_soon(robot: CompiledRobot, low: int, strokes: int) -> None:
    assert dip_with_each_stroke(robot, low, strokes)


def test_battery_that_is_not_connected_is_no_alarm(robot: CompiledRobot) -> None:
    robot.firmware.board_set_battery(3)
    robot.run(25_000)
    assert not robot.status().flags & StatusFlag.BATTERY_LOW


def lit_share(robot: CompiledRobot) -> tuple[float, int]:
    """Return the share of a second in which the LED is lit, and the number of flashes."""
    seen = []
    for _ in range(100):
        robot.say(Heartbeat(time=0))
        robot.run(10)
        seen.append(bool(robot.firmware.board_led()))
    return sum(seen) / 100, sum(
        now and not before for before, now in zip(seen[-1:] + seen, seen, strict=False)
    )


def test_the_led_shows_disarmed_armed_and_fault(robot: CompiledRobot) -> None:
    robot.run(500)
    assert lit_share(robot) == (0.1, 1)
    robot.arm()
    assert lit_share(robot) == (1, 0)
    robot.absent.add(IMU)
    robot.run(50)
    assert lit_share(robot) == (0.5, 5)


def led_levels(robot: CompiledRobot, remaining: int) -> str:
    """Return the LED's levels, 1 or 0, in the ticks of this tenth of a second of a countdown."""
    robot.say(Heartbeat(time=0), Countdown(remaining=remaining / 10))
    levels = ""
    for _ in range(10):
        robot.run(10)
        levels += str(int(robot.firmware.board_led()))
    return levels


def test_the_led_counts_down_while_armed_and_expires(robot: CompiledRobot) -> None:
    robot.run(500)
    robot.greet()
    assert "".join(led_levels(robot, 40 - tenth) for tenth in range(10)).count("1") == 10, "disarmed"
    robot.arm()
    levels = "".join(led_levels(robot, 50 - tenth)[-1] for tenth in range(50))
    assert levels == "01100" * 4 + "1111111000" * 3
    # Dark: without another packet it is lit again after 300 ms.
    assert led_levels(robot, 33) == "1" * 10
    assert led_levels(robot, 32) == "0" * 10
    robot.say(Heartbeat(time=0))
    assert [robot.firmware.board_led() for _ in range(25) if robot.run(10) is not None] == [False] * 19 + [
        True
    ] * 6


def test_a_countdown_hides_no_fault(robot: CompiledRobot) -> None:
    robot.run(500)
    robot.arm()
    robot.absent.add(IMU)
    robot.run(50)
    levels = "".join(led_levels(robot, 100 - tenth) for tenth in range(20))
    assert "0" * 10 + "1" * 10 in levels
    assert max(map(len, levels.split("1"))) == max(map(len, levels.split("0"))) == 10


def test_flood_of_lines_is_dropped_and_counted_and_blocks_nothing(robot: CompiledRobot) -> None:
    robot.greet()
    robot.received.clear()
    for _ in range(100):
        robot.say(*[Start(epoch=999)] * 15)
        robot.run(10)
    came = counts(robot.received)
    assert came["Imu"] == 100
    assert came["BoardEvent"] > 50
    status = robot.status()
    refusals = sum(
        packet.kind == BoardEventKind.REFUSED for packet in robot.received if isinstance(packet, BoardEvent)
    )
    assert refusals + status.debug_lost == pytest.approx(1500, abs=10)
    assert status.debug_lost > 0
    assert not robot.power


def test_flood_of_bytes_does_not_stop_the_ticks(robot: CompiledRobot) -> None:
    robot.run(500)
    robot.received.clear()
    for _ in range(100):
        robot.send(b"\x01\x02\0" * 80)
        robot.run(10)
    assert counts(robot.received)["Imu"] == 100
    assert robot.status().missed_ticks == 0


def test_flood_of_frames_is_taken_one_a_pass(robot: CompiledRobot) -> None:
    """A chip that takes long for each frame still does its ticks; a pass here is a millisecond."""
    robot.run(500)
    robot.send(b"\x01\x02\0" * 1000)
    start = robot.now
    assert 0 < robot.status().frames_invalid <= robot.now - start


def test_full_line_drops_whole_frames_and_no_line_uncounted(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    robot.lines.clear()
    for _ in range(300):
        robot.say(*[hello()] * 6, Start(epoch=999))
        robot.run(1)
    assert robot.firmware.board_overwritten() == 0
    for _ in range(300):
        robot.beat(20, every=20)
    lost = robot.status().debug_lost
    assert lost > 0
    assert len(robot.lines) + lost == 300
    came = counts(robot.run(1000))
    assert came == {"Imu": 100, "Depth": 50, "Motor": 50, "Beacon": 10, "Status": 10}
