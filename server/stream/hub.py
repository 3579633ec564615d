"""Sends all live blocks to every open page; no page can block another one, the recorder or the robot.

Rows go through one buffer that all clients share: a slow client loses the oldest and gets their number.
Documents go through a second buffer and are never skipped: a client that falls too far behind is
disconnected with a reason, and finds the rest in the recording. Of pictures only the newest is sent. A send
that hangs for `STALL_SECONDS` ends the connection; without this limit one client blocked all, or the memory
filled (measured).
"""

import asyncio
import json
from collections import deque
from collections.abc import Awaitable, Callable, Iterable, Sequence
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import PICTURE, WATCHABLE, AnyTopic, Kind
from robot_runtime.transport.blocks import Block
from server.http.security import POLICY_VIOLATION
from server.http.sign_in.identity import SHELL, Identity
from server.http.websocket_protocol import binary_frame
from server.stream.broadcast import BroadcastBuffer, TopicHistory, Totals

HISTORY_SECONDS = 600.0
HISTORY_TOPIC_BYTES = 4_000_000
"""At the robot's full rate all topics together have 7 MB in ten minutes, the largest 2.3 MB."""
FIRST_SECONDS = 65.0
"""Rows that a page gets when it connects: a minute's chart. A longer chart requests more."""
HISTORY_MESSAGE_BYTES = 256_000
"""One message of history passes a poor radio link within `STALL_SECONDS`."""
HISTORY_ROUNDS = 10
ROWS_MESSAGES, ROWS_BYTES = 200, 1_000_000
DOCUMENTS_MESSAGES, DOCUMENTS_BYTES = 2_000, 2_000_000
ANSWERS_MAX = 64
CLIENTS_MAX = 50
OPERATORS_ONLY = 10
"""Of these sockets, so many are for operators alone."""
DEVICE_MAX = 8
"""Sockets of one browser or program."""
STALL_SECONDS = 5.0
WATCH_SECONDS = 1.0
TRY_AGAIN_LATER = 1013
"""WebSocket close code for a client that the server cannot serve any longer."""

Send = Callable[[bytes | str], Awaitable[None]]
Offer = Callable[[bytes], bool]
"""Sends a `binary_frame` at once; False where it would have to wait."""
_NO_PICTURE = (0, b"")


class EvictedError(Exception):
    """A client is disconnected; the text is the reason sent to it, `code` the WebSocket close code."""

    def __init__(self, reason: str, code: int = TRY_AGAIN_LATER) -> None:
        super().__init__(reason)
        self.code = code


class Client:
    """One open socket: its positions in the buffers and its own messages."""

    def __init__(self, hub: "Hub", send: Send, offer: Offer, clock: Clock, caller: Identity) -> None:
        self.device = caller.device
        self.is_operator = caller.role == "operator"
        self.sending_since: float | None = None
        self.dismissal: EvictedError | None = None
        self._hub = hub
        self._raw_send = send
        self._offer = offer
        self._at_rest = False
        """True while everything is sent, and the sender waits."""
        self._clock = clock
        self._wake = asyncio.Event()
        self._answers: deque[str] = deque()
        self._newest: dict[str, str] = {}
        self._rows = self._documents = 0
        self._seen: Totals = {}
        self._pictures: dict[AnyTopic, int] = {}
        self.watching: frozenset[AnyTopic] = frozenset({PICTURE})
        """Picture topics that it has subscribed to."""

    def answer(self, message: dict[str, Any]) -> None:
        """Queue a message; all are sent, in order. Raise EvictedError where too many wait already."""
        if len(self._answers) >= ANSWERS_MAX:
            raise EvictedError("Too many answers wait unread.")
        # In ASCII: text from a client may hold lone surrogates, which UTF-8 cannot encode.
        self._answers.append(json.dumps(message))
        self._wake.set()

    def notify(self, kind: str, text: str) -> None:
        """Queue a message of which only the newest of each kind is sent."""
        self._newest[kind] = text
        self._wake.set()

    def wake(self) -> None:
        """Wake the sender: a buffer has a new message."""
        self._wake.set()

    def offer_rows(self, frame: bytes) -> None:
        """Send the newest rows at once, in a frame, or wake the sender where something waits before them."""
        rows = self._hub.rows
        if self._at_rest and not self._wake.is_set() and self._rows == rows.end - 1 and self._offer(frame):
            self._rows, self._seen = rows.end, rows.totals
        else:
            self._wake.set()

    async def run(self) -> None:
        """Send the history, then live messages. Raise EvictedError where the client is too slow."""
        await self._send_history()
        while True:
            while self._behind:
                await self._send_one()
            self._wake.clear()
            self._at_rest = True
            await self._wake.wait()
            self._at_rest = False

    async def _send_history(self) -> None:
        tick, start = -1, self._clock.now() - FIRST_SECONDS
        for _ in range(HISTORY_ROUNDS):
            groups, tick = self._hub.history.since(tick, HISTORY_MESSAGE_BYTES, start), self._hub.tick
            self._rows, self._documents = self._hub.rows.end, self._hub.documents.end
            self._seen = self._hub.rows.totals
            for group in groups:
                while self._answers or self._newest:
                    await self._send_one()
                await self._send(b"".join(group))
            if self._hub.rows.first <= self._rows and self._hub.documents.first <= self._documents:
                return
        raise EvictedError("The connection is slower than what the robot sends.")

    @property
    def _behind(self) -> bool:
        """True where a message waits to be sent."""
        hub = self._hub
        if self._rows < hub.rows.end or self._documents < hub.documents.end:
            return True
        return bool(self._answers or self._newest or self._picture)

    @property
    def _picture(self) -> AnyTopic | None:
        """A subscribed topic with a picture that was not sent yet."""
        for topic in self.watching:
            if self._pictures.get(topic, 0) < self._hub.pictures.get(topic, _NO_PICTURE)[0]:
                return topic
        return None

    async def _send_one(self) -> None:
        """Send the most urgent waiting message, if any."""
        hub = self._hub
        if self._answers:
            await self._send(self._answers.popleft())
        elif self._newest:
            await self._send(self._newest.pop(next(iter(self._newest))))
        elif self._documents < hub.documents.end:
            if self._documents < hub.documents.first:
                raise EvictedError(
                    "The connection fell too far behind; the rest is in the recording, if there is one."
                )
            self._documents += 1
            await self._send(hub.documents.get(self._documents - 1).data)
        elif self._rows < hub.rows.end:
            await self._send_rows()
        elif (topic := self._picture) is not None:
            self._pictures[topic], picture = hub.pictures[topic]
            await self._send(picture)

    async def _send_rows(self) -> None:
        buffer = self._hub.rows
        if self._rows < buffer.first:
            for topic, count in buffer.lost(self._seen):
                self.answer({"op": "dropped", "topic": topic.name, "count": count})
            self._rows = buffer.first
        message = buffer.get(self._rows)
        self._rows += 1
        self._seen = message.after
        await self._send(message.data)

    async def _send(self, data: bytes | str) -> None:
        self.sending_since = self._clock.now()
        await self._raw_send(data)
        self.sending_since = None


class Hub:
    """Hub of blocks for all clients; `audience` gets the picture topics in use."""

    def __init__(self, clock: Clock, audience: Callable[[frozenset[AnyTopic]], None]) -> None:
        self.rows = BroadcastBuffer(ROWS_MESSAGES, ROWS_BYTES)
        self.documents = BroadcastBuffer(DOCUMENTS_MESSAGES, DOCUMENTS_BYTES)
        self.history = TopicHistory(HISTORY_SECONDS, HISTORY_TOPIC_BYTES)
        self.tick = 0
        self.pictures: dict[AnyTopic, tuple[int, bytes]] = {}
        """The newest picture of each subscribed topic, with its number."""
        self._picture_number = 0
        self._watched: frozenset[AnyTopic] = frozenset()
        self._required: frozenset[AnyTopic] = frozenset()
        self._clock = clock
        self._audience = audience
        self.listeners: list[Callable[[dict[str, Any]], None]] = []
        """Get every message that the pages are sent."""
        self.programs: Callable[[], int] = lambda: 0
        """Returns the number of programs that have control, and so watch the robot without a socket."""
        self._clients: dict[Client, asyncio.Task[None]] = {}
        self._newest: dict[str, str] = {}

    @property
    def clients(self) -> int:
        """The number of open sockets."""
        return len(self._clients)

    @property
    def operators(self) -> int:
        """The number of open sockets of operators."""
        return sum(client.is_operator for client in self._clients)

    def add(self, blocks: Sequence[Block]) -> None:
        """Pass these blocks to all clients, in one message for rows and one for documents."""
        self.tick += 1
        now = self._clock.now()
        rows: list[Block] = []
        documents: list[Block] = []
        pictured = False
        for block in blocks:
            if block.topic.only_recorded:
                continue
            if block.topic.kind is Kind.PICTURE:
                self._picture_number += 1
                if block.topic in self._watched:
                    self.pictures[block.topic] = (self._picture_number, block.data)
                    pictured = True
                continue
            self.history.add(block, self.tick, now)
            (rows if block.topic.kind is Kind.ROWS else documents).append(block)
        if not self._clients:
            return
        if rows:
            self.rows.append(rows)
        if documents:
            self.documents.append(documents)
        elif rows:
            frame = binary_frame(self.rows.get(self.rows.end - 1).data)
            for client in self._clients:
                client.offer_rows(frame)
        if documents or pictured:
            for client in self._clients:
                client.wake()

    def notify(self, message: dict[str, Any]) -> None:
        """Send a message to all clients, now and on connecting; of each `op` only the newest."""
        for listener in self.listeners:
            listener(message)
        kind, text = message["op"], json.dumps(message, ensure_ascii=False)
        if self._newest.get(kind) == text:
            return
        self._newest[kind] = text
        for client in self._clients:
            client.notify(kind, text)

    def show(self, client: Client, topics: frozenset[AnyTopic]) -> None:
        """Subscribe this client to pictures of these topics and no other."""
        client.watching = topics
        self._count_audience()
        client.wake()

    def require_pictures(self, names: Iterable[str]) -> None:
        """Have the runtime send the pictures of these names, for others than the pages."""
        self._required = frozenset(WATCHABLE[name] for name in names if name in WATCHABLE)
        self._count_audience()

    def dismiss(self, device: int, reason: str) -> None:
        """End all connections of this device, with a reason."""
        for client in self._clients:
            if client.device == device:
                self._end(client, EvictedError(reason, POLICY_VIOLATION))

    async def serve(
        self,
        send: Send,
        offer: Offer,
        greeting: dict[str, Any],
        receive: Callable[[Client], Awaitable[None]],
        caller: Identity,
    ) -> None:
        """Serve one socket of a caller until `receive` returns. Raise EvictedError with the
        reason where it is disconnected.
        """
        self._check_room(caller)
        client = Client(self, send, offer, self._clock, caller)
        client.answer(greeting)
        for kind, text in self._newest.items():
            client.notify(kind, text)
        sender = asyncio.create_task(client.run())
        receiver = asyncio.ensure_future(receive(client))
        self._clients[client] = sender
        self._count_audience()
        try:
            await asyncio.wait({sender, receiver}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._leave(client)
            sender.cancel()
            receiver.cancel()
            outcomes = await asyncio.gather(sender, receiver, return_exceptions=True)
        if client.dismissal is not None:
            raise client.dismissal
        for outcome in outcomes:
            if isinstance(outcome, Exception):
                raise outcome

    def _check_room(self, caller: Identity) -> None:
        # The shell's programs, such as measurements, share one number.
        own = sum(client.device == caller.device for client in self._clients)
        if caller != SHELL and own >= DEVICE_MAX:
            raise EvictedError(f"This device has {DEVICE_MAX} pages open already; close one.")
        limit = CLIENTS_MAX if caller.role == "operator" else CLIENTS_MAX - OPERATORS_ONLY
        if len(self._clients) >= limit:
            raise EvictedError(f"{limit} pages are open already; close one.")

    async def watch(self) -> None:
        """Disconnect clients that have stopped reading; run for ever."""
        while True:
            await asyncio.sleep(WATCH_SECONDS)
            limit = self._clock.now() - STALL_SECONDS
            for client in self._clients:
                if client.sending_since is not None and client.sending_since < limit:
                    self._end(client, EvictedError(f"Nothing was read for {STALL_SECONDS:g} s."))

    def _end(self, client: Client, reason: EvictedError) -> None:
        client.dismissal = reason
        self._clients[client].cancel()

    def _leave(self, client: Client) -> None:
        del self._clients[client]
        self._count_audience()

    def _count_audience(self) -> None:
        topics = self._required.union(*(client.watching for client in self._clients))
        if topics == self._watched:
            return
        self._watched = topics
        for topic in self.pictures.keys() - topics:
            del self.pictures[topic]
        self._audience(topics)
