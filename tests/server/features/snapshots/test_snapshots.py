"""Snapshots over HTTP: kept in the session that records, with their values; every refusal in words."""

from typing import Any

import pytest

from robot_runtime.clock import Clock
from robot_runtime.contract import documents, packets
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, row
from server.features.snapshots import taker as taker_module
from server.platform.store import StoreError
from server.recording.recorder import Recorder
from tests.server.blocks import depth_record, snapshot_block
from tests.server.serving import Served

JPEG = b"\xff\xd8 a picture \xff\xd9"


@pytest.fixture(autouse=True)
def no_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(taker_module, "PAUSE_SECONDS", 0.0)


def rows(now: float) -> list[Block]:
    """Return samples just before a time: 1.5 m deep, looking east, pitched by nothing, 2 m from the start."""
    attitude = (0.5**0.5, 0.0, 0.0, 0.5**0.5)
    imu = packets.Imu(time=1, attitude=attitude, rate=(0.0,) * 3, force=(0.0,) * 3)
    track = documents.Track(x=2.0, y=-1.0, deviation_x=0.5, deviation_y=0.25)
    records = {"depth": depth_record(500), "imu": imu, "track": track}
    return [
        Block.of(BY_NAME[name], 1, 0, row(now - 0.1, record.to_bytes())) for name, record in records.items()
    ]


async def start(served: Served) -> tuple[int, float]:
    """Start a recording; return its number and the present time (s, steady clock)."""
    session = (await served.api.post("/sessions", json={"name": "Dive"})).json()
    return int(session["id"]), served.get(Clock).now()  # type: ignore[type-abstract]


async def take(served: Served) -> tuple[int, dict[str, Any]]:
    answer = await served.api.post("/snapshots")
    return answer.status_code, answer.json()


async def test_a_snapshot_is_kept_with_its_values(served: Served) -> None:
    session, now = await start(served)
    assert (await served.api.get(f"/sessions/{session}/snapshots")).json() == []
    served.runtime.publish(*rows(now))
    served.runtime.snapshot = snapshot_block(0, now, JPEG)
    status, taken = await take(served)
    assert (status, taken["session"]) == (201, session)
    (values,) = (await served.api.get(f"/sessions/{session}/snapshots")).json()
    assert values["time"] == pytest.approx(taken["time"])
    assert values["depth"] == pytest.approx(0.5)
    assert (values["heading"], values["pitch"]) == (pytest.approx(1.5708, abs=1e-3), pytest.approx(0.0))
    assert values["position"] == {"x": 2.0, "y": -1.0, "deviation_x": 0.5, "deviation_y": 0.25}
    picture = await served.api.get(f"/sessions/{session}/snapshot", params={"time": taken["time"] - 0.001})
    assert (picture.content, picture.headers["content-type"]) == (JPEG, "image/jpeg")
    later = await served.api.get(f"/sessions/{session}/snapshots", params={"after": taken["time"] + 0.001})
    assert later.json() == []


async def test_a_picture_without_samples_has_no_values(served: Served) -> None:
    session, now = await start(served)
    served.runtime.snapshot = snapshot_block(0, now, JPEG)
    assert (await take(served))[0] == 201
    (values,) = (await served.api.get(f"/sessions/{session}/snapshots")).json()
    assert [values[name] for name in ("depth", "heading", "roll", "position")] == [None] * 4


async def test_without_a_recording_it_says_to_start_one(served: Served) -> None:
    status, answer = await take(served)
    assert status == 409
    assert "Start a recording first." in answer["detail"]


async def test_the_cameras_refusal_is_passed_on(served: Served) -> None:
    await start(served)
    status, answer = await take(served)
    assert status == 409
    assert "it is unplugged" in answer["detail"]


async def test_the_next_one_needs_a_pause(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(taker_module, "PAUSE_SECONDS", 60.0)
    _, now = await start(served)
    served.runtime.snapshot = snapshot_block(0, now, JPEG)
    assert (await take(served))[0] == 201
    status, answer = await take(served)
    assert status == 409
    assert "Wait a moment." in answer["detail"]


async def test_a_picture_that_never_comes_is_named(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(taker_module, "ARRIVAL_SECONDS", 0.05)
    _, now = await start(served)
    served.runtime.snapshot = snapshot_block(0, now, JPEG)
    monkeypatch.setattr(served.runtime, "publish_bytes", lambda _: None)
    status, answer = await take(served)
    assert status == 503
    assert "did not arrive within 0.05 s" in answer["detail"]


async def test_a_full_disk_is_named(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    _, now = await start(served)
    served.runtime.snapshot = snapshot_block(0, now, JPEG)

    async def refuse() -> None:
        raise StoreError("the disk is full")

    monkeypatch.setattr(served.get(Recorder), "flush", refuse)
    status, answer = await take(served)
    assert status == 507
    assert "the disk is full" in answer["detail"]
