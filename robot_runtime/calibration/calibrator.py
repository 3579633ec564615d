"""The operator's part in the calibration: storing it, measuring the gyroscope, setting the surface."""

import threading
from collections.abc import Callable
from dataclasses import replace
from math import degrees

from robot_runtime.calibration.board_calibration import BoardCalibration
from robot_runtime.calibration.gyro import GyroMeasurement, Rate
from robot_runtime.clock import Clock
from robot_runtime.contract.calibration import GYRO_BIAS, STEPS, CalibrationValues
from robot_runtime.contract.documents import CalibrationKept, Severity
from robot_runtime.contract.packets import ZeroDepth
from robot_runtime.errors import RefusedError
from robot_runtime.parameters.board import Send


class Calibrator:
    """The operator's changes to the calibration of `board`; `tell` publishes a sentence.

    All methods raise RefusedError with the reason.
    """

    def __init__(
        self,
        clock: Clock,
        send: Send,
        baud: int,
        *,
        armed: Callable[[], bool],
        tell: Callable[[str, Severity], None],
        publish: Callable[[CalibrationKept], None],
    ) -> None:
        self.board = BoardCalibration(clock, send, baud, self.publish)
        self._clock = clock
        self._send = send
        self._armed = armed
        self._tell = tell
        self._publish = publish
        self._gyro: GyroMeasurement | None = None

    def publish(self) -> None:
        """Publish the board's calibration."""
        stored = self.board.values
        missing = [STEPS[name] for name in stored.missing] if stored else []
        self._publish(CalibrationKept(time=self._clock.now(), values=stored, missing=missing))

    def see_imu(self, time: float, record: bytes) -> None:
        """Take a reading of the IMU at `time` (s)."""
        if (gyro := self._gyro) is not None:
            gyro.see(time, record)

    def store(self, values: CalibrationValues) -> None:
        """Store a calibration in the board."""
        self._require_disarmed("The board takes a calibration only while it is disarmed.")
        self.board.store(values)

    def measure_gyro(self) -> None:
        """Begin to measure the gyroscope's offset at rest; an event reports the result some seconds later."""
        self._require_disarmed("The gyroscope is measured at rest, so not while the robot is armed.")
        stored = self.board.require()
        if self._gyro is not None:
            raise RefusedError("The gyroscope is being measured already.")
        self._gyro = gyro = GyroMeasurement()
        threading.Thread(target=self._complete_gyro, args=(gyro, stored), name="gyro", daemon=True).start()

    def _complete_gyro(self, gyro: GyroMeasurement, stored: CalibrationValues) -> None:
        try:
            self._tell(self._keep_gyro(gyro.result(), stored), "info")
        except RefusedError as problem:
            self._tell(f"The gyroscope was not measured. {problem}", "caution")
        finally:
            self._gyro = None

    def _keep_gyro(self, measured: Rate, stored: CalibrationValues) -> str:
        if self.board.require() != stored:
            raise RefusedError("The calibration was changed meanwhile. Measure again.")
        # The board has taken away what it keeps as the offset.
        forward, right, down = (old + new for old, new in zip(stored.gyro_bias, measured, strict=True))
        if max(map(abs, (forward, right, down))) > GYRO_BIAS.maximum:
            raise RefusedError(
                f"The turn rate at rest is {_in_degrees(forward, right, down)}. No sound gyroscope shows so "
                "much: check the IMU."
            )
        done = tuple(name for name in STEPS if name in stored.done or name == "gyro")
        self.store(replace(stored, gyro_bias=(forward, right, down), done=done))
        return f"The gyroscope's offset is {_in_degrees(forward, right, down)}; the board keeps it."

    def zero_depth(self) -> None:
        """Set the board's surface pressure to the pressure now."""
        self._require_disarmed("The surface is measured only while the robot is disarmed.")
        if not self._send(ZeroDepth()):
            raise RefusedError("There is no connection to the board.")
        self._tell("The pressure now is taken for the surface's.", "info")

    def _require_disarmed(self, otherwise: str) -> None:
        if self._armed():
            raise RefusedError(otherwise)


def _in_degrees(*rates: float) -> str:
    return ", ".join(f"{degrees(rate):.2f}" for rate in rates) + " °/s"
