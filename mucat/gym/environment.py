"""An environment of Gymnasium: an agent pilots the robot, with its own firmware, through a scenario.

Nothing in it depends on the computer's clock: the same seed and actions give the same observations.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from gymnasium import Env
from gymnasium.spaces import Box
from numpy.typing import NDArray

from robot_runtime.contract.packets import Depth, Imu, Motor
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import DURATION, SEED, Scenario, read_scenario
from robot_runtime.experiments.scenario.episode import START, STEP, Episode, EpisodeState
from robot_runtime.experiments.scenario.library import shipped_scenarios

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""The numbers of an action: shares of the greatest force and torque; forward, to the right, down."""
ERROR_MAX = 1.0
"""m from the set point at which, and beyond which, a step is worth nothing."""


class ObservedNumber(NamedTuple):
    """A number of an observation: its name, its unit, and the greatest size that the board can report."""

    name: str
    unit: str
    limit: float


def _observed() -> Iterator[ObservedNumber]:
    imu, depth = Imu.wires, Depth.wires["depth"]
    wires = {"depth": depth, "set_point": depth, "attitude": imu["attitude"], "rate": imu["rate"]}
    for name, wire in (wires | {"force": imu["force"], "fins": Motor.wires["angle"]}).items():
        bits = 8 * wire.size // wire.count
        for index in range(wire.count):
            number = f"{name}_{index}" if wire.count > 1 else name
            yield ObservedNumber(number, wire.unit, wire.scale * 2 ** (bits - 1))


OBSERVED = tuple(_observed())
"""The numbers of an observation, in their order."""

Numbers = NDArray[np.float32]


class ScenarioEnvironment(Env[Numbers, Numbers]):
    """The robot as its pilot's task: to be at the scenario's depth; a step is 0.1 s.

    `scenario` is the name of a shipped one, or a TOML text; `duration` (s) shortens or lengthens it.
    An action has the numbers of `AXES`, an observation those of `OBSERVED`, as the board reports them. The
    reward of a step is 1 at the set point, less with the distance of the true depth from it, and 0 from
    `ERROR_MAX` on. An episode is terminated where the robot stops itself for a fault, and truncated at the
    scenario's end. Raises ValueError for a scenario that cannot be read.
    """

    def __init__(self, scenario: str, duration: float | None = None) -> None:
        self.metadata = {"render_modes": [], "render_fps": round(1 / STEP)}
        self._scenario = _read(scenario, duration)
        limits = np.array([number.limit for number in OBSERVED], np.float32)
        self.observation_space = Box(-limits, limits)
        self.action_space = Box(-1.0, 1.0, (len(AXES),))
        self._episode: Episode | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Begin another run with a seed of its own; return the observation once the robot is armed.

        Raise BoardError where there is no board, EpisodeError where the robot does not arm.
        """
        super().reset(seed=seed, options=options)
        self.close()
        own = int(self.np_random.integers(int(SEED.maximum), endpoint=True))
        self._episode = Episode(replace(self._scenario, seed=own), boards()["host"])
        state = self._episode.state()
        return _observe(state), _describe(state)

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Hold the sticks for 0.1 s. Raise ValueError for an action out of its space."""
        if self._episode is None:
            raise RuntimeError("There is no episode: call reset first.")
        axes = np.asarray(action, np.float64)
        if axes.shape != (len(AXES),) or not (abs(axes) <= 1).all():
            raise ValueError(f"The action is {action!r}; it has {len(AXES)} numbers from -1 to 1.")
        state = self._episode.step(axes.tolist())
        stopped, described = self._episode.stopped, _describe(state)
        if stopped:
            described["stopped"] = stopped
        reward = max(1.0 - abs(described["depth_error"]) / ERROR_MAX, 0.0)
        return _observe(state), reward, bool(stopped), self._episode.complete, described

    def close(self) -> None:
        """End the run."""
        if self._episode is not None:
            self._episode.close()
            self._episode = None


def _read(scenario: str, duration: float | None) -> Scenario:
    text = scenario
    if "\n" not in scenario:
        shipped = shipped_scenarios()
        if scenario not in shipped:
            names = ", ".join(shipped)
            raise ValueError(f"No scenario {scenario!r} comes with µ-CAT; pass one of {names}, or TOML.")
        text = shipped[scenario]
    read = read_scenario(text)
    if duration is None:
        return read
    if not START + STEP <= duration <= DURATION.maximum:
        raise ValueError(f"The duration is {duration:g} s; it lies between {START + STEP:g} and 3600 s.")
    events = tuple(event for event in read.events if event.at <= duration)
    return replace(read, duration=duration, events=events)


def _observe(state: EpisodeState) -> Numbers:
    numbers = (state.depth, state.set_point, *state.attitude, *state.rate, *state.force, *state.fins)
    return np.array(numbers, np.float32)


def _describe(state: EpisodeState) -> dict[str, Any]:
    """Return the time (s), the depth's true error (m), and position (m) and velocity (m/s) of the body."""
    truth = state.truth
    return {
        "time": state.time,
        "depth_error": state.set_point - truth.position[2],
        "position": truth.position,
        "velocity": truth.velocity,
    }
