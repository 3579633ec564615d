"""Events are made of what the robot and the server report."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.published_events import PublishedEvent
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from server.features.events.announcer import EventAnnouncer

SCHEMA = json.loads(
    (Path(__file__).parents[4] / "robot_runtime/contract/published_events.schema.json").read_text()
)


class Notebook:
    """An outlet that keeps everything."""

    def __init__(self) -> None:
        self.events: list[PublishedEvent] = []
        self.retained: dict[str, Any] = {}

    def publish(self, event: PublishedEvent) -> None:
        jsonschema_rs.validate(SCHEMA, asdict(event))
        self.events.append(event)

    def retain(self, name: str, text: str) -> None:
        self.retained[name] = json.loads(text)

    def take(self) -> list[tuple[str, str, str]]:
        """Kind, subject and state of the events since the last call."""
        results: list[tuple[str, str, str]] = [
            (event.event, event.subject, event.state) for event in self.events
        ]
        self.events.clear()
        return results


@pytest.fixture
def outlet() -> Notebook:
    return Notebook()


@pytest.fixture
def announcer(outlet: Notebook) -> EventAnnouncer:
    return EventAnnouncer("tested", SimulatedClock(100.0), outlet)


def alarm(fault: str, since: float, *, active: bool = True, severity: str = "alarm") -> dict[str, Any]:
    text = {"what": "The battery is low.", "cause": "It is old.", "remedy": "Charge it."}
    known = {"fault": fault, "since": since, "active": active, "severity": severity, "acknowledged": False}
    return known | text


def block(topic: str, time: float = 100.0, **document: Any) -> Block:
    return Block.of(BY_NAME[topic], 1, 0, json.dumps([{"time": time, **document}]).encode())


def test_an_alarm_begins_once_and_ends_once(announcer: EventAnnouncer, outlet: Notebook) -> None:
    announcer.see(block("state", alarms=[]))
    for active in (True, True, False, False):
        announcer.see(block("state", alarms=[alarm("battery_low", 3.0, active=active)]))
    announcer.see(block("state", alarms=[]))
    assert outlet.take() == [
        ("alarm_began", "battery_low", "active"),
        ("alarm_ended", "battery_low", "over"),
    ]
    assert outlet.retained["alarms"] == []


def test_an_alarm_that_was_over_before_anybody_saw_it_is_still_told(
    announcer: EventAnnouncer, outlet: Notebook
) -> None:
    announcer.see(block("state", alarms=[alarm("leak", 1.0)]))
    assert outlet.take() == [("alarm_began", "leak", "active")]
    announcer.see(block("state", alarms=[alarm("leak", 9.0), alarm("board_reset", 8.0, active=False)]))
    assert outlet.take() == [
        ("alarm_began", "leak", "active"),
        ("alarm_began", "board_reset", "active"),
        ("alarm_ended", "board_reset", "over"),
    ]
    announcer.see_message({"op": "alarms", "alarms": [alarm("disk_low", 2.0, severity="caution")]})
    assert [alarm["fault"] for alarm in outlet.retained["alarms"]] == ["leak", "disk_low"]
    assert outlet.events[0].severity == "caution"
    assert outlet.events[0].text == "The battery is low. It is old. Charge it."


def test_an_old_alarm_is_no_news_at_the_start(announcer: EventAnnouncer, outlet: Notebook) -> None:
    announcer.see(block("state", alarms=[alarm("leak", 1.0, active=False), alarm("low", 2.0)]))
    assert outlet.take() == [("alarm_began", "low", "active")]


def test_alarms_of_the_backlog_are_no_news(announcer: EventAnnouncer, outlet: Notebook) -> None:
    over, still = alarm("leak", 91.0, active=False), alarm("low", 92.0)
    announcer.see(block("state", 90.0, alarms=[]))
    announcer.see(block("state", 95.0, alarms=[alarm("leak", 91.0), still]))
    announcer.see(block("state", 99.0, alarms=[over, still]))
    assert outlet.take() == []
    announcer.see(block("state", 100.5, alarms=[over, still]))
    assert outlet.take() == [("alarm_began", "low", "active")]


def test_sessions_begin_and_end(announcer: EventAnnouncer, outlet: Notebook) -> None:
    first, second = {"id": 4, "name": "Dive"}, {"id": 5, "name": "Next"}
    for recording in (None, first, {**first, "name": "Renamed"}, second, None):
        announcer.see_message({"op": "session", "recording": recording})
    assert [(event.event, event.subject, event.session) for event in outlet.events] == [
        ("session_began", "Dive", 4),
        ("session_ended", "Renamed", 4),
        ("session_began", "Next", 5),
        ("session_ended", "Next", 5),
    ]
    assert [event.number for event in outlet.events] == [1, 2, 3, 4]
    assert outlet.retained["session"] is None


def test_each_run_ends_once(announcer: EventAnnouncer, outlet: Notebook) -> None:
    scenario = {
        "run": "a",
        "name": "swim",
        "title": "Swim",
        "session": 9,
        "state": "failed",
        "problem": "Why.",
    }
    tuning = {"id": 3, "name": "PID", "state": "complete", "problem": ""}
    for last in (None, scenario, scenario, {**scenario, "run": "b", "state": "complete", "problem": ""}):
        announcer.see_message({"op": "scenario", "active": None, "queued": [], "last": last})
    for last in (None, tuning, tuning):
        announcer.see_message({"op": "tuning", "active": None, "last": last})
    announcer.see_comm_test(8, "Grid", "cancelled", "")
    failed = outlet.events[0]
    assert (failed.severity, failed.session, failed.text) == ("caution", 9, "“Swim”: failed. Why.")
    assert outlet.take() == [
        ("scenario_ended", "Swim", "failed"),
        ("scenario_ended", "Swim", "complete"),
        ("tuning_ended", "PID", "complete"),
        ("comm_test_ended", "Grid", "cancelled"),
    ]


def test_a_mission_ends_once_and_an_old_one_is_no_news(announcer: EventAnnouncer, outlet: Notebook) -> None:
    mission = {"number": 1, "name": "survey", "title": "Survey", "text": "Done."}
    announcer.see(block("mission", time=50.0, phase="failed", **mission))
    announcer.see_message({"op": "session", "recording": {"id": 4, "name": "Dive"}})
    outlet.take()
    for phase in ("running", "succeeded", "succeeded"):
        announcer.see(block("mission", time=101.0, phase=phase, **mission))
    assert [(event.event, event.state, event.id, event.session) for event in outlet.events] == [
        ("mission_ended", "succeeded", 1, 4)
    ]
