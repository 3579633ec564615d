import asyncio
import json
from typing import Any

import pytest

import server.stream.hub as hub_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import OBSERVER, PICTURE, AnyTopic
from robot_runtime.transport.blocks import read_blocks
from server.http.sign_in.identity import SHELL, Identity
from server.stream.hub import DOCUMENTS_MESSAGES, ROWS_MESSAGES, Client, EvictedError, Hub
from tests.server.blocks import debug_block, depth_block, picture_block
from tests.server.waiting import SECONDS, until


class HubPage:
    """A page's end of a socket, whose reading can be paused."""

    offers = True
    """The socket takes frames at once; else each waits for its turn."""

    def __init__(self, hub: Hub, caller: Identity = SHELL) -> None:
        self.received: list[bytes | str] = []
        self.sent: list[bytes | str] = []
        """The same objects as the hub has sent, frames as they are."""
        self.reading = asyncio.Event()
        self.reading.set()
        self.gone = asyncio.Event()
        self.client: Client | None = None
        self.task = asyncio.create_task(
            hub.serve(self._send, self._offer, {"op": "hello"}, self._listen, caller)
        )

    @property
    def texts(self) -> list[dict[str, Any]]:
        return [json.loads(message) for message in self.received if isinstance(message, str)]

    def numbers(self, topic: str) -> list[int]:
        """Return the numbers of all samples received of a topic, in order."""
        blocks = [
            block for message in self.received if isinstance(message, bytes) for block in read_blocks(message)
        ]
        return [
            number
            for block in blocks
            if block.topic.name == topic
            for number in range(block.first, block.first + block.count)
        ]

    async def leave(self) -> None:
        self.gone.set()
        await self.task

    async def _send(self, data: bytes | str) -> None:
        await self.reading.wait()
        self.sent.append(data)
        self.received.append(data)
        # As on a real connection, sending lets others run.
        await asyncio.sleep(0)

    def _offer(self, frame: bytes) -> bool:
        if self.offers and self.reading.is_set():
            self.sent.append(frame)
            self.received.append(frame[{126: 4, 127: 10}.get(frame[1], 2) :])
            return True
        return False

    async def _listen(self, client: Client) -> None:
        self.client = client
        await self.gone.wait()


@pytest.fixture(params=[True, False], ids=["at once", "in turn"], autouse=True)
def offers(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(HubPage, "offers", request.param)


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(110.0)


@pytest.fixture
def hub(clock: SimulatedClock) -> Hub:
    return Hub(clock, lambda _: None)


async def test_a_page_gets_greeting_history_and_live_messages_in_this_order(hub: Hub) -> None:
    hub.notify({"op": "health", "parts": []})
    hub.add([depth_block(0, 3), debug_block(0, "before")])
    page = HubPage(hub)
    await until(lambda: page.numbers("debug") == [0], "the past")
    hub.add([depth_block(3, 2)])
    hub.add([debug_block(1, "after")])
    await until(lambda: page.numbers("depth") == [0, 1, 2, 3, 4], "the present")
    await until(lambda: page.numbers("debug") == [0, 1], "the document")
    assert [text["op"] for text in page.texts] == ["hello", "health"]
    assert isinstance(page.received[0], str)
    await page.leave()


async def test_no_gap_and_no_duplicate_while_the_history_is_being_sent(
    monkeypatch: pytest.MonkeyPatch, hub: Hub
) -> None:
    monkeypatch.setattr(hub_module, "HISTORY_MESSAGE_BYTES", 200)

    for number in range(300):
        hub.add([depth_block(number, 1)])
    page = HubPage(hub)
    page.reading.clear()
    await asyncio.sleep(0)
    for number in range(300, 300 + 3 * ROWS_MESSAGES):
        hub.add([depth_block(number, 1), debug_block(number, "x")])
        if number % 50 == 0:
            page.reading.set()
            await asyncio.sleep(0)
            page.reading.clear()
    page.reading.set()
    total = 300 + 3 * ROWS_MESSAGES
    # In the history the topics come one after the other.
    await until(lambda: len(page.numbers("depth")) >= total, "every depth")
    await until(lambda: len(page.numbers("debug")) >= total - 300, "every line")
    assert page.numbers("depth") == list(range(total))
    assert page.numbers("debug") == list(range(300, total))
    assert all(text["op"] == "hello" for text in page.texts)
    await page.leave()


async def test_all_pages_get_the_same_bytes(hub: Hub) -> None:
    pages = [HubPage(hub), HubPage(hub)]
    await until(lambda: hub.clients == 2, "both pages")
    hub.add([depth_block(0, 1), depth_block(1, 1)])
    await until(lambda: all(page.numbers("depth") for page in pages), "the rows")
    assert pages[0].sent[-1] is pages[1].sent[-1]
    for page in pages:
        await page.leave()


async def test_a_slow_page_loses_the_oldest_rows_and_gets_their_number(hub: Hub) -> None:
    slow, quick = HubPage(hub), HubPage(hub)
    hub.add([depth_block(0, 1)])
    await until(lambda: slow.numbers("depth") == quick.numbers("depth") == [0], "the first row")
    slow.reading.clear()
    for number in range(1, 3 * ROWS_MESSAGES):
        hub.add([depth_block(number, 1)])
        await asyncio.sleep(0)
    await until(lambda: len(quick.numbers("depth")) == 3 * ROWS_MESSAGES, "the quick page")
    slow.reading.set()
    await until(lambda: slow.numbers("depth")[-1] == 3 * ROWS_MESSAGES - 1, "the slow page")
    received = slow.numbers("depth")
    assert received == sorted(set(received))
    notices = [text for text in slow.texts if text["op"] == "dropped"]
    missing = 3 * ROWS_MESSAGES - len(received)
    assert missing > 0
    assert notices == [{"op": "dropped", "topic": "depth", "count": missing}]
    assert not [text for text in quick.texts if text["op"] == "dropped"]
    await slow.leave()
    await quick.leave()


async def test_documents_are_never_skipped_until_the_page_is_disconnected(hub: Hub) -> None:
    page, other = HubPage(hub), HubPage(hub)
    await until(lambda: hub.clients == 2, "both pages")
    page.reading.clear()
    hub.add([debug_block(0, "x")])
    for number in range(1, DOCUMENTS_MESSAGES):
        hub.add([debug_block(number, "x")])
    page.reading.set()
    await until(lambda: len(page.numbers("debug")) == DOCUMENTS_MESSAGES, "every document")
    assert page.numbers("debug") == list(range(DOCUMENTS_MESSAGES))
    page.reading.clear()
    for number in range(DOCUMENTS_MESSAGES, 2 * DOCUMENTS_MESSAGES + 2):
        hub.add([debug_block(number, "x")])
        await asyncio.sleep(0)
    page.reading.set()
    with pytest.raises(EvictedError, match="fell too far behind") as reason:
        await page.task
    assert reason.value.code == 1013
    await until(lambda: len(other.numbers("debug")) == 2 * DOCUMENTS_MESSAGES + 2, "the other page")
    await other.leave()


async def test_only_the_newest_picture_is_sent(hub: Hub) -> None:
    page = HubPage(hub)
    await until(lambda: page.texts, "the greeting")
    page.reading.clear()
    hub.add([picture_block(0)])
    await until(lambda: page.client is not None and page.client.sending_since is not None, "a send")
    for number in range(1, 10):
        hub.add([picture_block(number)])
    page.reading.set()
    await until(lambda: 9 in page.numbers("picture"), "the newest picture")
    assert page.numbers("picture") == [0, 9]
    assert hub.history.since(-1, 1000) == []
    await page.leave()


async def test_a_page_that_stops_reading_is_disconnected_without_effect_on_others(
    monkeypatch: pytest.MonkeyPatch, hub: Hub, clock: SimulatedClock
) -> None:
    monkeypatch.setattr(hub_module, "WATCH_SECONDS", 0.001)

    stalled, other = HubPage(hub), HubPage(hub)
    watch = asyncio.create_task(hub.watch())
    await until(lambda: stalled.texts and other.texts, "both greetings")
    stalled.reading.clear()
    hub.add([depth_block(0, 1)])
    await until(lambda: other.numbers("depth") == [0], "the other page")
    await until(lambda: stalled.client is not None and stalled.client.sending_since is not None, "a send")
    clock.forward(4.9)
    await asyncio.sleep(0.02)
    assert not stalled.task.done()
    clock.forward(0.2)
    with pytest.raises(EvictedError, match="Nothing was read"):
        await stalled.task
    hub.add([depth_block(1, 1)])
    await until(lambda: other.numbers("depth") == [0, 1], "the other page")
    assert hub.clients == 1
    await other.leave()
    watch.cancel()


async def test_unread_answers_end_the_connection(hub: Hub) -> None:
    page = HubPage(hub)
    await until(lambda: page.texts, "the greeting")
    page.reading.clear()
    client = page.client
    assert client is not None
    for number in range(hub_module.ANSWERS_MAX):
        client.answer({"op": "pong", "id": number})
    with pytest.raises(EvictedError, match="unread"):
        client.answer({"op": "pong", "id": -1})
    page.reading.set()
    await page.leave()


async def test_notifications_of_one_kind_replace_each_other(hub: Hub) -> None:
    page = HubPage(hub)
    await until(lambda: page.texts, "the greeting")
    page.reading.clear()
    for number in range(100):
        hub.notify({"op": "health", "parts": [number]})
    page.reading.set()
    await until(lambda: page.texts[-1].get("parts") == [99], "the newest health")
    assert len(page.texts) <= 3
    await page.leave()


async def test_picture_topics_are_subscribed_only_while_a_page_shows_them() -> None:
    subscriptions: list[frozenset[AnyTopic]] = []
    hub = Hub(SimulatedClock(), subscriptions.append)
    first, second = HubPage(hub), HubPage(hub)
    await until(lambda: hub.clients == 2, "both pages")
    hub.add([picture_block(0)])
    assert subscriptions == [{PICTURE}]
    await first.leave()
    assert subscriptions == [{PICTURE}]
    await second.leave()
    assert subscriptions == [{PICTURE}, set()]
    late = HubPage(hub)
    hub.add([debug_block(0, "x")])
    await until(lambda: late.numbers("debug") == [0], "the newcomer")
    assert late.numbers("picture") == []
    await late.leave()


async def test_a_page_gets_only_its_subscribed_pictures() -> None:
    subscriptions: list[frozenset[AnyTopic]] = []
    hub = Hub(SimulatedClock(), subscriptions.append)
    plain, curious = HubPage(hub), HubPage(hub)
    await until(lambda: hub.clients == 2, "both pages")
    await until(lambda: curious.client, "the curious one's socket")
    assert curious.client is not None
    hub.show(curious.client, frozenset({PICTURE, OBSERVER}))
    assert subscriptions[-1] == {PICTURE, OBSERVER}
    hub.add([picture_block(0), picture_block(0, topic="observer")])
    await until(lambda: curious.numbers("picture") == [0], "the camera's picture")
    await until(lambda: curious.numbers("observer") == [0], "the bystander's picture")
    await until(lambda: plain.numbers("picture") == [0], "the camera's picture, too")
    assert plain.numbers("observer") == []
    hub.show(curious.client, frozenset({PICTURE}))
    assert subscriptions[-1] == {PICTURE}
    hub.add([picture_block(1, topic="observer"), picture_block(1)])
    await until(lambda: curious.numbers("picture")[-1] == 1, "the next picture")
    assert curious.numbers("observer") == [0]
    await plain.leave()
    await curious.leave()


async def test_the_number_of_pages_is_limited(hub: Hub) -> None:
    pages = [HubPage(hub) for _ in range(hub_module.CLIENTS_MAX)]
    await until(lambda: hub.clients == hub_module.CLIENTS_MAX, "all pages")
    with pytest.raises(EvictedError, match="open already"):
        await HubPage(hub).task
    for page in pages:
        await page.leave()
    assert hub.clients == 0


async def test_pages_of_a_device_are_limited_and_some_are_for_operators_alone(hub: Hub) -> None:
    viewers = [Identity(number, "tablet", "viewer", "browser") for number in range(1, 7)]
    pages = [HubPage(hub, viewer) for viewer in viewers[:5] for _ in range(8)]
    await until(lambda: hub.clients == 40, "the viewers' pages")
    with pytest.raises(EvictedError, match="This device has 8 pages open"):
        await asyncio.wait_for(HubPage(hub, viewers[0]).task, SECONDS)
    with pytest.raises(EvictedError, match="40 pages are open already"):
        await asyncio.wait_for(HubPage(hub, viewers[5]).task, SECONDS)
    operators = [Identity(number, "bridge", "operator", "browser") for number in (7, 8)]
    pages += [HubPage(hub, operator) for operator in operators for _ in range(5)]
    await until(lambda: hub.clients == 50, "the operators' pages")
    for page in pages:
        await page.leave()
