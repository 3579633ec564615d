"""Control over HTTP and the live socket: permissions, notifications, commands to the runtime."""

import json

from robot_runtime.clock import SimulatedClock
from server.driving.arbiter import ControlArbiter
from server.library.content import Recording
from server.platform.store import Store
from tests.server.blocks import state_block
from tests.server.driving.pages import free, open_page
from tests.server.serving import Served, next_text
from tests.server.waiting import until

SCENARIO = """
name = "short"
title = "A short one"
duration = 3
seed = 7
"""


async def test_changes_of_control_are_recorded_in_the_session(served: Served) -> None:
    session = (await served.api.post("/sessions", json={"name": "x", "note": ""})).json()["id"]
    async with open_page(served) as anna:
        (await anna.ask("/control/take?over=true")).raise_for_status()
    (await served.api.post("/control/take")).raise_for_status()
    (await served.api.post(f"/sessions/{session}/stop")).raise_for_status()
    container = served.container
    recording = Recording.open(container.services.get(Store), session)
    # The doctor's words come when its look at the start is done.
    texts = [document["text"] for document in recording.documents("notice") if document["kind"] == "control"]
    shell = "“the shell of this computer”"
    assert texts[-3:] == [
        f"{shell} took over control from {shell}.",
        f"{shell} left, and nobody has control now.",
        f"{shell} took control.",
    ]


async def test_control_passes_between_pages_and_all_clients_and_the_runtime_are_notified(
    served: Served,
) -> None:
    await free(served)
    async with open_page(served) as anna, open_page(served) as ben:
        assert anna.client != ben.client
        await anna.control_message(None)
        assert (await anna.ask("/control/take")).json()["holder"]["client"] == anna.client
        first = (await ben.control_message(anna.client))["epoch"]
        refused = await ben.ask("/control/take")
        assert (refused.status_code, "take it over" in refused.json()["detail"]) == (409, True)
        taken = (await ben.ask("/control/take?over=true")).json()
        assert (await anna.control_message(ben.client))["epoch"] == taken["epoch"] > first
        assert (await served.api.get("/control")).json()["holder"]["client"] == ben.client
        await until(lambda: served.runtime.epochs[-1:] == [taken["epoch"]], "the runtime to be told")
        assert (await anna.ask("/robot/commands/arm")).status_code == 423
        # Of one that has no control nothing is freed.
        assert (await anna.ask("/control/release")).json()["holder"]["client"] == ben.client
        assert (await ben.ask("/control/release")).json()["holder"] is None
        assert (await ben.control_message(None))["epoch"] > taken["epoch"]


async def test_a_page_loses_control_with_its_socket(served: Served) -> None:
    await free(served)
    async with open_page(served) as ben:
        async with open_page(served) as anna:
            await anna.ask("/control/take")
            await ben.control_message(anna.client)
            # Not even a farewell: the computer went out of reach.
            anna.socket.transport.abort()
            await ben.control_message(None)
        for over in (False, True):
            assert (await anna.ask(f"/control/take?over={over}")).status_code == 409
        refused = await anna.ask("/robot/commands/arm")
        assert (refused.status_code, served.runtime.asked) == (423, [])


async def test_only_the_holder_may_command_and_everybody_may_stop(served: Served) -> None:
    bare = {"X-Mucat-Client": ""}
    robot = [
        ("POST", "/robot/commands/arm", None),
        ("POST", "/robot/commands/loop", {"name": "depth", "controller": "pid"}),
        ("POST", "/robot/commands/parameters", {"values": {"control.set_point": 0.4}}),
        ("POST", "/robot/commands/card", {"colour": "red"}),
        ("POST", "/robot/commands/steering", {"by": "beacons"}),
        ("PUT", "/simulator", {"here": False}),
        ("POST", "/scenarios/runs", {"text": SCENARIO, "place": "live"}),
        ("POST", "/comm-tests/runs", {"text": "[]", "place": "robot"}),
    ]
    name = served.get(ControlArbiter).state().holder
    assert name is not None
    async with open_page(served) as page:
        for key in (bare, {"X-Mucat-Client": page.key}):
            for method, path, body in robot:
                answer = await served.api.request(method, path, json=body, headers=key)
                assert answer.status_code == 423, path
                assert (
                    answer.json()["detail"]
                    == f"Control is with {name.name}. Agree with them, then take it over."
                )
        assert served.runtime.asked == []
        assert (await page.ask("/robot/stop")).status_code == 204
    assert (await served.api.post("/robot/stop", headers=bare)).status_code == 204
    assert served.runtime.asked == [("stop", {})] * 2
    await free(served)
    answer = await served.api.post("/robot/commands/arm")
    assert (answer.status_code, answer.json()["detail"][:19]) == (423, "Nobody has control.")


async def test_a_silent_program_loses_control(served: Served) -> None:
    async with open_page(served) as page:
        arbiter = served.get(ControlArbiter)
        client = arbiter.clients.get(arbiter.lease.holder or 0)
        assert client is not None
        # As if it had been silent for nearly all of its time.
        client.until = served.container.clock.now() + 0.05
        arbiter.announce()
        await page.control_message(None)
        assert (await served.api.post("/robot/commands/arm")).status_code == 423
        assert (await served.api.post("/control/take")).status_code == 200


async def test_the_heartbeat_counts_pages_of_operators_and_programs_in_control(served: Served) -> None:
    await free(served)
    beats = served.runtime.heartbeats
    await until(lambda: beats[-1:] == ["0 0"], "a heartbeat that nobody watches")
    async with open_page(served) as page:
        (await page.ask("/control/take")).raise_for_status()
        await until(lambda: beats[-1] == "1 0", "the page")
    (await served.api.post("/control/take")).raise_for_status()
    await until(lambda: beats[-1] == "0 1", "the program")


async def test_only_the_holder_s_driving_commands_reach_the_runtime(served: Served) -> None:
    await free(served)
    async with open_page(served) as anna, open_page(served) as ben:
        await anna.ask("/control/take")
        await until(lambda: served.runtime.epochs, "the runtime to be told")
        # A command grows no older on its way, however busy the computer is.
        clock = SimulatedClock(served.container.clock.now())
        served.get(ControlArbiter).driving._clock = clock
        await anna.drive(sequence=1, taken=clock.now())
        await anna.drive(sequence=2, taken=clock.now() - 0.4)
        await ben.drive(sequence=3)
        await anna.drive(sequence=4, lease=served.get(ControlArbiter).lease.epoch - 1)
        await anna.drive(sequence=1)
        await anna.drive(sequence=5, taken=clock.now())
        await until(lambda: len(served.runtime.driven) == 2, "two commands")
        assert [command["sequence"] for command in served.runtime.driven] == [1, 5]
        assert set(served.runtime.driven[0]) == {"lease", "sequence", "taken", "axes"}
        counts = (await served.api.get("/control")).json()["driven"]
        expected = {"passed": 2, "too_old": 1, "not_in_control": 1, "other_lease": 1, "not_newer": 1}
        assert counts == expected | {"from_the_future": 0}
        await anna.socket.send(json.dumps(anna.command(axes=[0, 0, 2, 0, 0, 0])))
        assert "six axes" in (await next_text(anna.socket, "error"))["text"]


async def test_a_restarted_runtime_gets_the_epoch_again(served: Served) -> None:
    epoch = served.get(ControlArbiter).lease.epoch
    await until(lambda: served.runtime.epochs[-1:] == [epoch], "the runtime to be told")
    before = len(served.runtime.epochs)
    served.runtime.publish(state_block(0))
    await until(lambda: len(served.runtime.epochs) > before, "the run that speaks to be told")
    assert served.runtime.epochs[-1] == epoch
