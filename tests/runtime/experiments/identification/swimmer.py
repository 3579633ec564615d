"""A robot that swims at random in simulated water, and its sensors' streams as a session has them.

It stands in for firmware and recording: fins as the firmware turns them and motors of 30 ms follow, readings
at its rates and steps.
"""

from dataclasses import replace
from math import pi, remainder, sin
from random import Random

import numpy as np

from robot_runtime.contract.craft import Craft
from robot_runtime.experiments.identification.quantities import QUANTITIES
from robot_runtime.experiments.identification.streams import DEPTH_LATENCY, MEASURED_AGE, SessionStreams
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from robot_runtime.simulation.water.surroundings import Basin, StartPose

_PERIOD = 0.005
_DOWN, _UP = pi / 2, -pi / 2
_TICK = 2 * pi / 1024
_TURN, _GROWTH = 4.9, 13.3
"""rad/s by which the firmware turns fins round, and lets their amplitude grow."""
_LAG = 0.03
"""s, of a motor, and of the loop that holds its angle."""
Motion = tuple[tuple[float, float, float, float], float]
"""Directions of the four fins (rad), and their amplitude from peak to peak (rad)."""
HEAVING: tuple[Motion, ...] = (((_DOWN,) * 4, 1.6), ((_UP,) * 4, 1.6), ((_DOWN,) * 4, 0.9), ((_UP,) * 4, 0.0))
ALL_WAYS: tuple[Motion, ...] = (
    *HEAVING,
    ((0, pi, pi, 0), 1.6),
    ((pi, 0, 0, pi), 1.6),
    ((0, pi, pi, 0), 0.9),
    ((0, pi, 0, pi), 1.2),
    ((pi, 0, pi, 0), 1.2),
    ((_DOWN, _UP, _UP, _DOWN), 1.2),
    ((_UP, _DOWN, _DOWN, _UP), 1.2),
    ((_DOWN, _DOWN, _UP, _UP), 1.2),
    ((_UP, _UP, _DOWN, _DOWN), 1.2),
    ((0, 0, pi, pi), 1.4),
    ((pi, pi, 0, 0), 1.4),
)


def swim(
    craft: Craft, seed: int, seconds: float, motions: tuple[Motion, ...] = ALL_WAYS, name: str = ""
) -> SessionStreams:
    """Return the streams of a swim in deep, still water; the same seed gives the same."""
    random, noise = Random(seed), Random(f"{seed} encoders")
    simulator = Simulator(SimulationParameters.of(craft), seed)
    simulator.set_basin(Basin(30.0))
    simulator.reset(StartPose(down=6.0), seed)
    zeros = [noise.gauss(0, craft.encoder.bias) for _ in range(4)]
    directions, amplitude, until = [_DOWN] * 4, 0.0, 0.0
    angles, speeds = [_DOWN] * 4, [0.0] * 4
    motor, imu, attitudes, depth = [], [], [], []
    for step in range(1, round(seconds / _PERIOD) + 1):
        time = step * _PERIOD
        if time > until:
            down = simulator.truth().position[2]
            motion = HEAVING[0] if down < 2 else HEAVING[1] if down > 12 else random.choice(motions)
            until = time + random.uniform(1.5, 4.5)
        directions = [
            now + max(min(remainder(goal - now, 2 * pi), _TURN * _PERIOD), -_TURN * _PERIOD)
            for now, goal in zip(directions, motion[0], strict=True)
        ]
        amplitude += max(min(motion[1] - amplitude, _GROWTH * _PERIOD), -_GROWTH * _PERIOD)
        swing = amplitude / 2 * sin(2 * pi * 1.3 * time)
        speeds = [
            speed + ((direction + swing - angle) / _LAG - 2 * speed) * _PERIOD / _LAG
            for direction, angle, speed in zip(directions, angles, speeds, strict=True)
        ]
        angles = [angle + speed * _PERIOD for angle, speed in zip(angles, speeds, strict=True)]
        fins = [*angles, *speeds, 20.0, 20.0, 20.0, 20.0, 1.0]
        reading = simulator.advance(_PERIOD, FinMotion.of(fins))
        if step % 2:
            continue
        imu.append(
            (
                time + MEASURED_AGE,
                *_rounded(reading.rate, 0.00026632423),
                *_rounded(reading.force, 0.0011971008),
            )
        )
        attitudes.append(simulator.truth().attitude)
        if step % 4:
            head = reading.pressure - 101325
            depth.append(
                (
                    time + MEASURED_AGE + DEPTH_LATENCY,
                    *_rounded((head / 9810,), 0.001),
                    round(reading.pressure),
                )
            )
        else:
            seen = [
                angle + zero + noise.gauss(0, craft.encoder.noise)
                for angle, zero in zip(angles, zeros, strict=True)
            ]
            motor.append(
                (time, *_rounded([remainder(angle, 2 * pi) for angle in _rounded(seen, _TICK)], 0.001))
            )
    motors, inertial, depths = np.array(motor), np.array(imu), np.array(depth)
    return SessionStreams(
        name=name or f"swim {seed}",
        motor_times=motors[:, 0],
        angles=motors[:, 1:],
        imu_times=inertial[:, 0],
        rates=inertial[:, 1:4],
        forces=inertial[:, 4:],
        attitudes=np.array(attitudes),
        depth_times=depths[:, 0],
        depths=depths[:, 1],
        pressures=depths[:, 2],
    )


def random_craft(seed: int, most: float = 0.4) -> Craft:
    """Return a craft whose every number that can be fitted differs from the default's by up to this share."""
    random, craft = Random(f"craft {seed}"), Craft()
    for quantity in QUANTITIES:
        factor = 1 + random.uniform(-most, most)
        if quantity.name == "buoyancy":
            craft = quantity.replaced(craft, 1 + (craft.buoyancy - 1) * factor)
        elif quantity.name in ("trim_forward", "trim_right"):
            craft = quantity.replaced(craft, random.choice((-1, 1)) * random.uniform(0.0005, 0.002))
        elif quantity.name == "fin_delay":
            craft = quantity.replaced(craft, random.uniform(0.01, 0.05))
        else:
            craft = quantity.replaced(craft, quantity.value(craft) * factor)
    return replace(craft, gyroscope_offset=(0.01, -0.02, 0.015), accelerometer_offset=(0.05, -0.03, 0.1))


def _rounded(values: "list[float] | tuple[float, ...]", step: float) -> list[float]:
    return [step * round(value / step) for value in values]
