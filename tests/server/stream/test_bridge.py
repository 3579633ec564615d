import asyncio
import selectors
from collections.abc import Mapping

import pytest

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.errors import NoAnswerError
from robot_runtime.transport.blocks import Block
from robot_runtime.transport.replay_cache import BacklogReply, ReplayCache, write_question
from robot_runtime.transport.zenoh_transport import ZenohTransport
from server.platform.settings import Settings
from server.stream.bridge import BACKLOG_SECONDS, ROUND_SECONDS, Bridge
from tests.server.blocks import depth_block, truth_block

ANSWER = BacklogReply("0123456789abcdef", {}, [])


class AnsweringProcess:
    """A process that drops the first requests, and takes `needs` s to answer one, in a time of its own."""

    def __init__(self, lost: int = 0, needs: float = 0.0) -> None:
        self.asked: list[float] = []
        self._lost = lost
        self._needs = needs
        self._now = 0.0

    def time(self) -> float:
        """s of waiting for it."""
        return self._now

    def answer(self, _question: str, _first_numbers: Mapping[str, int], seconds: float) -> BacklogReply:
        self.asked.append(seconds)
        if len(self.asked) <= self._lost or self._needs > seconds:
            self._now += seconds
            raise NoAnswerError("no answer")
        self._now += self._needs
        return ANSWER


def fetch(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, process: AnsweringProcess
) -> BacklogReply | None:
    async def scenario() -> BacklogReply | None:
        bridge = Bridge(settings, lambda _: None)
        monkeypatch.setattr(bridge, "_loop", process, raising=False)
        monkeypatch.setattr(bridge, "_fetch", process.answer)
        return await bridge._fetch_backlog("runtime", {})

    return asyncio.run(scenario())


def test_a_lost_request_is_repeated_soon(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    process = AnsweringProcess(lost=1)
    assert fetch(settings, monkeypatch, process) is ANSWER
    assert len(process.asked) == 2
    assert process.asked[0] < 0.5


def test_a_slow_process_gets_the_whole_timeout(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    process = AnsweringProcess(needs=2.0)
    assert fetch(settings, monkeypatch, process) is ANSWER
    assert process.asked[-1] == BACKLOG_SECONDS


class SimulatedLoop(asyncio.SelectorEventLoop):
    """An event loop whose time goes on only while nothing is to be done."""

    def __init__(self) -> None:
        selector = selectors.DefaultSelector()
        super().__init__(selector)
        self._now, select = 0.0, selector.select

        def skip(timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
            self._now += timeout or 0.0
            return select(0 if timeout is not None else None)

        selector.select = skip  # type: ignore[method-assign]

    def time(self) -> float:
        """s since the loop began."""
        return self._now


def message(topic: str) -> bytes:
    return Block.of(BY_NAME[topic], 1, 0, bytes(BY_NAME[topic].row_bytes)).data


def deliveries(settings: Settings, arrivals: list[tuple[float, str]]) -> list[tuple[float, list[str]]]:
    """ms and topics of each delivery, of messages that arrive so (ms, topic) at an otherwise idle server."""
    results: list[tuple[float, list[str]]] = []

    async def scenario() -> None:
        loop = asyncio.get_running_loop()
        bridge = Bridge(
            settings,
            lambda blocks: results.append(
                (1000 * (loop.time() - began), [block.topic.name for block in blocks])
            ),
        )
        bridge._loop = loop
        bridge.begin_delivery({})
        began = loop.time()
        for at, topic in arrivals:
            await asyncio.sleep(max(began + at / 1000 - loop.time(), 0.0))
            stream = "simulator/stream" if topic == "truth" else "stream"
            bridge._receive(stream, message(topic), "")
        await asyncio.sleep(3 * ROUND_SECONDS)

    with asyncio.Runner(loop_factory=SimulatedLoop) as runner:
        runner.run(scenario())
    return results


def test_a_robot_s_sample_is_delivered_at_once_though_the_simulator_has_just_spoken(
    settings: Settings,
) -> None:
    (first, together), (second, alone) = deliveries(settings, [(0, "truth"), (5, "depth"), (105, "depth")])
    assert together == ["truth", "depth"]
    assert first < 5 + 1000 * ROUND_SECONDS / 2
    assert alone == ["depth"]
    assert second < 105 + 1000 * ROUND_SECONDS / 2


def test_a_simulator_without_a_runtime_is_heard_with_its_next_message(settings: Settings) -> None:
    result = deliveries(settings, [(0, "truth"), (50, "truth")])
    assert [topics for _, topics in result] == [["truth", "truth"]]


def test_messages_of_a_round_are_delivered_together(settings: Settings) -> None:
    result = deliveries(settings, [(0, "depth"), (1, "imu"), (2, "truth"), (3, "motor")])
    assert [topics for _, topics in result] == [["depth"], ["imu", "truth", "motor"]]
    assert result[1][0] >= 1000 * ROUND_SECONDS


@pytest.mark.parametrize(
    ("name", "topic"), [("simulator/stream", "depth"), ("stream", "truth"), ("observer", "depth")]
)
def test_nobody_sends_the_topics_of_another(settings: Settings, name: str, topic: str) -> None:
    delivered: list[Block] = []
    bridge = Bridge(settings, delivered.extend)
    bridge.begin_delivery({})
    bridge._queue.append((name, message(topic), ""))
    bridge._empty_queue()
    assert (delivered, bridge.damaged) == ([], 1)


def test_the_backlogs_and_what_came_since_are_one_delivery(settings: Settings) -> None:
    delivered: list[list[int]] = []
    bridge = Bridge(settings, lambda blocks: delivered.append([block.first for block in blocks]))
    old, new = depth_block(0, 5), depth_block(5, 5)
    bridge._queue.append(("stream", new.data, ANSWER.run))
    bridge._empty_queue()
    truth = BacklogReply("fedcba9876543210", {"truth": 8}, [truth_block(7)])
    bridge.begin_delivery({"runtime": BacklogReply(ANSWER.run, {"depth": 5}, [old]), "simulator": truth})
    assert delivered == [[0, 5, 7]]


def test_a_backlog_holds_only_its_sender_s_topics(settings: Settings) -> None:
    bridge = Bridge(settings, lambda _: None)
    cache = ReplayCache("run", SteadyClock())
    cache.add(message("depth"), {"depth": 1})
    with ZenohTransport("tested") as own:
        bridge._messages = own
        own.serve_bytes("simulator/blocks", lambda _: cache.answer(write_question({"depth": 0})))
        own.serve_bytes("query/blocks", lambda _: cache.answer(write_question({"depth": 0})))
        assert len(bridge._fetch("runtime", {"depth": 0}, 5.0).blocks) == 1
        with pytest.raises(LayoutError, match="the simulator does not send depth"):
            bridge._fetch("simulator", {"depth": 0}, 5.0)
