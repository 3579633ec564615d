import asyncio
import csv
import io
import json
import shutil
import sys
import time
import zipfile
from typing import Any

import httpx
import pytest

import server.stream.bridge as bridge_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import DEPTH
from robot_runtime.transport.blocks import read_blocks
from server.features.doors.config import DoorsConfig
from server.features.doors.house import Doors
from server.features.exports.jobs import Jobs
from server.health import monitor
from server.health.monitor import HealthMonitor
from server.library.content import Recording
from server.openapi import main as print_openapi
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.managed_process import ProcessCommand
from server.stream.bridge import Bridge
from server.stream.budget import Budgets
from server.stream.hub import Hub
from tests.runtime.missions.water import DIVE, mission
from tests.server.blocks import depth_block, link_block, state_block, truth_block
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS, until


async def exported(served: Served, session: int) -> httpx.Response:
    """Return a session as CSV, through an export."""
    job = (await served.api.post("/exports", json={"session": session, "format": "csv"})).json()
    find = served.get(Jobs).find
    await until(lambda: (export := find(job["id"])) and export.state in ("done", "failed"), "the file", 60)
    return (await served.api.get(f"/exports/{job['id']}/file")).raise_for_status()


async def test_health_lists_every_part_with_its_text(served: Served) -> None:
    async def states() -> dict[str, str]:
        answer = await served.api.get("/health")
        assert answer.status_code == 200
        assert answer.json()["robot"] == "tested"
        assert all(part["text"] for part in answer.json()["parts"])
        return {part["name"]: part["state"] for part in answer.json()["parts"]}

    heard = ["server", "database", "runtime", "link", "board", "simulator"]
    assert list(await states()) == [*heard, "scene", "camera"]
    assert (await served.api.get("/health")).json()["status"] == "starting"
    # Nothing grows old while it is looked at.
    monitor, clock = served.get(HealthMonitor), served.container.clock
    monitor._clock = SimulatedClock(clock.now())
    served.runtime.publish(state_block(0), link_block(0, 10), link_block(1, 20), truth_block(0))
    await until(lambda: monitor.health().status == "ok", "all to be well")
    assert await states() == dict.fromkeys(heard, "ok") | {"scene": "absent", "camera": "ok"}
    served.runtime.publish(state_block(1, camera="no picture: there is no camera"))
    await until(lambda: monitor.health().parts[-1].state == "absent", "the camera")
    assert monitor.health().parts[-1].text == "No picture: there is no camera."
    assert monitor.health().status == "ok"


async def test_the_newest_state_is_shown(served: Served) -> None:
    answer = await served.api.get("/robot")
    assert answer.status_code == 503
    assert "/api/health" in answer.json()["detail"]
    served.runtime.publish(state_block(0, set_point_default=0.5), state_block(1, set_point_default=0.75))
    await until(
        lambda: (served.get(HealthMonitor).state() or {}).get("set_point_default") == 0.75, "the state"
    )
    answer = await served.api.get("/robot")
    assert (answer.status_code, answer.json()["set_point_default"]) == (200, 0.75)


async def test_the_state_of_a_silent_runtime_is_unknown(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    served.runtime.publish(state_block(0, armed=True))
    await until(served.get(HealthMonitor).state, "the state")
    monkeypatch.setattr(monitor, "STATE_SECONDS", 0.0)
    answer = await served.api.get("/robot")
    assert answer.status_code == 503
    assert "state is unknown: its runtime has said nothing for 0 s" in answer.json()["detail"]


async def test_nobody_is_sent_the_last_words_of_a_silent_runtime_for_present_ones(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    doors = Doors(
        settings.with_section(DoorsConfig(foxglove=True)),
        served.container.clock,
        served.get(Hub),
        served.get(Budgets),
    )
    doors.see(state_block(0, armed=True))
    doors.see_health([{"name": "runtime", "state": "ok", "text": "Sends data."}])
    assert {sample.source for sample in doors.newest()} == {"state", "health"}
    doors.see_health([{"name": "runtime", "state": "failed", "text": "Sends nothing."}])
    assert [sample.source for sample in doors.newest()] == ["health"]

    monkeypatch.setattr(served.get(HealthMonitor), "mission", lambda: {"phase": "running"})
    served.runtime.publish(state_block(0, armed=True))
    await until(served.get(HealthMonitor).state, "the state")
    monkeypatch.setattr(monitor, "STATE_SECONDS", 0.0)
    assert (await served.api.get("/missions/state")).status_code == 503


async def test_the_state_is_of_after_the_last_command(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(monitor, "CATCH_UP_SECONDS", SECONDS)

    async with serve(settings) as served:
        served.runtime.publish(state_block(0, time=time.monotonic()))
        await until(served.get(HealthMonitor).state, "the state")
        await served.api.post("/robot/commands/arm")
        asked = asyncio.create_task(served.api.get("/robot"))
        done, _ = await asyncio.wait({asked}, timeout=0.1)
        assert not done
        served.runtime.publish(state_block(1, time=time.monotonic(), armed=True))
        assert (await asked).json()["armed"] is True


DEPTHS = {"control.set_point": 0, "control.set_point_detected": 10}
CHANGED = {"changed": [{"name": "depth.pid.kp", "before": 1, "after": 2}], "left_out": []}
COMMANDS: list[tuple[str, object, str, dict[str, Any]]] = [
    ("stop", None, "stop", {}),
    ("commands/arm", None, "arm", {}),
    (
        "commands/loop",
        {"name": "depth", "controller": "pid", "gains": {"kp": 2}},
        "loop",
        {"name": "depth", "controller": "pid", "gains": {"kp": 2}},
    ),
    (
        "commands/loop",
        {"name": "depth", "controller": "pid"},
        "loop",
        {"name": "depth", "controller": "pid"},
    ),
    (
        "commands/parameters",
        {"values": {"control.set_point": 0.4}},
        "parameters",
        {"values": {"control.set_point": 0.4}},
    ),
    ("commands/parameters", {"values": DEPTHS}, "parameters", {"values": DEPTHS}),
    ("commands/card", {"colour": "red"}, "card", {"colour": "red"}),
    ("commands/card", {"colour": None}, "card", {}),
    (
        "commands/parameters",
        {"values": {"vision.rate": 8}, "expected": {"vision.rate": 4}},
        "parameters",
        {"values": {"vision.rate": 8}, "expected": {"vision.rate": 4}},
    ),
    ("commands/steering", {"by": "beacons"}, "steering", {"by": "beacons"}),
]


async def test_every_command_reaches_the_runtime(served: Served) -> None:
    served.runtime.answer = {"changed": {"depth.pid.kp": [1, 2]}}
    for path, body, name, expected in COMMANDS:
        answer = await served.api.post(f"/robot/{path}", json=body)
        if name in ("stop", "arm", "card"):
            assert (answer.status_code, answer.content) == (204, b""), answer.text
        else:
            assert (answer.status_code, answer.json()) == (200, CHANGED), answer.text
        assert served.runtime.asked[-1] == (name, expected)
    assert len(served.runtime.asked) == len(COMMANDS)


INVALID = [
    ("loop", "{}"),
    ("loop", '{"name": ""}'),
    ("loop", '{"name": "depth", "controller": "pid", "gains": {"kp": NaN}}'),
    ("loop", '{"name": "depth", "controller": "pid", "gains": {"kp": Infinity}}'),
    ("loop", '{"name": "depth", "controller": "pid", "extra": 1}'),
    ("loop", '{"name": "depth", "set_point": -0.1}'),
    ("loop", '{"name": "depth", "set_point": 10.1}'),
    ("loop", '{"name": "depth", "set_point": "deep"}'),
    ("card", '{"color": "red"}'),
    ("card", '{"colour": 3}'),
    ("vision_settings", '{"rate": 0}'),
    ("vision_settings", '{"rate": 1e999}'),
    ("vision_settings", "no JSON"),
    ("vision_settings", "[]"),
]


async def test_invalid_commands_never_reach_the_runtime(served: Served) -> None:
    for path, body in INVALID:
        headers = {"content-type": "application/json"}
        answer = await served.api.post(f"/robot/commands/{path}", content=body, headers=headers)
        assert answer.status_code == 422, (path, body)
        assert answer.json()["detail"].startswith("The request is not valid.")
    assert served.runtime.asked == []


async def test_a_view_of_the_scene_has_its_range(served: Served) -> None:
    view = {"name": "top", "azimuth": 0, "elevation": 95, "distance": 1}
    answer = await served.api.put("/scene/view", json=view)
    assert (answer.status_code, "elevation" in answer.json()["detail"]) == (422, True)


async def test_the_last_frames_come_from_the_runtime(settings: Settings) -> None:
    frame = {
        "time": 9.5,
        "sent": True,
        "bytes": "0102ff00",
        "kinds": ["Start"],
        "reliable": True,
        "open": False,
        "number": 3,
        "acknowledged": 12,
        "problem": "",
    }
    fault = {"time": 8.0, "text": "the port went away", "frames": [{**frame, "number": None}]}

    async with serve(settings) as served:
        answer = await served.api.get("/link/frames")
        assert answer.json() == {"time": 1.0, "frames": [], "fault": None}
        served.runtime.frames = {"time": 10.0, "frames": [frame], "fault": fault}
        answer = await served.api.get("/link/frames")
        assert (answer.status_code, answer.json()) == (200, served.runtime.frames)


async def test_a_refusal_is_passed_on_word_for_word(served: Served) -> None:
    served.runtime.refusal = "There is no fresh depth. Check the pressure sensor."
    answer = await served.api.post("/robot/commands/arm")
    assert (answer.status_code, answer.json()) == (409, {"detail": served.runtime.refusal})


@pytest.mark.parametrize(
    ("method", "path", "body", "asked"),
    [
        ("POST", "/robot/commands/arm", None, ("arm", {})),
        ("POST", "/robot/commands/arm", {"mode": "manual"}, ("arm", {"mode": "manual"})),
        ("POST", "/robot/commands/mode", {"mode": "automatic"}, ("mode", {"mode": "automatic"})),
        ("POST", "/robot/commands/check_fins", None, ("check_fins", {})),
        ("POST", "/robot/commands/acknowledge", None, ("acknowledge", {})),
    ],
)
async def test_changes_of_steering_reach_the_runtime(
    method: str, path: str, body: dict[str, str] | None, asked: tuple[str, dict[str, str]], served: Served
) -> None:
    answer = await served.api.request(method, path, json=body)
    assert answer.status_code == 204
    assert served.runtime.asked[-1] == asked


async def test_only_a_scenario_may_let_the_robot_go_on_without_the_server(served: Served) -> None:
    answer = await served.api.post("/robot/commands/arm", json={"alone": 60})
    assert answer.status_code == 409
    assert "Only a scenario" in answer.json()["detail"]
    assert served.runtime.asked == []


@pytest.mark.parametrize(
    ("path", "body"), [("/robot/commands/arm", None), ("/missions/start", {"text": mission(DIVE)})]
)
async def test_with_a_full_disk_nothing_is_armed(
    settings: Settings,
    monkeypatch: pytest.MonkeyPatch,
    path: str,
    body: dict[str, str] | None,
    served: Served,
) -> None:
    usage = shutil.disk_usage(settings.data.path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=19_999_999))
    answer = await served.api.post(path, json=body)
    assert answer.status_code == 507
    assert "The disk is full: 20 MB are free" in answer.json()["detail"]
    assert served.runtime.asked == []


@pytest.mark.parametrize("body", [{}, {"mode": "failsafe"}, {"mode": "manual", "alone": 60}])
async def test_other_modes_are_refused(body: dict[str, Any], served: Served) -> None:
    assert (await served.api.post("/robot/commands/mode", json=body)).status_code == 422
    assert served.runtime.asked == []


async def test_a_missing_runtime_is_reported_at_once(monkeypatch: pytest.MonkeyPatch, served: Served) -> None:
    # Whoever waited for an answer would wait longer than any computer is busy.
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", 2 * SECONDS)
    served.runtime.__exit__()
    async with asyncio.timeout(SECONDS):
        answer = await served.api.post("/robot/stop")
        while answer.status_code == 204:
            answer = await served.api.post("/robot/stop")
    assert answer.status_code == 503
    assert "not running" in answer.json()["detail"]


async def test_a_silent_runtime_is_reported_after_the_timeout_and_stop_does_not_wait(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    # None of them is over before the others were asked, however busy the computer is.
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", SECONDS)
    monkeypatch.setattr(bridge_module, "TURN_SECONDS", 0.05)
    gate = served.runtime.gates["vision"]
    gate.clear()
    slow = [
        asyncio.create_task(served.get(Bridge).command("vision", {}))
        for _ in range(bridge_module.COMMANDS_AT_ONCE)
    ]
    await asyncio.sleep(0)
    refused = await served.api.post("/robot/commands/arm")
    assert refused.status_code == 503
    assert "busy" in refused.json()["detail"]
    stopped = await served.api.post("/robot/stop")
    early = [task for task in slow if task.done()]
    gate.set()
    await asyncio.gather(*slow)
    assert (stopped.status_code, early) == (204, [])
    gate.clear()
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", 1.0)
    with pytest.raises(bridge_module.RuntimeSilentError, match="did not answer within 1 s") as silent:
        await served.get(Bridge).command("vision", {})
    gate.set()
    assert silent.value.waited


async def test_commands_wait_their_turn_and_too_many_are_refused(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    for name in ("ANSWER_SECONDS", "TURN_SECONDS"):
        monkeypatch.setattr(bridge_module, name, SECONDS)
    gate, bridge = served.runtime.gates["vision"], served.get(Bridge)
    gate.clear()
    most = bridge_module.COMMANDS_AT_ONCE + bridge_module.WAITING_MAX
    waiting = [asyncio.create_task(bridge.command("vision", {})) for _ in range(most)]
    await asyncio.sleep(0)
    with pytest.raises(bridge_module.RuntimeSilentError, match="busy"):
        await bridge.command("vision", {})
    gate.set()
    assert await asyncio.gather(*waiting) == [{"accepted": True}] * most


async def test_a_session_from_start_to_download(settings: Settings, served: Served) -> None:
    api = served.api
    assert (await api.get("/sessions")).json() == []
    started = await api.post("/sessions", json={"name": " Dive ", "note": "cold"})
    assert started.status_code == 201
    session = started.json()
    assert (session["name"], session["note"], session["state"]) == ("Dive", "cold", "recording")
    assert session["started"].endswith("Z")
    again = await api.post("/sessions", json={})
    assert again.status_code == 409
    assert "“Dive” is being recorded" in again.json()["detail"]
    served.runtime.publish(depth_block(0, 10, start=served.container.clock.now()))
    store = served.get(Store)

    def counts() -> dict[str, int]:
        return Recording.open(store, session["id"]).counts()

    await until(lambda: counts().get("depth") == 10, "the samples")
    half = await exported(served, session["id"])
    assert "depth.csv" in zipfile.ZipFile(io.BytesIO(half.content)).namelist()
    stopped = (await api.post(f"/sessions/{session['id']}/stop")).json()
    assert stopped["state"] == "complete"
    assert (await api.get("/sessions")).json() == [stopped]
    detail = (await api.get(f"/sessions/{session['id']}")).json()
    assert stopped.items() <= detail.items()
    assert [(topic["name"], topic["count"]) for topic in detail["topics"]][:1] == [("depth", 10)]
    assert (await api.post(f"/sessions/{session['id']}/stop")).status_code == 409
    whole = await exported(served, session["id"])
    assert whole.headers["content-type"] == "application/zip"
    assert '_Dive.csv.zip"' in whole.headers["content-disposition"]
    archive = zipfile.ZipFile(io.BytesIO(whole.content))
    lines = list(csv.DictReader(io.StringIO(archive.read("depth.csv").decode())))
    assert [int(line["time [µs]"]) for line in lines] == list(range(10))
    assert json.loads(archive.read("session.json"))["configuration"] == settings.config.read_text()


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ({"name": "x" * 101}, 422),
        ({"note": "x" * 10_001}, 422),
        ({"name": 1}, 422),
        ({"other": ""}, 422),
        ({}, 201),
    ],
)
async def test_descriptions_of_new_sessions_are_validated(
    body: dict[str, object], status: int, served: Served
) -> None:
    answer = await served.api.post("/sessions", json=body)
    assert answer.status_code == status
    if status == 201:
        assert answer.json()["name"].endswith(" UTC")


async def test_an_unknown_session_is_not_found(served: Served) -> None:
    for answer in (
        await served.api.get("/sessions/7"),
        await served.api.post("/exports", json={"session": 7, "format": "csv"}),
        await served.api.post("/sessions/7/stop"),
    ):
        assert answer.status_code == 404
        assert "There is no session 7" in answer.json()["detail"]
    for strange in ("0", "-1", "x", "1.5", str(2**63), "..%2f1"):
        assert (await served.api.get(f"/sessions/{strange}")).status_code in (404, 422)


async def test_a_session_is_completed_when_the_server_ends_in_order(settings: Settings) -> None:
    async with serve(settings) as served:
        await served.api.post("/sessions", json={"name": "cut"})
        served.runtime.publish(depth_block(0, 4))
        seen = served.get(HealthMonitor)._newest
        await until(lambda: DEPTH in seen, "the samples")
    async with serve(settings) as served:
        (session,) = (await served.api.get("/sessions")).json()
        assert (session["state"], session["samples"] >= 4) == ("complete", True)


async def test_every_answer_has_the_security_headers(served: Served) -> None:
    root = f"http://127.0.0.1:{served.settings.server.port}"
    for url in ("/health", "/nothing", f"{root}/", f"{root}/operate"):
        headers = (await served.api.get(url)).headers
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["x-frame-options"] == "DENY"
        assert headers["referrer-policy"] == "same-origin"
        assert headers["cross-origin-opener-policy"] == "same-origin"
        assert headers["cross-origin-resource-policy"] == "same-origin"
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert "unsafe" not in headers["content-security-policy"]
        assert "server" not in headers
    assert (await served.api.get("/health")).headers["cache-control"] == "no-store"


async def test_a_dead_process_is_shown_in_health_and_by_a_notice(settings: Settings) -> None:
    broken = ProcessCommand(
        "board", "emulated board", (sys.executable, "-c", "raise SystemExit('no firmware')")
    )

    async with serve(settings, [broken]) as served:
        board = {"state": "starting", "text": ""}
        async with asyncio.timeout(SECONDS):
            while board["state"] != "failed":  # between two starts of it
                answer = await served.api.get("/health")
                (board,) = (part for part in answer.json()["parts"] if part["name"] == "board")
        assert board["text"] == "It has ended with exit status 1. Its last words: no firmware."
        history = b"".join(b"".join(group) for group in served.get(Hub).history.since(-1, 10**6))
        assert "The emulated board has ended with exit status 1" in history.decode(errors="replace")


async def test_damaged_blocks_are_dropped(served: Served) -> None:
    good = depth_block(0, 2).data
    for bad in (good[:11], good[:-1], good + b"x", b"\xff" + good[1:], good[:1] + b"\x01" + good[2:]):
        served.runtime.publish_bytes(bad)
    served.runtime.publish(depth_block(0, 2))
    await until(lambda: served.get(Bridge).damaged == 5, "the damaged blocks")
    await until(lambda: DEPTH in served.get(HealthMonitor)._newest, "the good one")
    stored = b"".join(b"".join(chunk) for chunk in served.get(Hub).history.since(-1, 10**6))
    assert [block.data for block in read_blocks(stored) if block.topic.name == "depth"] == [good]


def test_the_description_of_the_interface_is_reproducible(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["server.openapi"])
    print_openapi()
    first = capsys.readouterr().out
    print_openapi()
    assert capsys.readouterr().out == first
    paths = json.loads(first)["paths"]
    assert "/api/live" not in paths
    assert all(way["summary"] and way["operationId"] for path in paths.values() for way in path.values())
    schemas = json.loads(first)["components"]["schemas"]
    assert {"Health", "Session", "State", "LoopCommand", "Problem"} <= set(schemas)
