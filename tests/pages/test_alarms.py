"""Alarms that forbid arming are acknowledged on each page that says so."""

import json
from dataclasses import asdict

import pytest
from playwright.sync_api import Page, WebSocketRoute, expect

from robot_runtime.contract.documents import Alarm
from robot_runtime.contract.topics import BY_ID
from robot_runtime.transport.blocks import HEADER, Block
from tests.pages.dive_site import DiveSite
from tests.pages.flying import Flown

REASON = "Acknowledge the alarms before the robot is armed again."
ALARM = Alarm(
    fault="capsized",
    severity="alarm",
    since=1.0,
    until=2.0,
    active=False,
    acknowledged=False,
    what="The robot is upside down.",
    cause="A wave turned it.",
    remedy="Turn it.",
    consequences=[],
)


def with_an_alarm(message: bytes) -> bytes:
    """Return the blocks of a message; every state has an alarm that forbids arming."""
    changed = b""
    while message:
        topic, _, count, first, size = HEADER.unpack_from(message)
        payload, message = message[HEADER.size : HEADER.size + size], message[HEADER.size + size :]
        if BY_ID[topic].name == "state":
            alarmed = {"mode": "failsafe", "refusals": [REASON], "alarms": [asdict(ALARM)]}
            payload = json.dumps([document | alarmed for document in json.loads(payload)]).encode()
        changed += Block.of(BY_ID[topic], count, first, payload).data
    return changed


@pytest.mark.parametrize("address", ["missions/edit/two_depths", "tune/bench", "system"])
def test_alarms_are_acknowledged_where_they_forbid_arming(
    unopened: Page, site: DiveSite, address: str
) -> None:
    def hand_on(socket: WebSocketRoute) -> None:
        def change(message: str | bytes) -> None:
            socket.send(with_an_alarm(message) if isinstance(message, bytes) else message)

        socket.connect_to_server().on_message(change)

    unopened.route_web_socket("**/api/live", hand_on)
    unopened.goto(f"{site.url}/#/{address}")
    with unopened.expect_response("**/api/robot/commands/acknowledge") as answer:
        unopened.get_by_role("main").get_by_role("button", name="Acknowledge", exact=True).click()
    assert answer.value.ok
    expect(unopened.get_by_role("main").get_by_text(REASON)).to_be_visible()


def test_the_fin_check_of_an_armed_robot_says_why_it_does_not_begin(unopened: Page, site: DiveSite) -> None:
    flown = Flown(unopened)
    flown.mode, flown.alarms = "automatic", [{}]
    unopened.goto(f"{site.url}/#/system")
    check = unopened.get_by_role("region", name="Fin check")
    expect(check.get_by_text("The robot is armed already.")).to_be_visible()
    expect(check.get_by_role("button", name="Hold to check the fins")).to_be_disabled()
    # Nothing of it waits for an acknowledgement.
    expect(check.get_by_role("button", name="Acknowledge")).to_have_count(0)
