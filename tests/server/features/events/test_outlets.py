"""Events to a real broker, and what happens where it is away, or wrong."""

import asyncio
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from paho.mqtt.client import Client

from robot_runtime.contract.published_events import PublishedEvent
from server.features.events import mqtt
from server.features.events.announcer import EventAnnouncer
from server.features.events.config import EventsConfig
from server.features.events.mqtt import WAITING_MAX, MqttOutlet
from server.features.events.outlet import OutletCondition
from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.schemas import EndedRun
from server.features.tuning.runner import TuningRunner
from server.features.tuning.schemas import ControllerInForce, TuningRun
from server.platform.settings import Settings
from tests.server.features.events.rig import MqttListener, broker
from tests.server.ports import reserved_port
from tests.server.serving import serve
from tests.server.waiting import SECONDS, until
from tests.waiting import wait_for

EVENT = PublishedEvent(
    robot="tested",
    event="session_ended",
    run="0123456789abcdef",
    number=1,
    time="2026-11-25T10:00:00.000+00:00",
    subject="Tauchgang µ",
    id=1,
    session=1,
    state="ended",
    severity="info",
    text="Recording has ended.",
)
SCENARIO = EndedRun(
    run="a run",
    name="swim",
    title="scenario",
    place="live",
    session=None,
    before=None,
    state="complete",
    problem="",
)
TUNING = TuningRun(
    id=1,
    name="tuning",
    kind="step",
    loop="depth",
    started=datetime(2026, 11, 25, tzinfo=UTC),
    state="complete",
    problem="",
    settings={},
    force=ControllerInForce(controller="pid", title="PID", gains={}),
    figures={},
    cycle=None,
)


@pytest.fixture
def port() -> Iterator[int]:
    """A broker's port, at which nobody else listens while the broker is away."""
    with reserved_port() as number:
        yield number


def event(number: int) -> PublishedEvent:
    return replace(EVENT, number=number)


def to_broker(folder: Path, port: int, scheme: str = "mqtt", **entries: str) -> MqttOutlet:
    address = f"{scheme}://127.0.0.1:{port}"
    return MqttOutlet("tested", EventsConfig(mqtt=address, **entries), folder)


def test_a_broker_gets_events_and_a_newcomer_finds_what_holds_now(tmp_path: Path, port: int) -> None:
    outlet = to_broker(tmp_path, port)
    with broker(tmp_path, port), closing(MqttListener(port)) as listener:
        outlet.retain("session", '{"id": 1, "name": "Dive"}')
        outlet.open()
        assert listener.next("mucat/tested/status") == "online"
        outlet.publish(EVENT)
        result = listener.next("mucat/tested/event/session_ended")
        assert result["subject"] == "Tauchgang µ"
        wait_for(lambda: outlet.condition().state == "ok", "the condition")
        assert outlet.condition().text.startswith(f"Broker mqtt://127.0.0.1:{port}: Connected.")
        for topic, value in (("session", {"id": 1, "name": "Dive"}), ("status", "online")):
            with closing(MqttListener(port)) as newcomer:
                assert newcomer.next(f"mucat/tested/{topic}") == value
        outlet.close()
        assert listener.next("mucat/tested/status") == "offline"


def test_what_is_set_while_it_connects_is_what_stays_at_the_broker(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    outlet = to_broker(tmp_path, port)
    outlet.retain("session", '{"id": 1}')
    publish, setting = Client.publish, threading.Thread(target=outlet.retain, args=("session", '{"id": 2}'))

    def publish_beside(client: Client, topic: str, *args: Any, **options: Any) -> Any:
        if topic.endswith("/status") and not setting.ident:
            setting.start()
            # Long enough for it to overtake, if it may.
            setting.join(0.3)
        return publish(client, topic, *args, **options)

    with broker(tmp_path, port):
        monkeypatch.setattr(Client, "publish", publish_beside)
        outlet.open()
        wait_for(lambda: setting.ident and not setting.is_alive(), "the new value to be set")
        monkeypatch.undo()
        outlet.close()
        with closing(MqttListener(port)) as newcomer:
            assert newcomer.next("mucat/tested/session") == {"id": 2}


def test_what_waits_while_the_broker_is_away_comes_with_it(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    outlet = to_broker(tmp_path, port)
    outlet.open()
    for number in range(WAITING_MAX + 40):
        outlet.publish(event(number))
    wait_for(lambda: outlet.condition().state == "failed", "the broker to be missed")
    answer = outlet.condition().text
    assert "Cannot connect: Connection refused." in answer
    assert "lost: 40" in answer
    client, subscribed = outlet._client, threading.Event()
    assert client is not None
    reconnect = client.reconnect
    # What comes before somebody has subscribed, nobody gets.
    monkeypatch.setattr(client, "reconnect", lambda: subscribed.wait(SECONDS) and reconnect())
    with broker(tmp_path, port), closing(MqttListener(port)) as listener:
        subscribed.set()
        numbers = [listener.next("mucat/tested/event/session_ended")["number"] for _ in range(WAITING_MAX)]
        assert numbers == [*range(WAITING_MAX)]
        outlet.close()


def test_a_robot_that_vanishes_is_offline_by_its_last_will(tmp_path: Path, port: int) -> None:
    outlet = to_broker(tmp_path, port)
    with broker(tmp_path, port), closing(MqttListener(port)) as listener:
        outlet.open()
        assert listener.next("mucat/tested/status") == "online"
        client = outlet._client
        assert client is not None
        client.socket().shutdown(socket.SHUT_RDWR)  # type: ignore[union-attr]
        assert listener.next("mucat/tested/status") == "offline"
        assert listener.next("mucat/tested/status") == "online"
        outlet.close()


def make_authority(folder: Path) -> None:
    """A certificate for 127.0.0.1, which is its own authority."""
    made = ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2"]
    names = ["-subj", "/CN=lab", "-addext", "subjectAltName=IP:127.0.0.1"]
    files = ["-keyout", str(folder / "key.pem"), "-out", str(folder / "ca.pem")]
    subprocess.run(["openssl", *made, *names, *files], check=True, capture_output=True)


def wait_to_start(outlet: MqttOutlet) -> OutletCondition:
    """Return the condition after the first attempt."""
    wait_for(lambda: outlet.condition().state != "starting", "the broker's answer")
    return outlet.condition()


# paho leaves the socket of a certificate that is not trusted to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_broker_with_tls_and_password(tmp_path: Path, port: int) -> None:
    make_authority(tmp_path)
    secret, other = tmp_path / "password", tmp_path / "other"
    for file, text in ((secret, "deep water\n"), (other, "shallow\n")):
        file.write_text(text)
        file.chmod(0o600)
    known = tmp_path / "known"
    subprocess.run(["mosquitto_passwd", "-b", "-c", str(known), "turtle", "deep water"], check=True)
    tls = (f"certfile {tmp_path}/ca.pem", f"keyfile {tmp_path}/key.pem", f"password_file {known}")
    with broker(tmp_path, port, *tls, "allow_anonymous false"):
        trusted = {"mqtt_user": "turtle", "mqtt_password_file": str(secret), "ca_file": "ca.pem"}
        for entries, state, message in (
            (trusted, "ok", "Connected."),
            (trusted | {"mqtt_password_file": str(other)}, "failed", "refuses the robot: Not authorized."),
            (trusted | {"ca_file": ""}, "failed", "its certificate is not trusted: self-signed certificate"),
        ):
            outlet = to_broker(tmp_path, port, "mqtts", **entries)
            outlet.open()
            result = wait_to_start(outlet)
            assert result.state == state
            assert message in result.text
            outlet.close()


def test_a_secret_that_others_can_read_is_not_used(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("word\n")
    secret.chmod(0o644)
    broken = to_broker(tmp_path, 1, mqtt_user="turtle", mqtt_password_file="secret")
    broken.open()
    assert "Other users can read" in broken.condition().text
    broken.publish(EVENT)
    broken.close()
    absent = to_broker(tmp_path, 1, mqtt_user="turtle", mqtt_password_file="none")
    absent.open()
    assert "cannot be read" in absent.condition().text


async def test_a_broker_that_accepts_and_says_nothing_delays_neither_server_nor_stop(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Whoever waited for the broker would wait longer than any computer is busy.
    monkeypatch.setattr(mqtt, "CONNECT_SECONDS", 4 * SECONDS)
    connected = threading.Event()

    def accept(server: socket.socket, held: list[socket.socket]) -> None:
        while True:
            try:
                held.append(server.accept()[0])
            except OSError:
                return
            connected.set()

    held: list[socket.socket] = []
    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=accept, args=(server, held), daemon=True)
        thread.start()
        port = server.getsockname()[1]
        mute = EventsConfig(mqtt=f"mqtt://127.0.0.1:{port}")

        async with serve(settings.with_section(mute)) as served:
            await until(connected.is_set, "the broker to be asked")
            announcer = served.get(EventAnnouncer)
            longest = 0.0
            for number in range(2 * WAITING_MAX):
                began = time.perf_counter()
                announcer.see_comm_test(number, "Grid", "complete", "")
                longest = max(longest, time.perf_counter() - began)
            assert longest < SECONDS
            assert (await served.api.post("/robot/stop")).status_code in (204, 503)
            part = (await served.api.get("/health")).json()["parts"][-1]
            assert part["name"] == "events"
            assert f"mqtt://127.0.0.1:{port}" in part["text"]
        server.shutdown(socket.SHUT_RDWR)
        thread.join()
        for holder in held:
            holder.close()


async def test_a_server_tells_of_a_recording_from_its_start_to_its_end(
    settings: Settings, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The last messages may take their time on a busy computer.
    monkeypatch.setattr(mqtt, "CLOSE_SECONDS", SECONDS)
    folder = settings.config.parent
    telling = EventsConfig(mqtt=f"mqtt://127.0.0.1:{port}")
    with broker(folder, port), closing(MqttListener(port)) as listener:
        async with serve(settings.with_section(telling)) as served:
            assert await asyncio.to_thread(listener.next, "mucat/tested/status") == "online"
            started = await served.api.post("/sessions", json={"name": "Dive"})
            session = started.raise_for_status().json()["id"]
            began = await asyncio.to_thread(listener.next, "mucat/tested/event/session_began")
            assert (began["subject"], began["id"]) == ("Dive", session)
            scenarios, tuning = served.get(ScenarioRunner), served.get(TuningRunner)
            scenarios._last, tuning._last = SCENARIO, TUNING
            scenarios.announce()
            tuning.announce()
            for kind in ("scenario", "tuning"):
                ended = await asyncio.to_thread(listener.next, f"mucat/tested/event/{kind}_ended")
                assert (ended["subject"], ended["state"]) == (kind, "complete")
        # The server has ended, and the recording with it.
        assert listener.next("mucat/tested/event/session_ended")["subject"] == "Dive"
        assert listener.next("mucat/tested/status") == "offline"
