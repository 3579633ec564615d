"""Events to a web address: one POST each, in a thread of its own."""

import http.client
import queue
import socket
import threading
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

from robot_runtime.contract.published_events import PublishedEvent
from server import VERSION
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

ANSWER_SECONDS = 10.0
"""From the first byte of a request to the end of its answer."""
RETRY_SECONDS = (1.0, 60.0)
ANSWER_BYTES_MAX = 1000
MAY_CHANGE = (401, 403, 404, 408, 429)
"""Answers after which the same event is sent again; after others of 4xx it never will be accepted."""


class WebhookOutlet:
    """A web address. It follows no redirection, and no proxy of the environment is asked."""

    def __init__(self, config: EventsConfig, folder: Path) -> None:
        self._address = urlsplit(config.webhook)
        self._config = config
        self._folder = folder
        # Without the path, which may be a secret: everybody who may look sees the health.
        self._tally = Tally(f"Receiver {self._address.scheme}://{self._address.netloc}")
        self._events: queue.Queue[PublishedEvent | None] = queue.Queue(WAITING_MAX)
        self._closing = threading.Event()
        self._headers = {"Content-Type": "application/json", "User-Agent": f"mucat/{VERSION}"}
        self._thread = threading.Thread(target=self._run, name="webhook", daemon=True)

    def open(self) -> None:
        """Send from now on."""
        try:
            authority = self._folder / self._config.ca_file if self._config.ca_file else None
            self._tls = make_tls(authority) if self._address.scheme == "https" else None
            if self._config.webhook_token_file:
                path = self._folder / self._config.webhook_token_file
                token = read_secret(path)
                if not token.isascii():
                    raise OutletError(f"The token in {path} has letters that a header cannot: ASCII alone.")
                self._headers["Authorization"] = f"Bearer {token}"
        except OutletError as problem:
            self._tally.set("failed", str(problem))
            return
        self._tally.set("ok", "Not used yet.")
        self._thread.start()

    def publish(self, event: PublishedEvent) -> None:
        """Send an event after those that wait."""
        try:
            self._events.put_nowait(event)
        except queue.Full:
            self._tally.lost += 1

    def retain(self, name: str, text: str) -> None:
        """Nothing: a web address gets events alone."""

    def condition(self) -> OutletCondition:
        """The state, and a sentence about it."""
        return self._tally.describe()

    def close(self) -> None:
        """Send what waits, and end."""
        self._closing.set()
        with suppress(queue.Full):
            self._events.put_nowait(None)
        if self._thread.is_alive():
            self._thread.join(CLOSE_SECONDS)

    def _run(self) -> None:
        while (event := self._events.get()) is not None:
            pause = RETRY_SECONDS[0]
            while not self._send(event) and not self._closing.wait(pause):
                pause = min(2 * pause, RETRY_SECONDS[1])

    def _send(self, event: PublishedEvent) -> bool:
        """Send an event once; False where it is to be sent again."""
        try:
            status = self._post(event_json(event))
        except (OSError, http.client.HTTPException) as problem:
            self._tally.set("failed", f"Cannot be reached: {name_problem(problem)}.")
            return False
        if 200 <= status < 300:
            self._tally.sent += 1
            self._tally.set("ok", "Accepts events.")
            return True
        words = "it sends on to another address, which is not followed" if 300 <= status < 400 else "refused"
        self._tally.set("failed", f"It answered {status}: {words}.")
        final = 400 <= status < 500 and status not in MAY_CHANGE
        self._tally.lost += final
        return final

    def _post(self, body: bytes) -> int:
        """The status of the answer. Raises OSError, HTTPException."""
        host, port = str(self._address.hostname), self._address.port
        connection = (
            http.client.HTTPSConnection(host, port, timeout=CONNECT_SECONDS, context=self._tls)
            if self._tls
            else http.client.HTTPConnection(host, port, timeout=CONNECT_SECONDS)
        )
        path = (self._address.path or "/") + (f"?{self._address.query}" if self._address.query else "")
        # An answer that comes byte by byte would else last for ever.
        deadline = threading.Timer(ANSWER_SECONDS, _cut, (connection,))
        deadline.daemon = True
        deadline.start()
        try:
            connection.request("POST", path, body, self._headers)
            answer = connection.getresponse()
            answer.read(ANSWER_BYTES_MAX)
            return answer.status
        finally:
            deadline.cancel()
            connection.close()


def _cut(connection: http.client.HTTPConnection) -> None:
    if connection.sock is not None:
        with suppress(OSError):
            connection.sock.shutdown(socket.SHUT_RDWR)
