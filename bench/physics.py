"""Speed of the simulated water: simulated seconds in a real second."""

import time
from math import cos, pi, sin

from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import FinMotion, Simulator

_PERIOD = 0.005
_STEPS = 20_000
_FLAP = 2 * pi * 1.3


def measure() -> dict[str, float]:
    """Measure four flapping fins, with sensors read every 5 ms as by the emulated board."""
    simulator = Simulator(SimulationParameters(), seed=1)
    began = time.monotonic()
    for step in range(_STEPS):
        phase = _FLAP * step * _PERIOD
        angle, speed = 0.8 * sin(phase), 0.8 * _FLAP * cos(phase)
        fins = FinMotion((angle,) * 4, (speed,) * 4, (30.0,) * 4, powered=True)
        simulator.advance(_PERIOD, fins)
    return {"physics.speed_x": _STEPS * _PERIOD / (time.monotonic() - began)}
