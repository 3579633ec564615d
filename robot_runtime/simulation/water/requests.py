"""Requests to the running water by name, and their service to other processes."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.simulation.water.faults import Kind, SimulatedFault
from robot_runtime.simulation.water.parameters import Vector
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water.surroundings import Basin, Current, StartPose, Trim, Waves
from robot_runtime.transport.outbox import SIMULATOR_STREAM, Outbox
from robot_runtime.transport.replay_cache import ReplayCache
from robot_runtime.transport.zenoh_transport import ZenohTransport

TRUTH_PERIOD = 0.05
"""s between two samples of the truth."""

Question = Mapping[str, Any]
Change = Callable[[Question], Question | None]


@dataclass(frozen=True, slots=True)
class Reset(StartPose):
    """A new start; `seed` is that of the sensors' noise."""

    seed: int | None = None


@dataclass(frozen=True, slots=True)
class BeaconPositions:
    """The light beacons; north, east, down in m."""

    positions: tuple[Vector, ...]


@dataclass(frozen=True, slots=True)
class SensorFaultRequest:
    """A fault of a sensor, or its end.

    `SimulatedFault` says which numbers each kind needs.
    """

    sensor: str
    kind: Kind
    share: float | None = field(
        default=None, metadata={"description": "of the readings that drop out or jump, above 0, at most 1"}
    )
    size: float | None = field(
        default=None, metadata={"description": "of a jump, in the sensor's unit, above 0"}
    )
    speed: float | None = field(
        default=None, metadata={"description": "of a drift, in the sensor's unit per second"}
    )


@dataclass(frozen=True, slots=True)
class NoArguments:
    """The arguments of a request without any."""


def changes(simulator: Simulator) -> dict[str, Change]:
    """Return the function of each request. After a ValueError nothing has changed.

    `surroundings` changes nothing; its answer holds the requests that restore the present state.
    """

    def reset(question: Question) -> None:
        start = parse(Reset, question)
        simulator.reset(start, start.seed)

    def current(question: Question) -> None:
        _require(question, "north", "east", "down")
        simulator.set_current(parse(Current, question))

    def waves(question: Question) -> None:
        _require(question, "amplitude", "period", "direction")
        simulator.set_waves(parse(Waves, question))

    def trim(question: Question) -> None:
        simulator.set_trim(parse(Trim, question))

    def world(question: Question) -> None:
        simulator.set_basin(parse(Basin, question))

    def beacons(question: Question) -> None:
        simulator.set_beacons(parse(BeaconPositions, question).positions)

    def fault(question: Question) -> None:
        named = parse(SensorFaultRequest, question)
        fault = SimulatedFault(kind=named.kind, share=named.share, size=named.size, speed=named.speed)
        simulator.set_fault(named.sensor, fault)

    def surroundings(question: Question) -> Question:
        parse(NoArguments, question)
        basin, current, waves, trim, positions, faults = simulator.surroundings()
        return {
            "world": _set_fields(basin),
            "current": _set_fields(current),
            "waves": _set_fields(waves),
            "trim": _set_fields(trim),
            "beacons": {"positions": [list(position) for position in positions]},
            "faults": [{"sensor": sensor, **_set_fields(fault)} for sensor, fault in faults.items()],
        }

    made = (reset, current, waves, trim, world, beacons, fault, surroundings)
    return {change.__name__: change for change in made}


def serve_requests(messages: ZenohTransport, requests: Mapping[str, Change], clock: Clock) -> Outbox:
    """Serve these requests; return an outbox for `truth`, of which it serves the blocks."""
    cache = ReplayCache(messages.run, clock)
    for name, change in requests.items():
        messages.serve(f"simulator/{name}", change)
    messages.serve_bytes("simulator/blocks", cache.answer)
    return Outbox(messages.publish, messages.watched, cache, SIMULATOR_STREAM)


def _require(question: Question, *names: str) -> None:
    """Raise ConfigError unless the request has these arguments, which have no defaults."""
    missing = [f"{name} is missing" for name in names if name not in question]
    if missing:
        raise ConfigError(*missing)


def _set_fields(setting: Basin | Current | Waves | Trim | SimulatedFault) -> dict[str, Any]:
    return {name: value for name, value in asdict(setting).items() if value is not None}
