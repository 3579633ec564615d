"""The calibration that a board keeps: asked for, missing steps in words, stored; the gyroscope at rest."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import product
from math import radians

import pytest

from robot_runtime.calibration.calibrator import Calibrator
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.calibration import EMULATED, STEPS, CalibrationValues
from robot_runtime.contract.documents import CalibrationKept, Severity
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.packets import Calibration, Imu, Packet, RequestCalibration, ZeroDepth
from robot_runtime.errors import RefusedError
from tests.waiting import SECONDS


class CalibratorRig:
    """A calibrator, and a board that answers at once unless it is silent or full."""

    def __init__(self) -> None:
        self.clock = SimulatedClock()
        self.record: Calibration = EMULATED.packet()
        self.connected, self.silent, self.worn, self.armed = True, False, False, False
        self.late: Calibration | None = None
        """An answer that is still on the line, before the next one."""
        self.sent: list[Packet] = []
        self.texts: list[str] = []
        self.heard = threading.Event()
        self.published: list[CalibrationKept] = []
        self.calibrator = Calibrator(
            self.clock,
            self.send,
            250_000,
            armed=lambda: self.armed,
            tell=self._hear,
            publish=self.published.append,
        )

    def send(self, *packets: Packet) -> bool:
        if not self.connected:
            return False
        self.sent += packets
        for packet in packets:
            if isinstance(packet, Calibration) and not self.worn:
                self.record = packet
            if isinstance(packet, Calibration | RequestCalibration) and not self.silent:
                # In the link's own thread, as the answer of a board.
                threading.Thread(target=self._answer, args=(self.late, self.record)).start()
        return True

    def _answer(self, late: Calibration | None, stored: Calibration) -> None:
        if late is not None:
            self.calibrator.board.see(late)
            time.sleep(0.05)  # the line needs that
        self.calibrator.board.see(stored)

    def _hear(self, text: str, severity: Severity) -> None:
        self.texts.append(f"{severity}: {text}")
        self.heard.set()

    def measure(self) -> str:
        """Measure the gyroscope; return what is told of it."""
        self.calibrator.measure_gyro()
        assert self.heard.wait(SECONDS)
        return self.texts[-1]

    def ask(self) -> None:
        self.calibrator.board.tick()
        for thread in threading.enumerate():
            if thread is not threading.current_thread() and not thread.daemon:
                thread.join()


@pytest.fixture
def rig() -> CalibratorRig:
    return CalibratorRig()


def test_the_board_is_asked_and_its_answer_published(rig: CalibratorRig) -> None:
    assert rig.calibrator.board.refusals() == ["The board has not told its calibration yet. Wait a moment."]
    rig.ask()
    assert rig.calibrator.board.values == EMULATED
    assert rig.calibrator.board.refusals() == []
    assert (rig.published[-1].values, rig.published[-1].missing) == (EMULATED, [])


def test_a_silent_board_is_asked_once_a_second(rig: CalibratorRig) -> None:
    rig.silent = True
    for _ in range(35):
        rig.calibrator.board.tick()
        rig.clock.forward(0.1)
    assert rig.sent == [RequestCalibration()] * 4


def test_another_board_is_asked_again(rig: CalibratorRig) -> None:
    rig.ask()
    rig.record = replace(EMULATED, done=()).packet()
    rig.calibrator.board.forget()
    assert rig.calibrator.board.values is None
    rig.ask()
    (reason,) = rig.calibrator.board.refusals()
    assert reason == f"The board is not calibrated. Missing: {'; '.join(STEPS.values())}."


def test_impossible_axes_of_a_board_are_named(rig: CalibratorRig) -> None:
    rig.record = replace(EMULATED.packet(), axes=(0, 1, 2))
    rig.ask()
    assert "impossible axes" in rig.calibrator.board.refusals()[0]


def test_a_stored_calibration_is_what_the_board_keeps(rig: CalibratorRig) -> None:
    rig.ask()
    values = replace(EMULATED, fin_zeros=(1, 2, 3, 4), done=("fins",))
    rig.calibrator.store(values)
    assert rig.calibrator.board.values == values
    assert rig.published[-1].missing == [STEPS[name] for name in values.missing]


@pytest.mark.parametrize(
    ("trouble", "message"),
    [
        ("connected", "no connection"),
        ("worn", "did not store it"),
        ("armed", "only while it is disarmed"),
    ],
)
def test_what_is_not_stored_is_refused_with_the_reason(
    rig: CalibratorRig, trouble: str, message: str
) -> None:
    rig.ask()
    setattr(rig, trouble, trouble != "connected")
    with pytest.raises(RefusedError, match=message):
        rig.calibrator.store(replace(EMULATED, fin_zeros=(1, 2, 3, 4)))
    assert rig.calibrator.board.values == EMULATED


@contextmanager
def readings(
    rig: CalibratorRig, rate: Callable[[float], tuple[float, float, float]], noise: float = 1e-3
) -> Iterator[None]:
    """The IMU's stream at 100 Hz, with this turn rate and noise (rad/s) at each time (s)."""
    over = threading.Event()

    def stream() -> None:
        number = 0
        while not over.is_set():
            forward, right, down = rate(0.01 * number)
            turning = (forward + (noise if number % 2 else -noise), right, down)
            imu = Imu(time=0, attitude=(1, 0, 0, 0), rate=turning, force=(0, 0, -9.8))
            rig.calibrator.see_imu(0.01 * number, imu.to_bytes())
            number += 1

    thread = threading.Thread(target=stream)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def test_the_gyroscopes_offset_is_added_to_what_the_board_took_away(rig: CalibratorRig) -> None:
    before = (radians(1), radians(-2), 0.0)
    rig.record = replace(EMULATED, gyro_bias=before, done=("fins",)).packet()
    rig.ask()
    with readings(rig, lambda _: (radians(0.5), radians(0.8), radians(20))):
        report = rig.measure()
    stored = rig.calibrator.board.require()
    assert stored.gyro_bias == pytest.approx((radians(1.5), radians(-1.2), radians(20)), abs=3e-4)
    assert stored.done == ("fins", "gyro")
    assert report.endswith(", 20.00 °/s; the board keeps it.")


@pytest.mark.parametrize(
    ("rate", "message"),
    [
        (lambda time: (0.03 if time % 0.5 < 0.25 else -0.03, 0.0, 0.0), "moved about its forward axis"),
        (lambda time: (0.0, 0.012 * time, 0.0), "moved about its right axis"),
        (lambda _: (0.0, 0.0, 0.8), "No sound gyroscope shows so much"),
    ],
)
def test_a_robot_that_moves_is_not_measured(
    rig: CalibratorRig, rate: Callable[[float], tuple[float, float, float]], message: str
) -> None:
    rig.ask()
    with readings(rig, rate):
        report = rig.measure()
    assert report.startswith("caution: The gyroscope was not measured.")
    assert message in report
    assert rig.calibrator.board.values == EMULATED


def test_a_gyroscope_whose_readings_do_not_change_is_not_measured(rig: CalibratorRig) -> None:
    rig.ask()
    with readings(rig, lambda _: (0.1, 0.0, 0.0), noise=0.0):
        report = rig.measure()
    assert "the IMU has stopped" in report
    assert rig.calibrator.board.values == EMULATED


def test_what_was_stored_while_the_gyroscope_was_measured_stays(rig: CalibratorRig) -> None:
    rig.ask()
    meanwhile = replace(EMULATED, fin_zeros=(1, 2, 3, 4))
    begun = threading.Event()

    def rate(_: float) -> tuple[float, float, float]:
        assert begun.wait(SECONDS)
        if rig.calibrator.board.values == EMULATED:
            rig.calibrator.store(meanwhile)
        return (0.1, 0.0, 0.0)

    with readings(rig, rate):
        rig.calibrator.measure_gyro()
        begun.set()
        assert rig.heard.wait(SECONDS)
    assert "was changed meanwhile" in rig.texts[-1]
    assert rig.calibrator.board.values == meanwhile


def test_an_answer_from_before_is_not_taken_for_that_to_what_is_stored(rig: CalibratorRig) -> None:
    rig.ask()
    rig.calibrator.board.forget()
    rig.silent = True
    rig.calibrator.board.tick()
    rig.silent, rig.late = False, rig.record
    values = replace(EMULATED, fin_zeros=(1, 2, 3, 4))
    rig.calibrator.store(values)
    assert rig.calibrator.board.values == values


def test_the_depth_is_zeroed_only_while_disarmed(rig: CalibratorRig) -> None:
    rig.calibrator.zero_depth()
    assert rig.sent == [ZeroDepth()]
    rig.armed = True
    with pytest.raises(RefusedError, match="while the robot is disarmed"):
        rig.calibrator.zero_depth()


def test_exactly_the_24_turns_of_a_chip_are_possible_axes() -> None:
    possible = 0
    for axes in product(("x", "-x", "y", "-y", "z", "-z"), repeat=3):
        try:
            values = replace(EMULATED, axes=axes)  # type: ignore[arg-type]
        except ConfigError:
            continue
        assert CalibrationValues.from_packet(values.packet()) == values
        possible += 1
    assert possible == 24
