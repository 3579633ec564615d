"""The server's end of Zenoh: blocks from the runtime and the simulator come in, commands go out.

A `GapFiller` for each sender requests missing blocks. Zenoh calls back in its own threads. Received blocks go
into a queue. An arrival wakes the event loop, which empties it at once, or `ROUND_SECONDS` after it was
emptied last. A single message of the simulator waits for the next of the runtime: twenty a second would
otherwise begin rounds in which the robot's own samples wait.
"""

import asyncio
import logging
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from time import monotonic
from typing import Any

from robot_runtime.contract.commands import StopCommand
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import SENT_BY, AnyTopic
from robot_runtime.control.pilot import PILOT
from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.transport.blocks import Block, read_blocks
from robot_runtime.transport.lifetime import HEARTBEAT
from robot_runtime.transport.outbox import SIMULATOR_STREAM, STREAM
from robot_runtime.transport.replay_cache import BacklogReply, write_question
from robot_runtime.transport.zenoh_transport import Subscription, ZenohTransport
from server.platform.errors import ApiError
from server.platform.settings import Settings, SetupError
from server.stream.gap_filler import GapFiller
from server.stream.shared_stop import AT_ONCE, SharedStop

log = logging.getLogger(__name__)

ROUND_SECONDS = 0.024
"""Pause between two emptyings: a longer one costs latency, a shorter one CPU time for waking the loop."""
QUEUE_MAX = 20_000
"""Most blocks that wait while the event loop is busy; far more than in normal operation."""
ANSWER_SECONDS = 2.0
COMMANDS_AT_ONCE = 4
"""And as many questions, which viewers may ask: they take no command's place."""
WAITING_MAX = 32
TURN_SECONDS = 2.0
"""Commands and questions that wait for their turn, and for how long: performed later they might surprise."""
BLOCK_BYTES_MAX = 4_000_000
BACKLOG_SECONDS = 3.0
BACKLOG_FIRST_SECONDS = 0.3
"""Timeout of the first request in s, four times as long for each next one. The first request to a process
that has just started sometimes gets no answer at all."""
BACKLOG_PAUSE = 0.1
"""s between two requests; a process answers only after Zenoh has discovered it."""
CONTACT_SECONDS = 10.0
"""Time that a starting server waits for the answer of a process that a killed server has left."""

BUSY = "The robot's runtime is still busy with earlier commands. Try again."

STREAMS = {STREAM: "runtime", SIMULATOR_STREAM: "simulator"}
"""The sender of each stream: one that sends topics of the other is not believed."""

QUESTIONS = {"runtime": "query/blocks", "simulator": "simulator/blocks"}
"""The query topics at which the processes answer with their backlog."""


class RuntimeSilentError(ApiError):
    """The runtime did not answer; `waited` is False where it was not reachable at all."""

    def __init__(self, text: str, waited: bool) -> None:
        super().__init__(text)
        self.waited = waited
        self.status = 504 if waited else 503

    @classmethod
    def answers(cls) -> Mapping[int, str]:
        """Return both statuses with their meanings."""
        return {503: "It is not running", 504: f"It did not answer within {ANSWER_SECONDS:g} s"}


class Bridge:
    """One Zenoh session. `deliver` is called in the event loop with the received blocks, in order.

    Nothing is delivered before `begin_delivery`.
    """

    def __init__(self, settings: Settings, deliver: Callable[[list[Block]], None]) -> None:
        self.damaged = 0
        """Invalid messages so far."""
        self.on_stop: list[Callable[[], None]] = []
        """Called at each STOP."""
        self.answered = float("-inf")
        """Time of the runtime's last answer to a command, s, steady clock: older documents may lack it."""
        self.reserved_reason: str | None = None
        """Reason why commands are refused now; None where they are not."""
        self.stopped = False
        """The runtime was ended on purpose, the robot being disarmed: a STOP has nothing left to stop."""
        self._settings = settings
        self._deliver = deliver
        self._queue: deque[tuple[str, bytes, str]] = deque(maxlen=QUEUE_MAX)
        self._fillers = {
            name: GapFiller(topics, partial(self._fetch_backlog, name), self._pass_on)
            for name, topics in SENT_BY.items()
        }
        self._ready: list[Block] = []
        self._gathering = False
        self._scheduled = False
        """True while the queue will be emptied without another arrival."""
        self._emptied = float("-inf")
        """Time of the last emptying, by the event loop's clock."""
        self._pictures: dict[AnyTopic, Subscription] = {}
        # STOP has threads of its own: it must not wait behind commands that nobody answers.
        self._stops = ThreadPoolExecutor(AT_ONCE, "stop")
        self._shared_stop = SharedStop(self._send_stop)
        self._commands = ThreadPoolExecutor(COMMANDS_AT_ONCE, "command")
        self._questions = ThreadPoolExecutor(COMMANDS_AT_ONCE, "question")
        self._leases = ThreadPoolExecutor(1, "lease")
        self._turns = {
            client: asyncio.Semaphore(COMMANDS_AT_ONCE) for client in (self._commands, self._questions)
        }
        self._waiting: Counter[ThreadPoolExecutor] = Counter()
        self._opened = False

    async def open(self) -> None:
        """Open the Zenoh session; the other processes may start and end at any time. Raise SetupError."""
        self._loop = asyncio.get_running_loop()
        folder = self._settings.data
        try:
            self._messages = await asyncio.to_thread(
                ZenohTransport,
                self._settings.robot.name,
                listen=[f"unixsock-stream/{folder.server_socket}"],
                connect=[f"unixsock-stream/{folder.runtime_socket}"],
            )
        except OSError as problem:
            raise SetupError(f"The server cannot listen for the robot's runtime: {problem}") from problem
        self._opened = True
        for stream in STREAMS:
            self._messages.subscribe_runs(stream, self._receive)

    async def catch_up(self, names: Iterable[str]) -> dict[str, BacklogReply]:
        """Return the backlogs of the running processes of these names that answer."""
        named = [name for name in names if name in self._fillers]
        answers = await asyncio.gather(*map(self._contact, named))
        return {name: backlog for name, backlog in zip(named, answers, strict=True) if backlog is not None}

    def begin_delivery(self, backlog: Mapping[str, BacklogReply]) -> None:
        """Deliver these backlogs, by the processes' names, and from now on every received block.

        The backlogs and what has arrived since are one delivery.
        """
        self._gathering = True
        for name, filler in self._fillers.items():
            filler.begin_delivery(backlog.get(name))
        self._gathering = False
        self._hand_over()

    def send_heartbeat(self, sockets: int, programs: int) -> None:
        """Send the runtime the server's heartbeat: operators' live sockets, and programs in control."""
        self._messages.publish(HEARTBEAT, f"{sockets} {programs}".encode())

    @property
    def run(self) -> str:
        """The run of the runtime's process, from its newest block; empty before the first."""
        return self._fillers["runtime"].run

    def drive(self, command: bytes) -> None:
        """Send the runtime a driving command; it is dropped where no runtime is connected."""
        self._messages.publish(PILOT, command)

    async def send_lease(self, epoch: int) -> None:
        """Make the runtime drop driving commands of earlier epochs.

        Raise RefusedError, or RuntimeSilentError.
        """
        try:
            await self._loop.run_in_executor(
                self._leases, lambda: self._messages.query("command/lease", {"epoch": epoch}, ANSWER_SECONDS)
            )
        except NoAnswerError as problem:
            raise RuntimeSilentError(str(problem), waited=False) from problem

    def watch_pictures(self, topics: frozenset[AnyTopic]) -> None:
        """Subscribe to these picture topics and no other; a picture is encoded only for subscribers."""
        for topic in self._pictures.keys() - topics:
            self._pictures.pop(topic).close()
        for topic in topics - self._pictures.keys():
            self._pictures[topic] = self._messages.subscribe_runs(topic.name, self._receive)

    async def command(self, name: str, payload: Mapping[str, Any]) -> Mapping[str, Any]:
        """Make the runtime execute a command; return its answer. Raise RefusedError, RuntimeSilentError.

        STOP has `stop`. Commands that change parameters go through `Changes`, which records them.
        """
        answer = await self._ask(f"command/{name}", payload, self._commands)
        self.answered = monotonic()
        return answer

    async def stop(self) -> None:
        """Disarm the robot and end its task; wait behind no command. Raise RuntimeSilentError."""
        for see_stop in self.on_stop:
            see_stop()
        await self.disarm()

    async def disarm(self) -> None:
        """Send a STOP as a step of a scenario, without ending the scenario. Raise RuntimeSilentError."""
        await self._shared_stop.ask()
        self.answered = monotonic()

    async def ask_simulator(self, name: str, payload: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the simulator's answer. Raise RefusedError, RuntimeSilentError."""
        return await self._ask(f"simulator/{name}", payload, self._commands)

    async def query(self, name: str, question: Mapping[str, Any] | None = None) -> Mapping[str, Any]:
        """Return the runtime's answer to a question. Raise RefusedError, RuntimeSilentError."""
        return await self._ask(f"query/{name}", question or {}, self._questions)

    async def scene(self, name: str, payload: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the simulated scene's answer. Raise RefusedError, RuntimeSilentError."""
        try:
            return await self._ask(f"scene/{name}", payload, self._commands)
        except RuntimeSilentError as problem:
            raise RuntimeSilentError(
                "The simulated scene does not answer. The System page shows whether it runs.", problem.waited
            ) from problem

    async def close(self) -> None:
        """Close the Zenoh session."""
        for filler in self._fillers.values():
            await filler.close()
        self._stops.shutdown(wait=False, cancel_futures=True)
        self._commands.shutdown(wait=False, cancel_futures=True)
        self._questions.shutdown(wait=False, cancel_futures=True)
        self._leases.shutdown(wait=False, cancel_futures=True)
        if self._opened:
            await asyncio.to_thread(self._messages.close)

    async def _ask(
        self, name: str, payload: Mapping[str, Any], threads: ThreadPoolExecutor
    ) -> Mapping[str, Any]:
        if self.reserved_reason is not None:
            raise RefusedError(self.reserved_reason)
        if self._waiting[threads] >= WAITING_MAX:
            raise RuntimeSilentError(BUSY, waited=False)
        turns = self._turns[threads]
        self._waiting[threads] += 1
        try:
            async with asyncio.timeout(TURN_SECONDS):
                await turns.acquire()
        except TimeoutError:
            raise RuntimeSilentError(BUSY, waited=False) from None
        finally:
            self._waiting[threads] -= 1
        try:
            return await self._ask_now(name, payload, threads)
        finally:
            turns.release()

    async def _send_stop(self) -> Mapping[str, Any]:
        try:
            return await self._ask_now(f"command/{StopCommand.policy.name}", {}, self._stops)
        except RuntimeSilentError:
            if self.stopped:
                return {}
            raise

    async def _ask_now(
        self, name: str, payload: Mapping[str, Any], threads: ThreadPoolExecutor
    ) -> Mapping[str, Any]:
        started = self._loop.time()
        try:
            return await self._loop.run_in_executor(
                threads, lambda: self._messages.query(name, payload, ANSWER_SECONDS)
            )
        except NoAnswerError as problem:
            waited = self._loop.time() - started > 0.9 * ANSWER_SECONDS
            raise RuntimeSilentError(_silence(name, waited), waited) from problem

    async def _contact(self, name: str) -> BacklogReply | None:
        first_numbers, backlog = self._fillers[name].everything(), None
        with suppress(TimeoutError):
            async with asyncio.timeout(CONTACT_SECONDS):
                while backlog is None:
                    backlog = await self._fetch_backlog(name, first_numbers, CONTACT_SECONDS)
        return backlog

    async def _fetch_backlog(
        self, name: str, first_numbers: Mapping[str, int], seconds: float = BACKLOG_SECONDS
    ) -> BacklogReply | None:
        end = self._loop.time() + seconds
        patience = min(BACKLOG_FIRST_SECONDS, seconds)
        while (began := self._loop.time()) < end:
            try:
                return await asyncio.to_thread(self._fetch, name, first_numbers, patience)
            except NoAnswerError:
                if self._loop.time() - began >= patience:
                    patience = min(4 * patience, seconds)
                await asyncio.sleep(BACKLOG_PAUSE)
            except (RefusedError, LayoutError) as problem:
                log.warning("the backlog of the %s cannot be read: %s", name, problem)
                break
        return None

    def _fetch(self, name: str, first_numbers: Mapping[str, int], seconds: float) -> BacklogReply:
        question = write_question(first_numbers)
        backlog = BacklogReply.from_bytes(self._messages.query_bytes(QUESTIONS[name], question, seconds))
        _require_sender(backlog.blocks, name)
        return backlog

    def _receive(self, name: str, data: bytes, run: str) -> None:
        """Queue a message, in Zenoh's thread."""
        self._queue.append((name, data, run))
        if name == SIMULATOR_STREAM and len(self._queue) == 1:
            return
        # Two threads may get here at once: then the queue is emptied twice, the second time of nothing.
        if self._scheduled:
            return
        self._scheduled = True
        try:
            self._loop.call_soon_threadsafe(self._schedule)
        except RuntimeError:
            log.debug("a block of %s arrived after the event loop had ended", name)

    def _schedule(self) -> None:
        """Empty the queue now, or `ROUND_SECONDS` after it was emptied last."""
        wait = self._emptied + ROUND_SECONDS - self._loop.time()
        if wait > 0:
            self._loop.call_later(wait, self._drain)
        else:
            self._drain()

    def _drain(self) -> None:
        # Before the queue is read: what arrives from now on schedules an emptying of its own.
        self._scheduled = False
        self._emptied = self._loop.time()
        self._empty_queue()

    def _empty_queue(self) -> None:
        self._gathering = True
        while self._queue:
            name, data, run = self._queue.popleft()
            try:
                if len(data) > BLOCK_BYTES_MAX:
                    raise LayoutError(f"{len(data)} bytes are too many")
                blocks = _read_own_blocks(name, data, run)
            except LayoutError as problem:
                self.damaged += 1
                log.warning("an invalid message of %s was dropped: %s", name, problem)
                continue
            if name in STREAMS:
                self._fillers[STREAMS[name]].take(run, blocks)
            else:
                self._pass_on(blocks)
        self._gathering = False
        self._hand_over()

    def _pass_on(self, blocks: list[Block]) -> None:
        self._ready += blocks
        if not self._gathering:
            self._hand_over()

    def _hand_over(self) -> None:
        blocks, self._ready = self._ready, []
        if blocks:
            self._deliver(blocks)


def _read_own_blocks(name: str, data: bytes, run: str) -> list[Block]:
    """Return the blocks of a message. Raise LayoutError where they are damaged, or not of its sender."""
    blocks = read_blocks(data, run)
    if name in STREAMS:
        _require_sender(blocks, STREAMS[name])
    elif any(block.topic.name != name for block in blocks):
        raise LayoutError("it holds another topic")
    return blocks


def _require_sender(blocks: Iterable[Block], sender: str) -> None:
    for block in blocks:
        if block.topic.sender != sender:
            raise LayoutError(f"the {sender} does not send {block.topic.name}")


def _silence(name: str, waited: bool) -> str:
    if name.startswith("simulator/"):
        return "The simulator does not answer. See the System page."
    if waited:
        return f"The robot's runtime did not answer within {ANSWER_SECONDS:g} s. See the System page."
    return "The robot's runtime is not running. The server starts it again; try again in a few seconds."
