"""Events to an MQTT broker, by paho's client in its own thread."""

import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from robot_runtime.contract.published_events import PublishedEvent
from server.features.events.config import EventsConfig
from server.features.events.outlet import (
    CLOSE_SECONDS,
    CONNECT_SECONDS,
    WAITING_MAX,
    OutletCondition,
    OutletError,
    Tally,
    make_tls,
    name_problem,
    read_secret,
)
from server.features.events.payloads import event_json

if TYPE_CHECKING:
    from paho.mqtt.client import Client

PORTS = {"mqtt": 1883, "mqtts": 8883}
KEEPALIVE_SECONDS = 30
"""After one and a half times of it without a sign of the robot, the broker publishes the last will."""
RETRY_SECONDS = (1, 60)
ONLINE, OFFLINE = "online", "offline"
AT_LEAST_ONCE = 1


class MqttOutlet:
    """A broker. Its topics are `mucat/ROBOT/status`, `alarms`, `session` (retained) and `event/KIND`."""

    def __init__(self, robot: str, run: str, config: EventsConfig, folder: Path) -> None:
        self._prefix = f"mucat/{robot}"
        self._name = f"mucat-{robot}-{run[:8]}"
        self._config = config
        self._folder = folder
        self._tally = Tally(f"Broker {config.mqtt}")
        self._client: Client | None = None
        self._retained: dict[str, str] = {}
        self._retaining = threading.Lock()

    def open(self) -> None:
        """Connect from now on; again and again where it fails."""
        try:
            self._client = self._make_client()
        except OutletError as problem:
            self._tally.set("failed", str(problem))
            return
        address = urlsplit(self._config.mqtt)
        self._client.connect_async(
            str(address.hostname), address.port or PORTS[address.scheme], KEEPALIVE_SECONDS
        )
        self._client.loop_start()

    def publish(self, event: PublishedEvent) -> None:
        """Send an event as soon as the broker is there."""
        if self._client is None:
            self._tally.lost += 1
            return
        place = f"{self._prefix}/event/{event.event}"
        sent = self._client.publish(place, event_json(event), qos=AT_LEAST_ONCE)
        if sent.rc == self._queue_full:
            self._tally.lost += 1

    def retain(self, name: str, text: str) -> None:
        """Set a retained topic; after each connection they are set again."""
        with self._retaining:
            self._retained[name] = text
            if self._client is not None and self._client.is_connected():
                self._client.publish(f"{self._prefix}/{name}", text, retain=True)

    def condition(self) -> OutletCondition:
        """The state, and a sentence about it."""
        return self._tally.describe()

    def close(self) -> None:
        """Say that the robot is offline, and leave."""
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
            self._tally.set("failed", f"The broker refuses the robot: {reason}.")
            return
        self._tally.set("ok", "Connected.")
        # What is set meanwhile comes after it.
        with self._retaining:
            for name, text in {"status": ONLINE, **self._retained}.items():
                client.publish(f"{self._prefix}/{name}", text, retain=True)

    def _not_connected(self, _client: "Client", _data: Any) -> None:
        # paho calls this while it handles the exception.
        problem = sys.exc_info()[1]
        why = name_problem(problem) if problem is not None else "it does not answer"
        self._tally.set("failed", f"Cannot connect: {why}.")

    def _disconnected(
        self, _client: "Client", _data: Any, _flags: Any, reason: Any, _properties: Any
    ) -> None:
        # After a refusal, the reason of that says more.
        if self._tally.describe().state != "failed":
            self._tally.set("failed", f"The connection was lost: {reason}.")

    def _published(self, _client: "Client", _data: Any, _number: int, _reason: Any, _properties: Any) -> None:
        self._tally.sent += 1
