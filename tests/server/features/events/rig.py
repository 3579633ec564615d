"""A broker for tests, on a port of the system's choice."""

import json
import queue
import shutil
import socket
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from paho.mqtt.client import Client, MQTTMessage
from paho.mqtt.enums import CallbackAPIVersion

from tests.server.waiting import SECONDS
from tests.waiting import wait_for

BROKER = shutil.which("mosquitto") or "/usr/sbin/mosquitto"


@contextmanager
def broker(folder: Path, port: int, *lines: str) -> Iterator[None]:
    """A mosquitto at this port, with more lines of its configuration."""
    config = folder / "mosquitto.conf"
    general = [f"listener {port} 127.0.0.1", "persistence false", "user root"]
    config.write_text("\n".join([*general, *(lines or ["allow_anonymous true"])]) + "\n")
    with (folder / "mosquitto.log").open("ab") as log:
        process = subprocess.Popen([BROKER, "-c", str(config)], stdout=log, stderr=log)
    try:
        wait_for(lambda: answers(port), "the broker to listen")
        yield
    finally:
        process.terminate()
        process.wait()


def answers(port: int) -> bool:
    """Return True where something accepts connections at this port."""
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


class MqttListener:
    """A program at the broker that keeps every message, in order."""

    def __init__(self, port: int, topic: str = "mucat/#", **login: str) -> None:
        self.messages: queue.Queue[tuple[str, bytes, bool]] = queue.Queue()
        self._client = Client(CallbackAPIVersion.VERSION2)
        if login:
            self._client.username_pw_set(login["user"], login["password"])
        self._client.on_message = self._keep
        subscribed = threading.Event()
        self._client.on_connect = lambda client, *_: client.subscribe(topic, qos=1)
        self._client.on_subscribe = lambda *_: subscribed.set()
        self._client.connect("127.0.0.1", port)
        self._client.loop_start()
        assert subscribed.wait(SECONDS)

    def next(self, topic: str) -> Any:
        """Return the JSON, or else the text, of the next message at this topic; others are passed over."""
        while True:
            result, payload, _ = self.messages.get(timeout=SECONDS)
            if result == topic:
                return payload.decode() if topic.endswith("status") else json.loads(payload)

    def close(self) -> None:
        """Leave."""
        self._client.disconnect()
        self._client.loop_stop()

    def _keep(self, _client: Client, _data: Any, message: MQTTMessage) -> None:
        self.messages.put((message.topic, bytes(message.payload), message.retain))
