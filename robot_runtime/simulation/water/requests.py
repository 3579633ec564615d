"""Requests to the running simulator, by name. Names and types are checked here, ranges at their use."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any, cast

from robot_runtime.errors import RefusedError
from robot_runtime.simulation.water.faults import Kind, SimulatedFault
from robot_runtime.simulation.water.parameters import Vector
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water.surroundings import Basin, Current, StartPose, Trim, Waves

Question = Mapping[str, Any]
Change = Callable[[Question], Question | None]


def changes(simulator: Simulator) -> dict[str, Change]:
    """Returns the handler of each request. Handlers that raise RefusedError or ValueError change nothing.

    `surroundings` changes nothing and is answered with the questions that would make everything as it is.
    """

    def reset(question: Question) -> None:
        _expect(question, (), ("north", "east", "down", "heading", "seed"))
        numbers = {name: value for name, value in question.items() if name != "seed"}
        simulator.reset(StartPose(**_numbers(numbers)), _whole(question, "seed"))

    def current(question: Question) -> None:
        _expect(question, ("north", "east", "down"), ("turning",))
        simulator.set_current(Current(**_numbers(question)))

    def waves(question: Question) -> None:
        _expect(question, ("amplitude", "period", "direction"))
        simulator.set_waves(Waves(**_numbers(question)))

    def trim(question: Question) -> None:
        _expect(question, ("buoyancy", "forward", "right", "above"))
        simulator.set_trim(Trim(**_numbers(question)))

    def world(question: Question) -> None:
        _expect(question, ("depth",), ("length", "width"))
        simulator.set_basin(Basin(**_numbers(question)))

    def beacons(question: Question) -> None:
        _expect(question, ("positions",))
        simulator.set_beacons(_positions(question["positions"]))

    def fault(question: Question) -> None:
        _expect(question, ("sensor", "kind"), ("share", "size", "speed"))
        sensor, kind = _text(question, "sensor"), _text(question, "kind")
        numbers = _numbers({name: question[name] for name in question.keys() - {"sensor", "kind"}})
        simulator.set_fault(sensor, SimulatedFault(kind=cast(Kind, kind), **numbers))

    def surroundings(question: Question) -> Question:
        _expect(question)
        basin, current, waves, trim, positions, faults = simulator.surroundings()
        return {
            "world": _given(basin),
            "current": _given(current),
            "waves": _given(waves),
            "trim": _given(trim),
            "beacons": {"positions": [list(one) for one in positions]},
            "faults": [{"sensor": sensor, **_given(fault)} for sensor, fault in faults.items()],
        }

    made = (reset, current, waves, trim, world, beacons, fault, surroundings)
    return {change.__name__: change for change in made}


def _expect(question: Question, names: Sequence[str] = (), more: Sequence[str] = ()) -> None:
    given = set(question)
    if not set(names) <= given <= {*names, *more}:
        takes = ", ".join(sorted(names)) or "nothing"
        if more:
            takes += f" and perhaps {', '.join(sorted(more))}"
        raise RefusedError(f"this command takes {takes}, not {', '.join(sorted(given)) or 'nothing'}")


def _numbers(question: Question) -> dict[str, float]:
    return {name: _number(name, value) for name, value in question.items()}


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise RefusedError(f"{name} must be a number, not {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise RefusedError(f"{name} is a number of {len(str(value))} digits; take a smaller one") from None


def _whole(question: Question, name: str) -> int | None:
    value = question.get(name)
    if value is not None and type(value) is not int:
        raise RefusedError(f"{name} must be a whole number, not {value!r}")
    return value


def _given(setting: Basin | Current | Waves | Trim | SimulatedFault) -> dict[str, Any]:
    return {name: value for name, value in asdict(setting).items() if value is not None}


def _text(question: Question, name: str) -> str:
    value = question[name]
    if not isinstance(value, str):
        raise RefusedError(f"{name} must be a text, not {value!r}")
    return value


def _positions(value: object) -> tuple[Vector, ...]:
    if not isinstance(value, list):
        raise RefusedError(f"positions must be a list of [north, east, down] in m, not {value!r}")
    return tuple(_position(position) for position in value)


def _position(value: object) -> Vector:
    if not isinstance(value, list) or len(value) != 3:
        raise RefusedError(f"a position must be [north, east, down] in m, not {value!r}")
    north, east, down = (_number("each part of a position", part) for part in value)
    return north, east, down
