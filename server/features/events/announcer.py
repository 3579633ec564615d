"""Makes events for other programs of what the robot and the server report anyway."""

import asyncio
import json
import secrets
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Severity
from robot_runtime.contract.published_events import PublishedEvent, PublishedKind
from robot_runtime.transport.blocks import Block
from server.features.events.config import EventsConfig
from server.features.events.mqtt import MqttOutlet
from server.features.events.outlet import EventOutlet, OutletCondition
from server.platform.settings import Settings

Alarms = dict[str, dict[str, Any]]
"""Alarms as they are listed, by their faults."""
MISSION_ENDS = ("succeeded", "failed", "ended")
GRAVITY = ("ok", "starting", "failed")


class EventAnnouncer:
    """Sees what the pages are sent, and the robot's blocks; publishes what other programs want to know.

    Without an outlet it does nothing.
    """

    def __init__(
        self, settings: Settings, clock: Clock, outlets: Sequence[EventOutlet] | None = None
    ) -> None:
        self.run = secrets.token_hex(8)
        self._robot = settings.robot
        self._clock = clock
        self._began = clock.now()
        self._outlets = self._outlets_of(settings) if outlets is None else outlets
        self._number = 0
        self._alarms: dict[str, Alarms] = {}
        self._session: dict[str, Any] | None = None
        self._last: dict[str, int | str] = {}
        """The run of each kind that was announced last."""

    def open(self) -> None:
        """Connect from now on."""
        for outlet in self._outlets:
            outlet.open()

    async def close(self) -> None:
        """Send what waits, for a short time, and end."""
        await asyncio.gather(*(asyncio.to_thread(outlet.close) for outlet in self._outlets))

    def condition(self) -> OutletCondition | None:
        """The gravest state, and a sentence about each outlet; None without one."""
        found = [outlet.condition() for outlet in self._outlets]
        if not found:
            return None
        state = max((one.state for one in found), key=GRAVITY.index)
        return OutletCondition(state, " ".join(one.text for one in found))

    def see(self, block: Block) -> None:
        """Take in a block of the robot."""
        name = block.topic.name
        if not self._outlets or name not in ("state", "mission"):
            return
        try:
            documents = json.loads(block.payload)
        except (ValueError, RecursionError):
            return  # the recorder has reported it
        for document in documents:
            if name == "state":
                # After a start of the server, older states come once more.
                if document["time"] >= self._began:
                    self._see_alarms("runtime", document["alarms"])
            else:
                self._see_mission(block.run, document)

    def see_message(self, message: Mapping[str, Any]) -> None:
        """Take in a message that the pages are sent."""
        if not self._outlets:
            return
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
        """Take in the end of a communication test."""
        if self._outlets:
            self._end("comm_test_ended", name, run, state, problem)

    def _see_alarms(self, source: str, listed: Sequence[dict[str, Any]]) -> None:
        before, now = self._alarms.get(source), {str(one["fault"]): one for one in listed}
        self._alarms[source] = now
        for fault, one in now.items():
            known = (before or {}).get(fault)
            # At the start of the server, an alarm that is over is no news.
            if (known is None or known["since"] != one["since"]) and (before is not None or one["active"]):
                text = f"{one['what']} {one['cause']} {one['remedy']}"
                self._publish("alarm_began", fault, state="active", severity=one["severity"], text=text)
                if not one["active"]:
                    self._alarm_over(one)
        for fault, known in (before or {}).items():
            again = now.get(fault, {})
            if (
                known["active"]
                and not again.get("active")
                and again.get("since", known["since"]) == known["since"]
            ):
                self._alarm_over(known)
        if before is None or before != now:
            active = [one for alarms in self._alarms.values() for one in alarms.values() if one["active"]]
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
            run=self.run,
            number=self._number,
            time=datetime.now(UTC).isoformat(timespec="milliseconds"),
            subject=subject,
            id=number,
            session=session,
            state=state,
            severity=severity,
            text=text,
        )
        for outlet in self._outlets:
            outlet.publish(event)

    def _retain(self, name: str, value: object) -> None:
        text = json.dumps(value, ensure_ascii=False)
        for outlet in self._outlets:
            outlet.retain(name, text)

    def _outlets_of(self, settings: Settings) -> list[EventOutlet]:
        events, folder = settings.section(EventsConfig), settings.config.parent
        outlets: list[EventOutlet] = []
        if events.mqtt:
            outlets.append(MqttOutlet(settings.robot, self.run, events, folder))
        return outlets
