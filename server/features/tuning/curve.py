"""Measured curve of an experiment: gathered from blocks, stored as bytes."""

import json
import zlib
from array import array
from dataclasses import dataclass
from math import isnan
from typing import Any

from robot_runtime.contract.chunks import unpack
from robot_runtime.contract.documents import Control
from robot_runtime.contract.packets import Motor
from robot_runtime.contract.topics import CONTROL, MOTOR, TURNING
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.transport.blocks import Block, read_rows

DIGITS = 6
"""Stored decimals of times and values."""
ANGLE_LOOPS = ("heading", "pitch", "roll")
FINS = 4


@dataclass(frozen=True, slots=True)
class TuningCurve:
    """The ticks of a loop, in order: times in s, values in the loop's unit (m, rad), outputs -1 to 1.

    Times of a stored curve count from the step, or from when the relay took over.
    """

    times: list[float]
    set_points: list[float]
    values: list[float]
    outputs: list[float]

    def add(self, time: float, set_point: float, value: float, output: float) -> None:
        """Add a tick, unless the loop is off or its value unknown."""
        if isnan(set_point) or isnan(value) or isnan(output):
            return
        for column, number in zip(self._columns(), (time, set_point, value, output), strict=True):
            column.append(number)

    def between(self, start: float, end: float, zero: float) -> "TuningCurve":
        """Return the ticks from `start` up to, but not at, `end`, with times relative to `zero`."""
        inside = [index for index, time in enumerate(self.times) if start <= time < end]
        times = [round(self.times[index] - zero, DIGITS) for index in inside]
        rest = ([round(column[index], DIGITS) for index in inside] for column in self._columns()[1:])
        return TuningCurve(times, *rest)

    def to_bytes(self) -> bytes:
        """Return the curve's bytes for storage."""
        return zlib.compress(json.dumps(self._columns()).encode())

    @classmethod
    def from_bytes(cls, data: bytes) -> "TuningCurve":
        """Return the stored curve; empty where none was stored."""
        return cls(*json.loads(unpack(data))) if data else cls([], [], [], [])

    def _columns(self) -> tuple[list[float], list[float], list[float], list[float]]:
        return self.times, self.set_points, self.values, self.outputs


class SampleBuffer:
    """The samples that a run on this loop needs, collected block by block."""

    def __init__(self, loop: str) -> None:
        self.curve = TuningCurve([], [], [], [])
        self.fin_times = array("d")
        self.fins = tuple(array("f") for _ in range(FINS))
        """Angles, rad."""
        self._loop = loop

    def see(self, block: Block) -> None:
        """Process a block of any topic."""
        if block.topic is MOTOR:
            for time, motor in read_rows(block):
                assert isinstance(motor, Motor)
                self.fin_times.append(time)
                for column, angle in zip(self.fins, motor.angle, strict=True):
                    column.append(angle)
        elif block.topic is CONTROL and self._loop == "depth":
            for time, tick in read_rows(block):
                assert isinstance(tick, Control)
                self.curve.add(time, tick.set_point, tick.depth, tick.output)
        elif block.topic is TURNING and self._loop in ANGLE_LOOPS:
            index = ANGLE_LOOPS.index(self._loop)
            for time, tick in read_rows(block):
                turning: Any = tick
                self._add_angle(
                    time, turning.set_point[index], turning.measured[index], turning.output[index]
                )

    def _add_angle(self, time: float, set_point: float, value: float, output: float) -> None:
        """Add a tick of an angle without the jump at ±π: each set point goes the short way from the last."""
        before = self.curve.set_points[-1] if self.curve.set_points else set_point
        near = before + wrap_angle(set_point - before)
        self.curve.add(time, near, near + wrap_angle(value - set_point), output)
