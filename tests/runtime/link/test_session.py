"""The session, in simulated time: greeting, refusal, silence, restart of the board, delivery, counting."""

from itertools import pairwise

import pytest

from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    Beacon,
    Countdown,
    Debug,
    Heartbeat,
    Hello,
    Navigation,
    Packet,
    Start,
    Stop,
    encode,
)
from robot_runtime.link.framing import UNRELIABLE_NUMBERS, Decoder, Frame, build
from robot_runtime.link.session import NO_BOOT, SILENCE, LinkSession, SessionStage, session_key

BAUD = 250_000
KEY = session_key(1, 4)


def hello(definitions: int = DEFINITIONS_HASH, epoch: int = 4) -> Hello:
    return Hello(definitions=definitions, epoch=epoch, credit=64)


def heard(data: bytes, key: int = KEY) -> list[Frame]:
    decoder = Decoder()
    decoder.key = key
    return list(decoder.feed(data))


def kinds_of(data: bytes) -> list[int]:
    return [type_ for frame in heard(data) for type_, _ in frame.messages]


def keyed(*packets: Packet, number: int = 0, acknowledged: int = 0) -> bytes:
    return build(packets, number, acknowledged, KEY)


def established(now: float = 0.0) -> LinkSession:
    session = LinkSession(1, BAUD)
    greet(session, now)
    session.receive(build([hello()], 0, 0), now)
    return session


def greet(session: LinkSession, now: float) -> None:
    """Greeting of a board that sends HELLO by itself."""
    session.receive(build([hello()], 15, 0), now)
    assert kinds_of(session.poll(now)) == [Hello.type]


def beacon(time: int = 0) -> Beacon:
    return Beacon(time=time, right=0, left=1)


def test_hello_is_sent_until_answered_and_heartbeats_after_it() -> None:
    session = LinkSession(1, BAUD)
    greetings = b"".join(session.poll(step * 0.05) for step in range(21))
    assert kinds_of(greetings) == [Hello.type] * 5
    greet(session, 1.0)
    session.receive(build([hello()], 0, 0), 1.01)
    assert session.stage is SessionStage.ESTABLISHED
    assert session.statistics().round_trip == pytest.approx(0.01)
    beats = b"".join(session.poll(1.01 + step * 0.025) for step in range(21))
    assert kinds_of(beats) == [Heartbeat.type] * 4


def test_on_a_slow_line_heartbeats_and_timeouts_follow_the_baud() -> None:
    session = LinkSession(1, 1200)
    greet(session, 0.0)
    session.receive(build([hello()], 0, 0), 0.0)
    beats: list[float] = []
    now = 0.0
    while now < 1.0:
        if data := session.poll(now):
            assert kinds_of(data) == [Heartbeat.type]
            beats.append(now)
        assert session.due() > now
        now = session.due()
    airtime = 13 * 10 / 1200
    assert [later - earlier for earlier, later in pairwise(beats)] == pytest.approx(
        [airtime] * (len(beats) - 1)
    )


@pytest.mark.parametrize(("baud", "limit"), [(250_000, SILENCE), (1200, 1.6)])
def test_the_limit_of_silence_follows_the_baud(baud: int, limit: float) -> None:
    session = LinkSession(1, baud)
    greet(session, 0.0)
    session.receive(build([hello()], 0, 0), 0.0)
    session.poll(limit)
    assert session.stage is SessionStage.ESTABLISHED
    session.poll(limit + 0.01)
    assert session.stage is SessionStage.GREETING


def test_nothing_is_accepted_before_the_greeting() -> None:
    session = LinkSession(1, BAUD)
    assert session.receive(build([beacon()], 0, 0), 0.0) == []
    greet(session, 0.1)
    assert session.receive(build([beacon()], 0, 0), 0.1) == []
    messages = session.receive(build([hello()], 1, 0) + keyed(beacon()), 0.1)
    assert [message.type for message in messages] == [Hello.type, Beacon.type]


def test_other_definitions_are_refused_until_the_board_has_the_right_ones() -> None:
    session = LinkSession(1, BAUD)
    session.receive(build([hello(definitions=0xDEAD)], 0, 0), 0.0)
    assert session.stage is SessionStage.REFUSED
    assert session.receive(build([beacon()], 1, 0), 0.1) == []
    assert session.send([Countdown(remaining=3.0)], 0.2) == b"", "its number may mean another packet there"
    assert kinds_of(session.poll(5.0)) == [Hello.type]
    session.receive(build([hello(epoch=5)], 0, 0), 5.1)
    session.poll(5.1)
    session.receive(build([hello(epoch=5)], 1, 0), 5.1)
    assert session.stage is SessionStage.ESTABLISHED


def test_a_silent_board_counts_as_lost_and_is_greeted_anew() -> None:
    session = established()
    session.poll(SILENCE)
    assert session.stage is SessionStage.ESTABLISHED
    assert kinds_of(session.poll(SILENCE + 0.01)) == [Hello.type]
    assert session.stage is SessionStage.GREETING
    session.receive(build([hello()], 1, 0), SILENCE + 0.02)
    assert session.stage is SessionStage.ESTABLISHED


def test_any_frame_of_the_session_counts_as_the_board_s_answer() -> None:
    session = LinkSession(1, BAUD)
    greet(session, 0.0)
    assert [message.type for message in session.receive(keyed(beacon()), 0.1)] == [Beacon.type]
    assert session.stage is SessionStage.ESTABLISHED


def test_a_board_that_lost_the_session_is_greeted_anew() -> None:
    session = established()
    assert session.receive(build([beacon()], 0, 0), 0.1) == []
    assert kinds_of(session.poll(0.1)) == [Hello.type]


def test_frames_of_another_session_are_dropped() -> None:
    session = established()
    for key in (session_key(2, 4), session_key(1, 5)):
        assert session.receive(build([beacon()], 0, 0, key), 0.1) == []
    assert session.statistics().frames_invalid == 2


def test_missing_telemetry_is_counted_by_its_numbers() -> None:
    session = established()
    for number in (1, 2, 5, 15, 16, 2000, 4000, 0, 0):
        session.receive(keyed(beacon(), number=number), 0.1)
    assert session.statistics().frames_missed == 2 + 9 + 1983 + 1999 + 95
    assert session.statistics().frames_duplicate == 1


def test_a_gap_of_any_size_in_a_second_is_counted() -> None:
    session = established()
    session.receive(keyed(beacon(), number=1), 0.1)
    session.receive(keyed(beacon(), number=101), 1.0)
    assert session.statistics().frames_missed == 99


def test_after_a_silence_of_any_length_telemetry_counts_again() -> None:
    session = established()
    session.receive(keyed(beacon(), number=1), 0.1)
    for at in (20.0, 50.0, 90.0, 150.0):
        assert kinds_of(session.poll(at)) == [Hello.type]
        session.receive(build([hello()], 0, 0), at)
        number = int(1 + 110 * at) % UNRELIABLE_NUMBERS
        assert len(session.receive(keyed(beacon(), number=number), at)) == 1


def test_a_restarted_board_is_greeted_anew_and_counts_from_its_own_start() -> None:
    session = established()
    session.receive(keyed(beacon(), number=7), 0.1)
    session.send([Start(epoch=4)], 0.1)
    session.receive(build([hello(epoch=5)], 0, 0), 0.2)
    assert session.stage is SessionStage.GREETING
    assert kinds_of(session.poll(0.2)) == [Hello.type]
    session.receive(build([hello(epoch=5)], 0, 0), 0.21)
    assert session.stage is SessionStage.ESTABLISHED
    assert Start.type not in kinds_of(session.poll(1.0))
    session.receive(build([beacon()], 0, 0, session_key(1, 5)), 0.3)
    assert session.statistics().frames_missed == 0
    assert session.statistics().messages_discarded == 1
    assert session.board is not None
    assert session.board.epoch == 5


def test_a_start_is_repeated_until_it_is_acknowledged() -> None:
    session = established(0.9)
    assert kinds_of(session.send([Start(epoch=4)], 1.0)) == [Start.type]
    assert session.urgent
    assert kinds_of(session.send([Start(epoch=4)], 1.05)) == []
    assert Start.type in kinds_of(session.poll(1.2) + session.poll(1.21))
    session.receive(keyed(beacon(), acknowledged=1), 1.25)
    assert not session.urgent
    assert Start.type not in kinds_of(session.poll(1.5) + session.poll(1.6))


def test_stop_is_sent_at_once_and_voids_a_pending_start() -> None:
    session = established(0.9)
    session.send([Start(epoch=4)], 1.0)
    (stop,) = heard(session.send([Stop()], 1.0))
    assert (stop.open, stop.messages) == (True, ((Stop.type, b""),))
    data = session.poll(1.3) + session.poll(1.31)
    starts = [payload for frame in heard(data) for type_, payload in frame.messages if type_ == Start.type]
    assert starts == [Start(epoch=NO_BOOT).to_bytes()]


def test_stop_is_sent_before_any_answer_of_the_board() -> None:
    assert kinds_of(LinkSession(1, BAUD).send([Stop(), Start(epoch=1)], 0.0)) == [Stop.type]


def test_on_a_slow_line_only_the_newest_command_is_sent_unless_expired() -> None:
    session = LinkSession(1, 1200)
    session.receive(build([hello()], 0, 0) + keyed(beacon()), 0.0)
    commands = [Navigation(x=0.0, y=0.0, z=z, roll=0.0, pitch=0.0, yaw=0.0) for z in (0.1, 0.2, 0.3)]
    session.send([Stop()], 0.0)
    assert session.send(commands[:2], 0.01) == b""
    taken = [message for frame in heard(session.poll(0.2)) for message in frame.messages]
    assert (Navigation.type, commands[1].to_bytes()) in taken
    assert (Navigation.type, commands[0].to_bytes()) not in taken
    session.send([Stop()] * 4, 0.3)
    session.send(commands[2:], 0.31)
    assert Navigation.type not in kinds_of(session.poll(0.9))


def test_lines_pass_in_order_and_are_acknowledged() -> None:
    session = established()
    lines = [Debug(time=0, level=1, text=text) for text in ("one", "two", "three")]
    first, second, third = (keyed(line, number=number) for number, line in enumerate(lines))
    assert [message.type for message in session.receive(first + third + third, 1.0)] == [Debug.type]
    (answer,) = heard(session.poll(1.02))
    assert answer.acknowledged == 1
    assert answer.messages[-1] == (0x0D, b"\x01")
    passed = session.receive(second + first, 1.03)
    assert [message.payload for message in passed] == [encode(line)[1:] for line in lines[1:]]
    assert {frame.acknowledged for frame in heard(session.poll(1.05))} == {3}


@pytest.mark.parametrize("minutes", [2, 40, 50, 70])
def test_an_old_line_gets_its_own_time_and_leaves_that_of_telemetry(minutes: float) -> None:
    """The board's lines wait for a host: here one of 5 s after the start, and a new one."""
    began = minutes * 60.0
    session = established(began)
    late: list[float] = []
    lines: list[float] = []
    for step in range(400):
        now = began + step * 0.01
        data = keyed(beacon(round(now * 1e6) % (1 << 32)), number=step)
        if step == 120:
            data += keyed(Debug(time=5_000_000, level=1, text="old"), number=0)
            data += keyed(Debug(time=round(now * 1e6) % (1 << 32), level=1, text="new"), number=1)
        for message in session.receive(data, now):
            (lines if message.type == Debug.type else late).append(message.time - now)
    assert late == pytest.approx([0.0] * 400, abs=1e-4)
    assert lines == pytest.approx([5.0 - began - 1.2, 0.0], abs=0.1)


def test_a_line_before_any_telemetry_has_the_time_of_its_arrival() -> None:
    session = established()
    (line,) = session.receive(keyed(Debug(time=5_000_000, level=1, text="old")), 1.0)
    (reading,) = session.receive(keyed(beacon(time=3_600_000_000), number=1), 1.1)
    assert (line.time, reading.time) == pytest.approx((1.0, 1.1))
