"""The end of an armed robot that nobody watches, in simulated time."""

from collections.abc import Iterator
from typing import Any

import pytest

from robot_runtime.commands import Commands
from robot_runtime.config import ControlConfig
from robot_runtime.contract.commands import MissionCommand
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.topics import STATE
from tests.runtime.control.flight import Flight
from tests.runtime.missions.water import mission

LIMIT, LONG = 6.0, 9.0


@pytest.fixture
def flight() -> Iterator[Flight]:
    with Flight(more=f"unwatched = {LIMIT}") as flight:
        flight.supervisor._heartbeat = 4.0
        yield flight


def armed_texts(flight: Flight) -> list[str]:
    return [event.text for event in flight.events if event.kind == "armed"]


def test_an_armed_robot_that_nobody_watches_is_stopped(flight: Flight) -> None:
    flight.arm()
    flight.run(LONG)
    assert flight.supervisor.mode == "automatic"
    flight.watched = False
    took = flight.until(lambda: not flight.supervisor.armed, LIMIT)
    assert took > LIMIT - 0.5
    assert flight.supervisor.mode == "failsafe"
    assert armed_texts(flight) == ["Armed."]


def test_who_comes_back_in_time_has_the_limit_anew(flight: Flight) -> None:
    flight.arm()
    for _ in range(3):
        flight.watched = False
        flight.run(LIMIT - 2.0)
        flight.watched = True
        flight.run(1.0)
    assert flight.supervisor.mode == "automatic"


def test_a_page_that_comes_back_finds_the_alarm_and_the_record(flight: Flight) -> None:
    states: list[Any] = []
    flight.robot.bus.on_document(STATE, states.append)
    flight.arm()
    flight.watched = False
    flight.run(LONG)
    flight.watched = True
    flight.run(2.0)
    assert states[-1].mode == "failsafe"
    assert [(alarm.fault, alarm.active) for alarm in states[-1].alarms] == [("unwatched", False)]
    assert [event.kind for event in flight.events if event.severity == "alarm"] == ["unwatched", "disarmed"]
    flight.supervisor.acknowledge()
    assert flight.supervisor.refusals() == []


@pytest.mark.parametrize(
    ("unwatched", "text"),
    [
        (0.0, "Armed. It goes on while nobody watches."),
        (600.0, "Armed. It goes on for 600 s while nobody watches."),
    ],
)
def test_a_longer_limit_or_none_is_said_at_the_arming_shown_and_recorded(
    flight: Flight, unwatched: float, text: str
) -> None:
    flight.arm(unwatched=unwatched)
    flight.watched = False
    flight.run(LONG)
    assert flight.supervisor.mode == "automatic"
    assert armed_texts(flight) == [text]
    assert flight.robot.state().unwatched == unwatched
    flight.supervisor.stop("The next one.")
    # It counts for one arming.
    assert flight.robot.state().unwatched == LIMIT
    flight.arm()
    flight.until(lambda: not flight.supervisor.armed, LIMIT)


def test_the_time_counts_from_the_arming(flight: Flight) -> None:
    flight.watched = False
    flight.run(LIMIT)
    flight.arm()
    flight.run(LIMIT - 2.0)
    assert flight.supervisor.armed


def test_who_may_do_without_the_server_may_do_without_a_page(flight: Flight) -> None:
    flight.arm(alone=12.0)
    flight.server = False
    flight.run(11.0)
    assert flight.supervisor.armed
    flight.until(lambda: not flight.supervisor.armed, 2.0)


def test_a_mission_obeys_its_own_limit_alone(flight: Flight) -> None:
    text = mission("{ do = 'hold', seconds = 60, within = 5 }", limits="time = 100")
    arming = Commands(flight.robot).begin_mission(MissionCommand(text=text))
    flight.watched = False
    while not arming.over:
        flight.run(0.1)
        flight.supervisor.continue_arming()
    flight.run(LONG)
    assert flight.supervisor.mode == "automatic"
    assert flight.robot.state().unwatched == 0.0


def test_none_cannot_be_configured() -> None:
    with pytest.raises(ConfigError, match="unwatched is 0; it must lie between 5 and 300"):
        parse(ControlConfig, {"unwatched": 0})
