"""Restarts of either end on a bad line, in simulated time: no duplicate, no reordering, no loss."""

import random
from itertools import pairwise

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from robot_runtime.contract.packets import DEFINITIONS_HASH, Beacon, Debug, Hello, Packet, Start, decode
from robot_runtime.link.framing import Decoder
from robot_runtime.link.session import LinkSession, SessionStage, session_key
from tests.line_end import LineEnd
from tests.runtime.link.line import Noise, NoisyWire

BAUD = 115_200
STEP = 0.004
BEACON = 0.05
NOISE = Noise(bits=1e-3, drops=0.05, doubles=0.1, inserts=0.05, bursts=0.05, delay=0.01)
RESTARTS = 1000


class RestartTrial:
    """A host and a board; each sends the other numbers, and stores the received ones."""

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.now = 0.0
        self.number = 0
        self.at_board: list[int] = []
        self.at_host: list[int] = []
        self.owed_to_board: list[int] = []
        self.owed_to_host: list[int] = []
        self._host_epoch = 1
        self._board_epoch = 0
        self._set_line(NOISE)
        self._old_to_board: list[bytes] = []
        self._old_to_host: list[bytes] = []
        self._beacon_at = 0.0
        self.session = LinkSession(self._host_epoch, BAUD)
        self.restart_board()

    @property
    def joined(self) -> bool:
        """True where both ends have joined the same session, so that a frame sent now must arrive.

        A board may still be in a session with the host before its restart, while the new host takes the
        greeting that was meant for the old one.
        """
        established = self.session.stage is SessionStage.ESTABLISHED
        return established and self.board.key == session_key(self._host_epoch, self._board_epoch)

    def restart_host(self) -> None:
        self._host_epoch += 1
        self.session = LinkSession(self._host_epoch, BAUD)
        self._forget()

    def restart_board(self) -> None:
        self._board_epoch += 1
        self.board = LineEnd(is_host=False)
        self._say(Hello(definitions=DEFINITIONS_HASH, epoch=self._board_epoch, credit=255))
        self._forget()

    def replay(self, count: int) -> None:
        """Deliver frames of earlier sessions again, in any order, among those of the present one."""
        for old, wire in ((self._old_to_board, self._to_board), (self._old_to_host, self._to_host)):
            for frame in self.chance.sample(old, min(count, len(old))):
                wire.send(frame, self.now)

    def send(self) -> None:
        """Send a number from each end; where both have joined, it must arrive."""
        if not self.joined:
            return
        self.number += 1
        self.owed_to_board.append(self.number)
        self._to_board.send(self.session.send([Start(epoch=self.number)], self.now), self.now)
        self.owed_to_host.append(self.number)
        self._say(Debug(time=0, level=1, text=str(self.number)))

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self.now += STEP
            self._step_board()
            data = self._to_host.receive(self.now)
            self.at_host += [
                int(Debug.from_bytes(message.payload).text)
                for message in self.session.receive(data, self.now)
                if message.type == Debug.type
            ]
            self._to_board.send(self.session.poll(self.now), self.now)

    def settle(self) -> None:
        """Run 3 s without noise, and check that everything owed has arrived."""
        self._set_line(Noise())
        self.run(3.0)
        assert self.joined
        assert set(self.owed_to_board) <= set(self.at_board)
        assert set(self.owed_to_host) <= set(self.at_host)
        self._set_line(NOISE)

    def check(self) -> None:
        """Check that no number came twice, and all in order."""
        for heard in (self.at_board, self.at_host):
            assert all(earlier < later for earlier, later in pairwise(heard))

    def _step_board(self) -> None:
        for type_, payload in self.board.hear(self._to_board.receive(self.now), self.now):
            packet = decode(type_, payload)
            if isinstance(packet, Hello):
                self._say(Hello(definitions=DEFINITIONS_HASH, epoch=self._board_epoch, credit=255))
            elif isinstance(packet, Start):
                self.at_board.append(packet.epoch)
        if self.now >= self._beacon_at:
            self._beacon_at = self.now + BEACON
            self._say(Beacon(time=0, right=0, left=0))
        self._to_host.send(self.board.poll(self.now), self.now)

    def _say(self, *packets: Packet) -> None:
        self._to_host.send(self.board.say(packets, self.now), self.now)

    def _forget(self) -> None:
        # Except an old greeting, which means that the other end has restarted.
        for old, wire in ((self._old_to_board, self._to_board), (self._old_to_host, self._to_host)):
            old += [frame for frame in wire.carried if not list(Decoder().feed(frame))]
            wire.carried.clear()
        self.owed_to_board.clear()
        self.owed_to_host.clear()

    def _set_line(self, noise: Noise) -> None:
        self._to_board = NoisyWire(BAUD, noise, self.chance)
        self._to_host = NoisyWire(BAUD, noise, self.chance)


def test_a_thousand_restarts_lose_nothing_and_repeat_nothing() -> None:
    world = RestartTrial(7)
    for restart in range(RESTARTS):
        for _ in range(world.chance.randrange(4)):
            world.run(world.chance.uniform(0.0, 0.8))
            world.send()
        world.check()
        if restart % 20 == 0:
            world.settle()
        world.chance.choice([world.restart_host, world.restart_board])()
    assert len(world.at_board) > RESTARTS // 2
    assert len(world.at_host) > RESTARTS // 2


def test_a_host_that_takes_a_greeting_for_the_host_before_it_joins_after_the_silence() -> None:
    world = RestartTrial(1)
    world.run(STEP)
    world.restart_board()
    world.restart_host()
    world.run(1.0)
    assert world.session.stage is SessionStage.ESTABLISHED
    assert not world.joined
    world.settle()
    world.send()
    world.settle()
    assert world.at_host == world.at_board == [1]


class Restarts(RuleBasedStateMachine):
    """Any order of sending, waiting, restarting and repeated old frames."""

    def __init__(self) -> None:
        super().__init__()
        self.world = RestartTrial(1)

    @rule(seconds=st.floats(0.0, 1.5))
    def time_passes(self, seconds: float) -> None:
        self.world.run(seconds)

    @precondition(lambda self: self.world.joined)
    @rule(count=st.integers(1, 30))
    def both_send(self, count: int) -> None:
        for _ in range(count):
            self.world.send()

    @rule()
    def host_restarts(self) -> None:
        self.world.restart_host()

    @rule()
    def board_restarts(self) -> None:
        self.world.restart_board()

    @rule(count=st.integers(1, 20))
    def old_frames_come_again(self, count: int) -> None:
        self.world.replay(count)

    @rule()
    def line_is_good_for_a_while(self) -> None:
        self.world.settle()

    @invariant()
    def nothing_came_twice_or_out_of_order(self) -> None:
        self.world.check()

    def teardown(self) -> None:
        self.world.settle()


Restarts.TestCase.settings = settings(max_examples=15, stateful_step_count=20, deadline=None)
TestAnyOrder = Restarts.TestCase
