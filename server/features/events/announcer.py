"""Events for other programs, made from the reports of robot and server."""

import json
import secrets
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, Protocol

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Severity
from robot_runtime.contract.published_events import PublishedEvent, PublishedKind
from robot_runtime.contract.topics import STATE
from robot_runtime.transport.blocks import Block

Alarms = dict[str, dict[str, Any]]
"""Alarms as they are listed, by their faults."""
MISSION_ENDS = ("succeeded", "failed", "ended")


class EventOutlet(Protocol):
    """A way to other programs. No method waits."""

    def publish(self, event: PublishedEvent) -> None:
        """Send an event as soon as the other end is there."""

    def retain(self, name: str, text: str) -> None:
        """Set what a program that comes later should find: JSON, by name."""


class EventAnnouncer:
    """The publisher of events, made from the pages' messages and the robot's blocks."""

    def __init__(self, robot: str, clock: Clock, outlet: EventOutlet) -> None:
        self._run = secrets.token_hex(8)
        self._robot = robot
        self._clock = clock
        self._began = clock.now()
        self._outlet = outlet
        self._number = 0
        self._alarms: dict[str, Alarms] = {}
        self._session: dict[str, Any] | None = None
        self._last: dict[str, int | str] = {}
        """The run of each kind that was announced last."""

    def see(self, block: Block) -> None:
        """Process a block of the robot."""
        try:
            documents = json.loads(block.payload)
        except (ValueError, RecursionError):
            return  # the recorder has reported it
        for document in documents:
            if block.topic is STATE:
                # After a start of the server, older states come once more.
                if document["time"] >= self._began:
                    self._see_alarms("runtime", document["alarms"])
            else:
                self._see_mission(block.run, document)

    def see_message(self, message: Mapping[str, Any]) -> None:
        """Process a message for the pages."""
        match message["op"]:
            case "alarms":
                self._see_alarms("server", message["alarms"])
            case "session":
                self._see_session(message["recording"])
            case "scenario" if (last := message["last"]) is not None and self._is_new(
                "scenario", last["run"]
            ):
                name = last["title"] or last["name"]
                self._end(
                    "scenario_ended", name, last["run"], last["state"], last["problem"], last["session"]
                )
            case "tuning" if (last := message["last"]) is not None and self._is_new("tuning", last["id"]):
                self._end("tuning_ended", last["name"], last["id"], last["state"], last["problem"])

    def see_comm_test(self, run: int, name: str, state: str, problem: str) -> None:
        """Process the end of a communication test."""
        self._end("comm_test_ended", name, run, state, problem)

    def _see_alarms(self, source: str, listed: Sequence[dict[str, Any]]) -> None:
        before, now = self._alarms.get(source), {str(alarm["fault"]): alarm for alarm in listed}
        self._alarms[source] = now
        for fault, alarm in now.items():
            known = (before or {}).get(fault)
            # At the start of the server, an alarm that is over is no news.
            if (known is None or known["since"] != alarm["since"]) and (
                before is not None or alarm["active"]
            ):
                text = f"{alarm['what']} {alarm['cause']} {alarm['remedy']}"
                self._publish("alarm_began", fault, state="active", severity=alarm["severity"], text=text)
                if not alarm["active"]:
                    self._alarm_over(alarm)
        for fault, known in (before or {}).items():
            again = now.get(fault, {})
            if (
                known["active"]
                and not again.get("active")
                and again.get("since", known["since"]) == known["since"]
            ):
                self._alarm_over(known)
        if before is None or before != now:
            active = [
                alarm for alarms in self._alarms.values() for alarm in alarms.values() if alarm["active"]
            ]
            self._retain("alarms", active)

    def _alarm_over(self, alarm: Mapping[str, Any]) -> None:
        self._publish("alarm_ended", alarm["fault"], state="over", text=f"Cleared: {alarm['what']}")

    def _see_session(self, recording: dict[str, Any] | None) -> None:
        before, self._session = self._session, recording
        number = recording and recording["id"]
        if before is not None and before["id"] != number:
            text = f"Recording of “{before['name']}” has ended."
            self._session_event("session_ended", before, "ended", text)
        if recording is not None and (before is None or before["id"] != number):
            text = f"Recording of “{recording['name']}” has begun."
            self._session_event("session_began", recording, "recording", text)
        self._retain("session", recording and {"id": number, "name": recording["name"]})

    def _session_event(self, kind: PublishedKind, session: Mapping[str, Any], state: str, text: str) -> None:
        self._publish(kind, session["name"], session["id"], state=state, text=text, session=session["id"])

    def _see_mission(self, run: str, document: Mapping[str, Any]) -> None:
        # After a start of the server, older documents come once more.
        over = document["phase"] in MISSION_ENDS and document["time"] >= self._began
        if over and self._is_new(f"mission of {run}", document["number"]):
            session = None if self._session is None else int(self._session["id"])
            name, state = document["title"] or document["name"], document["phase"]
            self._end("mission_ended", name, document["number"], state, document["text"], session)

    def _is_new(self, kind: str, number: int | str) -> bool:
        before, self._last[kind] = self._last.get(kind), number
        return before != number

    def _end(
        self,
        kind: PublishedKind,
        name: str,
        number: int | str,
        state: str,
        problem: str,
        session: int | None = None,
    ) -> None:
        severity: Severity = "caution" if state == "failed" else "info"
        text = f"“{name}”: {state}. {problem}".strip()
        self._publish(kind, name, number, state=state, severity=severity, text=text, session=session)

    def _publish(
        self,
        kind: PublishedKind,
        subject: str,
        number: int | str | None = None,
        *,
        state: str,
        severity: Severity = "info",
        text: str,
        session: int | None = None,
    ) -> None:
        self._number += 1
        event = PublishedEvent(
            robot=self._robot,
            event=kind,
            run=self._run,
            number=self._number,
            time=datetime.now(UTC).isoformat(timespec="milliseconds"),
            subject=subject,
            id=number,
            session=session,
            state=state,
            severity=severity,
            text=text,
        )
        self._outlet.publish(event)

    def _retain(self, name: str, value: object) -> None:
        self._outlet.retain(name, json.dumps(value, ensure_ascii=False))
