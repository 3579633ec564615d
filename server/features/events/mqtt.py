"""Events to an MQTT broker, by paho's client in its own thread."""

import json
import secrets
import sys
import threading
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from robot_runtime.contract.published_events import PublishedEvent
from server.features.events.config import EventsConfig
from server.features.events.outlet import (
    OutletCondition,
    OutletError,
    make_tls,
    name_problem,
    read_secret,
)

if TYPE_CHECKING:
    from paho.mqtt.client import Client

WAITING_MAX = 200
"""Events that wait while the broker is away; further ones are lost, and counted."""
CONNECT_SECONDS = 5.0
CLOSE_SECONDS = 2.0
"""The end of the server waits so long for what is still to be sent."""
PORTS = {"mqtt": 1883, "mqtts": 8883}
KEEPALIVE_SECONDS = 30
"""After one and a half times of it without a sign of the robot, the broker publishes the last will."""
RETRY_SECONDS = (1, 60)
ONLINE, OFFLINE = "online", "offline"
AT_LEAST_ONCE = 1


class MqttOutlet:
    """A broker. Its topics are `mucat/ROBOT/status`, `alarms`, `session` (retained) and `event/KIND`."""

    def __init__(self, robot: str, config: EventsConfig, folder: Path) -> None:
        self._prefix = f"mucat/{robot}"
        self._name = f"mucat-{robot}-{secrets.token_hex(4)}"
        self._config = config
        self._folder = folder
        self._condition = OutletCondition("starting", "Connecting.")
        self._sent = self._lost = 0
        self._client: Client | None = None
        self._retained: dict[str, str] = {}
        self._retaining = threading.Lock()

    def open(self) -> None:
        """Connect, and connect again after each failure."""
        try:
            self._client = self._make_client()
        except OutletError as problem:
            self._condition = OutletCondition("failed", str(problem))
            return
        address = urlsplit(self._config.mqtt)
        self._client.connect_async(
            str(address.hostname), address.port or PORTS[address.scheme], KEEPALIVE_SECONDS
        )
        self._client.loop_start()

    def publish(self, event: PublishedEvent) -> None:
        """Send an event as soon as the broker is connected."""
        if self._client is None:
            self._lost += 1
            return
        topic = f"{self._prefix}/event/{event.event}"
        text = json.dumps(asdict(event), ensure_ascii=False, separators=(",", ":"))
        sent = self._client.publish(topic, text.encode(), qos=AT_LEAST_ONCE)
        if sent.rc == self._queue_full:
            self._lost += 1

    def retain(self, name: str, text: str) -> None:
        """Set a retained topic; after each connection they are set again."""
        with self._retaining:
            self._retained[name] = text
            if self._client is not None and self._client.is_connected():
                self._client.publish(f"{self._prefix}/{name}", text, retain=True)

    def condition(self) -> OutletCondition:
        """Return the state, and a sentence about it, with the numbers of messages."""
        state, text = self._condition
        lost = f", lost: {self._lost}" if self._lost else ""
        return OutletCondition(
            state, f"Broker {self._config.mqtt}: {text} Messages sent: {self._sent}{lost}."
        )

    def close(self) -> None:
        """Publish that the robot is offline, and disconnect."""
        # Its thread may just wait for an answer of the network.
        leaving = threading.Thread(target=self._leave, daemon=True)
        leaving.start()
        leaving.join(CLOSE_SECONDS)

    def _leave(self) -> None:
        if self._client is None:
            return
        if self._client.is_connected():
            last = self._client.publish(f"{self._prefix}/status", OFFLINE, qos=AT_LEAST_ONCE, retain=True)
            last.wait_for_publish(CLOSE_SECONDS)
        self._client.disconnect()
        self._client.loop_stop()

    def _make_client(self) -> "Client":
        try:
            from paho.mqtt.client import MQTT_ERR_QUEUE_SIZE, Client
            from paho.mqtt.enums import CallbackAPIVersion
        except ImportError as problem:
            raise OutletError(
                "The package paho-mqtt is missing. Install it where µ-CAT is installed: pip install paho-mqtt"
            ) from problem
        self._queue_full = MQTT_ERR_QUEUE_SIZE
        client = Client(CallbackAPIVersion.VERSION2, client_id=self._name)
        if self._config.mqtt.startswith("mqtts:"):
            authority = self._folder / self._config.ca_file if self._config.ca_file else None
            client.tls_set_context(make_tls(authority))
        if self._config.mqtt_user:
            client.username_pw_set(
                self._config.mqtt_user, read_secret(self._folder / self._config.mqtt_password_file)
            )
        client.will_set(f"{self._prefix}/status", OFFLINE, qos=AT_LEAST_ONCE, retain=True)
        client.connect_timeout = CONNECT_SECONDS
        client.reconnect_delay_set(*RETRY_SECONDS)
        client.max_queued_messages_set(WAITING_MAX)
        client.on_connect = self._connected
        client.on_connect_fail = self._not_connected
        client.on_disconnect = self._disconnected
        client.on_publish = self._published
        return client

    def _connected(self, client: "Client", _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:
        if reason.is_failure:
            self._condition = OutletCondition("failed", f"The broker refuses the robot: {reason}.")
            return
        self._condition = OutletCondition("ok", "Connected.")
        # What is set meanwhile comes after it.
        with self._retaining:
            for name, text in {"status": ONLINE, **self._retained}.items():
                client.publish(f"{self._prefix}/{name}", text, retain=True)

    def _not_connected(self, _client: "Client", _data: Any) -> None:
        # paho calls this while it handles the exception.
        problem = sys.exc_info()[1]
        why = name_problem(problem) if problem is not None else "it does not answer"
        self._condition = OutletCondition("failed", f"Cannot connect: {why}.")

    def _disconnected(
        self, _client: "Client", _data: Any, _flags: Any, reason: Any, _properties: Any
    ) -> None:
        # After a refusal, the reason of that says more.
        if self._condition.state != "failed":
            self._condition = OutletCondition("failed", f"The connection was lost: {reason}.")

    def _published(self, _client: "Client", _data: Any, _number: int, _reason: Any, _properties: Any) -> None:
        self._sent += 1
