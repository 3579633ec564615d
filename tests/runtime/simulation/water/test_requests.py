"""Requests to the running water: their effects and refusals."""

from collections.abc import Callable
from math import isnan, pi

import pytest

from robot_runtime.simulation.water.faults import DEVICES, LEAK, SENSORS
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.requests import Question, changes
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from tests.runtime.simulation.water.harness import QUIET, STILL

PERIOD = 0.005
SET: dict[str, Question] = {
    "current": {"north": 0.3, "east": 0, "down": 0, "turning": 0.5},
    "waves": {"amplitude": 0.05, "period": 2, "direction": 0},
}
Ask = Callable[..., None]


@pytest.fixture
def simulator() -> Simulator:
    return Simulator(QUIET, seed=1)


@pytest.fixture
def ask(simulator: Simulator) -> Ask:
    known = changes(simulator)

    def put(question: str, /, **payload: object) -> None:
        known[question](payload)

    return put


def rest(simulator: Simulator, seconds: float = PERIOD) -> list[Reading]:
    still = FinMotion(STILL, STILL, STILL, powered=False)
    return [simulator.advance(PERIOD, still) for _ in range(round(seconds / PERIOD))]


def test_waves_reach_the_pressure_sensor(simulator: Simulator, ask: Ask) -> None:
    ask("trim", buoyancy=0.95, forward=0, right=0, above=0.01)
    rest(simulator, 30)
    ask("waves", amplitude=0.1, period=3, direction=1)
    pressures = [reading.pressure for reading in rest(simulator, 6)]
    assert max(pressures) - min(pressures) > 300
    ask("waves", amplitude=0, period=3, direction=1)
    rest(simulator, 30)
    pressures = [reading.pressure for reading in rest(simulator, 6)]
    assert max(pressures) - min(pressures) < 1


def test_a_current_that_turns(simulator: Simulator, ask: Ask) -> None:
    ask("current", north=0.2, east=0, down=0, turning=0.05)
    rest(simulator, 10 * pi)
    assert simulator.truth().position[0] > 2
    early = simulator.truth().position
    rest(simulator, 10)
    late = simulator.truth().position
    assert late[1] - early[1] > 1
    assert abs(late[0] - early[0]) < 1


def test_trim_lets_it_sink(simulator: Simulator, ask: Ask) -> None:
    ask("trim", buoyancy=0.98, forward=0, right=0, above=0.01)
    rest(simulator, 60)
    assert simulator.truth().position[2] == pytest.approx(2.95, abs=1e-6)


def test_a_pool_has_walls_and_begins_at_the_start(simulator: Simulator, ask: Ask) -> None:
    ask("current", north=0.5, east=0, down=0)
    rest(simulator, 20)
    assert simulator.truth().position[0] > 5
    ask("world", depth=2, length=6, width=3)
    assert simulator.truth().position[0] == 0
    rest(simulator, 60)
    assert simulator.truth().position[0] == pytest.approx(3 - 0.12, abs=0.1)
    ask("world", depth=2)
    rest(simulator, 20)
    assert simulator.truth().position[0] > 5


def test_beacons_are_placed_moved_and_removed(simulator: Simulator, ask: Ask) -> None:
    def seen() -> tuple[bool, bool]:
        reading = rest(simulator)[-1]
        return reading.beacon_right, reading.beacon_left

    assert seen() == (True, True)
    ask("beacons", positions=[[1, 2, 0]])
    assert seen() == (True, False)
    ask("beacons", positions=[[1, 2, 0], [1, -2, 0]])
    assert seen() == (True, True)
    ask("beacons", positions=[[-3, 0, 0]])
    assert seen() == (False, False)
    ask("beacons", positions=[])
    assert seen() == (False, False)


@pytest.mark.parametrize("sensor", [sensor for sensor in SENSORS if sensor != LEAK])
@pytest.mark.parametrize(
    "numbers",
    [
        {"kind": "stuck"},
        {"kind": "dropout", "share": 0.5},
        {"kind": "spike", "share": 0.5, "size": 1e300},
        {"kind": "drift", "speed": -1e6},
    ],
    ids=["stuck", "dropout", "spike", "drift"],
)
def test_every_sensor_can_have_every_fault_and_only_that_one_changes(
    sensor: str, numbers: dict[str, object]
) -> None:
    """The readings of all other sensors stay the same to the last digit."""
    sound, broken = readings(None), readings({"sensor": sensor, **numbers})
    differing = {
        name for early, late in zip(sound, broken, strict=True) for name in early if early[name] != late[name]
    }
    assert differing == {sensor}
    assert all(reading["pressure"] >= 0 and reading["battery"] >= 0 for reading in broken)  # type: ignore[operator]


def readings(fault: Question | None) -> list[dict[str, object]]:
    """Readings of the default robot with a fault after half a second; beacons appear and disappear."""
    simulator = Simulator(SimulationParameters(), seed=3)
    known = changes(simulator)
    rest(simulator, 0.5)
    if fault is not None:
        known["fault"](fault)
    shown = []
    for turn in range(8):
        known["beacons"]({"positions": [[2 if turn % 2 else -2, 0, 0]]})
        shown += rest(simulator, 0.25)
    return [split(reading) for reading in shown]


def split(reading: Reading) -> dict[str, object]:
    """Readings by the sensors' names; NaN as text, so that it equals itself."""
    encoders = {
        f"encoder{fin}": "holds" if isnan(error) else error for fin, error in enumerate(reading.encoders)
    }
    return {
        "pressure": reading.pressure,
        "gyroscope": reading.rate,
        "accelerometer": reading.force,
        "beacon_right": reading.beacon_right,
        "beacon_left": reading.beacon_left,
        "battery": reading.battery,
        **encoders,
    }


def test_a_stuck_encoder_holds(simulator: Simulator, ask: Ask) -> None:
    ask("fault", sensor="encoder2", kind="stuck")
    first, second, third, fourth = rest(simulator)[-1].encoders
    assert (first, second, fourth) == (0, 0, 0)
    assert isnan(third)
    ask("fault", sensor="encoder2", kind="drift", speed=0.5)
    assert rest(simulator, 1)[-1].encoders[2] == pytest.approx(0.5)
    ask("fault", sensor="encoder2", kind="none")
    assert rest(simulator)[-1].encoders == (0, 0, 0, 0)


def test_bus_errors_name_the_boards_devices(simulator: Simulator, ask: Ask) -> None:
    for sensor in DEVICES:
        ask("fault", sensor=sensor, kind="bus")
    assert simulator.device_faults == dict.fromkeys(DEVICES.values(), "absent")
    ask("fault", sensor="gyroscope", kind="none")
    assert "imu" in simulator.device_faults
    ask("fault", sensor="accelerometer", kind="stuck")
    assert "imu" not in simulator.device_faults


def test_a_leak_is_wet_until_it_is_mended(simulator: Simulator, ask: Ask) -> None:
    ask("fault", sensor="leak", kind="wet")
    ask("reset")
    assert simulator.device_faults == {"leak": "wet"}
    ask("fault", sensor="leak", kind="none")
    assert simulator.device_faults == {}
    for sensor, kind in (("leak", "stuck"), ("leak", "bus"), ("pressure", "wet")):
        with pytest.raises(ValueError, match="the leak sensor has the fault wet, and no other"):
            ask("fault", sensor=sensor, kind=kind)


def test_a_reset_repeats_the_same_bytes() -> None:
    simulator = Simulator(SimulationParameters(), seed=9)
    known = changes(simulator)
    rest(simulator, 1)
    known["current"](SET["current"])
    known["waves"](SET["waves"])
    known["fault"]({"sensor": "pressure", "kind": "spike", "share": 0.2, "size": 5000})
    rest(simulator, 1)
    known["reset"]({})
    first = rest(simulator, 5)
    assert max(reading.pressure for reading in first) > 105000
    east = simulator.truth().position[1]
    known["reset"]({})
    assert rest(simulator, 5) == first
    fresh = Simulator(SimulationParameters(), seed=9)
    for name in ("waves", "current"):
        changes(fresh)[name](SET[name])
    rest(fresh, 5)
    assert fresh.truth().position[1] == pytest.approx(east, abs=1e-12)
    other = Simulator(SimulationParameters(), seed=10)
    assert rest(other, 5) != first


@pytest.mark.parametrize(
    ("name", "question", "message"),
    [
        ("reset", {"depth": 1}, "'depth' is not known here; known are north, east, down, heading, seed"),
        ("waves", {"amplitude": 0.1, "period": 2}, "direction is missing"),
        (
            "waves",
            {"amplitude": "high", "period": 2, "direction": 0},
            "is 'high'; it must be a number",
        ),
        ("waves", {"amplitude": True, "period": 2, "direction": 0}, "amplitude is True; it must be a number"),
        ("waves", {"amplitude": 0.1, "period": 0.1, "direction": 0}, "between 0.8 and 30"),
        ("waves", {"amplitude": -0.1, "period": 2, "direction": 0}, "between 0 and 10"),
        ("waves", {"amplitude": 0.1, "period": 2, "direction": float("nan")}, "direction is nan"),
        ("waves", {"amplitude": 1, "period": 2, "direction": 0}, "break in water"),
        (
            "waves",
            {"amplitude": 10**400, "period": 2, "direction": 0},
            r"amplitude is 10+\.\.\.0+; it must be a number",
        ),
        (
            "current",
            {"north": 0, "east": 0, "down": 0, "turning": 2},
            "turning is 2 rad/s; it must be between -1 and 1",
        ),
        ("trim", {"buoyancy": 2, "forward": 0, "right": 0, "above": 0}, "between 0.9 and 1.1"),
        ("trim", {"buoyancy": 1}, "forward is missing; right is missing; above is missing"),
        ("world", {}, "depth is missing"),
        ("world", {"depth": 0.1}, "between 0.5 and 1000"),
        ("world", {"depth": 2, "length": 5}, "both length and width"),
        ("world", {"depth": 2, "length": 5, "width": 0.5}, "between 1 and 1000"),
        ("beacons", {"positions": [1, 2, 3]}, r"positions\[0\] is 1; it must be a list"),
        ("beacons", {"positions": [[1, 2]]}, r"positions\[0\] is \[1, 2\]; it must be a list of 3 numbers"),
        ("beacons", {"positions": [[1, 2, "3"]]}, r"positions\[0\]\[2\] is '3'; it must be a number"),
        ("beacons", {"positions": {"north": 1}}, "must be a list"),
        ("beacons", {"positions": [[0, 0, 0]] * 9}, "at most 8"),
        ("beacons", {"positions": [[0, 0, 2000]]}, "between -1000 and 1000"),
        ("fault", {"sensor": "sonar", "kind": "stuck"}, "there is no sensor 'sonar'; there are pressure"),
        (
            "fault",
            {"sensor": "pressure", "kind": "tired"},
            "kind is 'tired'; it must be one of 'none'",
        ),
        ("fault", {"sensor": "battery", "kind": "bus"}, "on no bus"),
        ("fault", {"sensor": "pressure", "kind": "spike", "share": 0.1}, "spike takes share and size"),
        ("fault", {"sensor": "pressure", "kind": "stuck", "size": 1}, "stuck takes no numbers"),
        ("fault", {"sensor": ["pressure"], "kind": "stuck"}, "it must be a text"),
        ("fault", {"sensor": "pressure"}, "kind is missing"),
    ],
)
def test_invalid_requests_are_refused_with_the_reason_and_change_nothing(
    simulator: Simulator, name: str, question: Question, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        changes(simulator)[name](question)
    assert rest(simulator, 1) == rest(Simulator(QUIET, seed=1), 1)


def test_a_reset_elsewhere(simulator: Simulator, ask: Ask) -> None:
    ask("reset", north=1, east=-2, down=0.7, heading=pi / 2)
    truth = simulator.truth()
    assert truth.position == pytest.approx((1, -2, 0.7))
    assert truth.attitude == pytest.approx((0.5**0.5, 0, 0, 0.5**0.5))


@pytest.mark.parametrize(
    ("start", "message"), [({"down": 2.98}, "in the floor"), ({"north": 1.9}, "1.9 m north is in a wall")]
)
def test_a_reset_into_floor_or_wall_is_refused(ask: Ask, start: dict[str, float], message: str) -> None:
    ask("world", depth=3, length=4, width=4)
    with pytest.raises(ValueError, match=message):
        ask("reset", **start)


def test_a_reset_may_choose_the_noise(ask: Ask) -> None:
    noisy = Simulator(SimulationParameters(), seed=1)
    first = rest(noisy, 1)
    changes(noisy)["reset"]({"seed": 2})
    assert rest(noisy, 1) != first
    changes(noisy)["reset"]({"seed": 1})
    assert rest(noisy, 1) == first
    with pytest.raises(ValueError, match=r"seed is 1\.5; it must be a whole number"):
        ask("reset", seed=1.5)


def test_the_surroundings_are_reported_as_the_requests_that_create_them(simulator: Simulator) -> None:
    known = changes(simulator)
    request: dict[str, Question] = {
        **SET,
        "world": {"depth": 2.0, "length": 5.0, "width": 4.0},
        "trim": {"buoyancy": 1.01, "forward": 0.0, "right": 0.001, "above": 0.02},
        "beacons": {"positions": [[1.0, 2.0, 0.5]]},
    }
    for name, question in request.items():
        known[name](question)
    fault = {"sensor": "battery", "kind": "drift", "speed": 0.1}
    known["fault"](fault)
    report = known["surroundings"]({}) or {}
    assert {name: report[name] for name in request} == request
    assert fault in report["faults"]
    assert len(report["faults"]) == len(SENSORS)
