"""Two channels on a simulated line: their throughput, and that they lose nothing."""

from itertools import pairwise

import pytest

from robot_runtime.contract.packets import Heartbeat, encode
from robot_runtime.link.channel import WINDOW, Channel
from robot_runtime.link.framing import Decoder
from robot_runtime.link.round_trip import RoundTrip
from tests.runtime.link.line import KEY, PACKETS, Noise, NoisyLine, goodput, numbered


@pytest.mark.parametrize("baud", [1200, 9600, 115_200, 250_000])
@pytest.mark.parametrize(("size", "goal"), [(6, 0.70), (18, 0.80)])
def test_both_directions_together_use_the_line_well(baud: int, size: int, goal: float) -> None:
    assert goodput(baud, size) >= goal


@pytest.mark.parametrize(("bit_errors", "goal"), [(1e-4, 0.70), (1e-3, 0.40)])
def test_noise_costs_only_what_it_destroys(bit_errors: float, goal: float) -> None:
    assert goodput(115_200, 18, bit_errors) >= goal


@pytest.mark.parametrize("credit", [1, 64, 255, 4096])
@pytest.mark.parametrize(
    "noise",
    [
        Noise(bits=2e-3),
        Noise(drops=0.2),
        Noise(doubles=0.3),
        Noise(inserts=0.2),
        Noise(bursts=0.2),
        Noise(delay=0.05),
        Noise(bits=1e-3, drops=0.05, doubles=0.1, inserts=0.05, bursts=0.05, delay=0.02),
    ],
    ids=["bits", "drops", "doubles", "inserts", "bursts", "delay", "all"],
)
def test_under_any_faults_every_message_arrives_once_and_in_order(noise: Noise, credit: int) -> None:
    line = NoisyLine(115_200, noise, credit)
    given = [numbered(18, 300), numbered(6, 500)]
    for end, messages in zip(line.ends, given, strict=True):
        for message in messages:
            end.channel.queue(message)
    line.run(60.0)
    for end, messages in zip(line.ends, reversed(given), strict=True):
        assert end.heard == [(message[0], message[1:]) for message in messages]
        assert not end.channel.urgent


def test_reliable_frames_get_their_turn_on_a_full_line() -> None:
    line = NoisyLine(1200)
    sender, receiver = line.ends
    given = numbered(6, 40)
    for message in given:
        sender.channel.queue(message)
    for step in range(600):
        # More of the newest than the line carries.
        sender.channel.offer(encode(Heartbeat(time=step)), step * 0.05)
        line.run(0.05 * (step + 1))
    assert [message for message in receiver.heard if message[0] != Heartbeat.type] == [
        (message[0], message[1:]) for message in given
    ]
    assert sum(type_ == Heartbeat.type for type_, _ in receiver.heard) > 100


def test_a_quiet_good_line_repeats_nothing() -> None:
    line = NoisyLine(115_200)
    for number in range(100):
        for end in line.ends:
            end.channel.queue(numbered(6, 100)[number])
        line.run(0.05 * (number + 1))
    for end in line.ends:
        assert len(end.heard) == 100
        assert (end.channel.counters.frames_repeated, end.channel.counters.frames_duplicate) == (0, 0)


def test_on_a_dead_line_frames_are_retransmitted_and_never_given_up() -> None:
    channel = Channel(115_200, 4096, KEY)
    channel.queue(numbered(6, 1)[0])
    sent = [step * 0.003 for step in range(20_000) if channel.poll(step * 0.003)]
    waits = [later - earlier for earlier, later in pairwise(sent)]
    assert len(sent) > 500
    assert max(waits) <= 0.12


def test_no_more_than_the_window_and_the_credit_are_in_flight() -> None:
    for credit, most in ((4096, WINDOW), (255, 3), (64, 1), (1, 1)):
        channel = Channel(10**9, credit, KEY)
        for message in numbered(18, 100):
            channel.queue(message)
        frames = 0
        for step in range(1000):
            frames += bool(channel.poll(step * 1e-5))
        assert frames == most


def test_the_timeout_follows_the_round_trip_and_is_capped() -> None:
    line = NoisyLine(115_200, Noise(delay=0.01))
    for step in range(200):
        line.ends[0].channel.queue(numbered(6, 200)[step])
        line.run(0.1 * (step + 1))
    trip = line.ends[0].channel.round_trip
    assert 0.005 < trip.mean < 0.03
    assert trip.mean < line.ends[0].channel.timeout() <= 0.1


def test_a_message_that_is_replaced_never_arrives() -> None:
    line = NoisyLine(115_200)
    channel = line.ends[0].channel
    old, new, other = numbered(6, 3)
    for message in (old, other, old):
        channel.queue(message)
    lost = channel.poll(0.0)
    assert list(Decoder(PACKETS).feed(lost)) == []  # of another session: it stands for a lost one
    channel.replace(old, new)
    line.run(1.0)
    assert [payload for _, payload in line.ends[1].heard] == [new[1:], other[1:], new[1:]]


def test_the_maximum_timeout_leaves_time_for_the_other_end_s_frames() -> None:
    # 64 bytes of theirs were under way, and 64 bring the word, at 1200 baud.
    trip = RoundTrip(1200)
    assert trip.timeout(0.5) == pytest.approx(0.1 + 2 * 64 * 10 / 1200 + 0.5)
    for _ in range(20):
        trip.measure(30.0)
    assert trip.timeout(0.5) == pytest.approx(0.1 + 2 * 64 * 10 / 1200 + 0.5)


def test_frames_get_shorter_where_they_are_lost_and_longer_where_they_are_not() -> None:
    line = NoisyLine(115_200, Noise(bits=1e-3))
    for message in numbered(18, 20_000):
        line.ends[0].channel.queue(message)
    counters = line.ends[0].channel.counters
    sizes = []
    for noise in (Noise(bits=1e-3), Noise()):
        for wire in line.wires:
            wire._noise = noise
        line.run(line.now + 1.0)
        sent, frames = counters.bytes_sent, counters.frames_sent
        line.run(line.now + 2.0)
        sizes.append((counters.bytes_sent - sent) / (counters.frames_sent - frames))
    # One message of 18 bytes makes 26, and three make the longest frame.
    assert sizes[0] < 36
    assert sizes[1] > 63
