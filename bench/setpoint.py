"""Delay of a command from the host's port to an H-bridge."""

import random
import tempfile
from pathlib import Path
from statistics import quantiles

from robot_runtime.contract.packets import Navigation
from tests.board.host import TICK, EmulatedRobot, start

_SAMPLES = 400
_STEP = 0.0001
_LIMIT = 0.1
_STILL_TICKS = 5
_STILL_WITHIN = 300


def measure() -> dict[str, float]:
    """Return ms from handing NAVIGATION to the port until an H-bridge is written another drive; 250000 baud.

    The robot is armed and sends its telemetry; its fins rest, with all drives zero. The command is full down
    or full up in turn, which turns all fins round: their wanted angles move by more than the dead zone of
    the position loop in the very first tick, so that what is measured is the way of the command and not the
    fin law's ramp. It comes at a random moment of the firmware's tick. The emulated board is looked at every
    0.1 ms of its own time, which is how much too long a figure may be.
    """
    chance = random.Random(1)
    with tempfile.TemporaryDirectory() as folder, start("robot", Path(folder)) as rig:
        robot = EmulatedRobot(rig)
        robot.listen(0.3)
        robot.arm()
        delays = []
        for sample in range(_SAMPLES):
            _rest(robot)
            robot.listen(chance.uniform(_STEP, TICK))
            robot.send(_navigation(1.0 if sample % 2 else -1.0))
            delays.append(_until_driven(robot) * 1000)
    percentiles = quantiles(delays, n=100)
    return {
        "link.setpoint_to_motor_ms_p50": percentiles[49],
        "link.setpoint_to_motor_ms_p99": percentiles[98],
    }


def _navigation(z: float) -> Navigation:
    return Navigation(x=0.0, y=0.0, z=z, roll=0.0, pitch=0.0, yaw=0.0)


def _rest(robot: EmulatedRobot) -> None:
    """Command nothing until the fins rest where they point, and no motor has been driven for some ticks."""
    still = 0
    for _ in range(_STILL_WITHIN):
        robot.converse(TICK, _navigation(0.0))
        still = 0 if any(robot.board.fins().drives) else still + 1
        if still == _STILL_TICKS:
            return
    raise RuntimeError("the fins do not come to rest")


def _until_driven(robot: EmulatedRobot) -> float:
    passed = 0.0
    while not any(robot.board.fins().drives):
        if passed > _LIMIT:
            raise RuntimeError(f"no motor was driven within {_LIMIT} s")
        robot.board.run(_STEP)
        passed += _STEP
    return passed
