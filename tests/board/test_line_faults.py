"""Faults of the serial line, injected into the emulated board from a seed, and counted."""

import random
from collections import Counter

import pytest

from robot_runtime.simulation.boards.emulator_process import BoardError, LineDirection, LineFault
from tests.board.conftest import Make
from tests.board.rig import BoardRig

BIT = 1 / 115200
START = 0.01
"""s for a sketch to be ready."""
DIRECTIONS: list[LineDirection] = ["to_board", "from_board"]
HOST_BYTES_MAX = 4096


@pytest.fixture
def rig(make_rig: Make) -> BoardRig:
    rig = make_rig("echo")
    rig.board.run(START)
    rig.board.seed_line(1)
    return rig


def data(count: int) -> bytes:
    """Bytes that `echo` does not take for commands."""
    return bytes(random.Random(3).choices(range(5, 256), k=count))


def say(rig: BoardRig, sent: bytes) -> bytes:
    return rig.exchange(sent, 12 * len(sent) * 2 * BIT + 0.01)


def count(rig: BoardRig, direction: LineDirection, what: str) -> int:
    return int(rig.board.stats()[f"{direction}_{what}"])


def is_part(part: bytes, whole: bytes) -> bool:
    """Return True if `part` is `whole` without some bytes."""
    rest = iter(whole)
    return all(byte in rest for byte in part)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_dropped_characters_are_missing(rig: BoardRig, direction: LineDirection) -> None:
    rig.board.disturb_line(direction, "drop", 0.2)
    sent = data(300)
    heard = say(rig, sent)
    dropped = count(rig, direction, "drops")
    assert 30 < dropped < 90
    assert len(heard) == len(sent) - dropped
    assert is_part(heard, sent)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_doubled_characters_come_twice(rig: BoardRig, direction: LineDirection) -> None:
    rig.board.disturb_line(direction, "double", 0.2)
    sent = bytes(range(5, 255))  # no two neighbours are alike
    heard = say(rig, sent)
    doubled = count(rig, direction, "doubles")
    assert 25 < doubled < 75
    assert len(heard) == len(sent) + doubled
    twice = sum(count == 2 for count in Counter(heard).values())
    assert twice == doubled
    assert sorted(set(heard)) == list(sent)
    assert rig.board.stats()["overruns"] == 0


def test_inserted_characters_come_in_between(rig: BoardRig) -> None:
    rig.board.disturb_line("from_board", "insert", 0.2)
    sent = data(300)
    heard = say(rig, sent)
    inserted = count(rig, "from_board", "inserts")
    assert 30 < inserted < 90
    assert len(heard) == len(sent) + inserted
    assert is_part(sent, heard)


def test_doubling_and_inserting_together_delay_and_lose_nothing(rig: BoardRig) -> None:
    rig.board.disturb_line("from_board", "insert", 1.0)
    rig.board.disturb_line("from_board", "double", 1.0)
    sent = data(80)
    heard = rig.exchange(sent, 400 * 10 * BIT)
    assert heard[1::3] == heard[2::3] == sent
    assert rig.board.stats()["framing_errors_host"] == 0


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_wrong_bits_are_exactly_the_counted_ones(rig: BoardRig, direction: LineDirection) -> None:
    rig.board.disturb_line(direction, "bit_errors", 0.03)
    seen = wrong_stop_bits = 0
    # A few wrong bits must not make one of the sketch's commands of a byte.
    for byte in [byte for byte in data(800) if byte.bit_count() > 4][:250]:
        before = rig.board.stats()
        heard = rig.exchange(bytes([byte]), 80 * BIT)
        after = rig.board.stats()
        framing_errors = sum(
            after[f"framing_errors_{end}"] - before[f"framing_errors_{end}"] for end in ("board", "host")
        )
        wrong = after[f"{direction}_bit_errors"] > before[f"{direction}_bit_errors"]
        assert (heard != bytes([byte]) or framing_errors > 0) == wrong
        seen += wrong
        wrong_stop_bits += heard == bytes([byte]) and framing_errors > 0
    # 0.03 of 2500 bits; one in ten is a stop bit, and a start bit may take the character with it.
    assert 45 < count(rig, direction, "bit_errors") < 110
    assert seen > 40
    assert wrong_stop_bits > 0


def test_every_wrong_bit_of_a_stream_can_be_accounted_for(rig: BoardRig) -> None:
    rig.board.disturb_line("to_board", "bit_errors", 0.002)
    heard = b"".join(say(rig, b"\xff" * 200) for _ in range(10))
    missing = 2000 - len(heard)
    zeros = sum(8 - byte.bit_count() for byte in heard)
    # A wrong data bit is a zero, a wrong start bit takes its character away. A wrong stop bit leaves no edge
    # at which the next character could be seen to start. (No two come close together with this seed.)
    wrong = count(rig, "to_board", "bit_errors")
    assert wrong == zeros + missing
    assert 20 < wrong < 60
    assert 0 < rig.board.stats()["framing_errors_board"] < missing


def test_bursts_last_their_time_on_the_line(rig: BoardRig) -> None:
    rig.board.burst_line("from_board", 0.002, 30)
    sent = data(2000)
    heard = b"".join(say(rig, sent[i : i + 200]) for i in range(0, len(sent), 200))
    bursts, wrong = count(rig, "from_board", "bursts"), count(rig, "from_board", "burst_errors")
    # 20,000 bits, of which 30 follow each beginning; half of them are wrong where characters are.
    assert 15 < bursts < 60
    assert 10 < wrong / bursts < 20
    assert count(rig, "from_board", "bit_errors") == 0
    assert heard != sent


def test_a_cut_wire_carries_nothing_until_it_is_mended(rig: BoardRig) -> None:
    rig.board.cut_line("to_board", True)
    assert say(rig, data(50)) == b""
    assert rig.board.stats()["bytes_to_board"] == 0
    assert count(rig, "to_board", "cuts") == 50
    rig.board.cut_line("to_board", False)
    assert say(rig, data(50)) == data(50)
    assert count(rig, "to_board", "cuts") == 50


def test_the_other_direction_of_a_cut_line_works(rig: BoardRig) -> None:
    rig.board.cut_line("from_board", True)
    assert say(rig, data(50)) == b""
    stats = rig.board.stats()
    assert stats["bytes_to_board"] == stats["bytes_from_board"] == stats["from_board_cuts"] == 50
    assert stats["bytes_to_host"] == stats["to_board_cuts"] == 0


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_stall_delays_and_loses_nothing(rig: BoardRig, direction: LineDirection) -> None:
    sent = data(100)
    rig.board.stall_line(direction, 0.5)
    assert rig.exchange(sent, 0.499) == b""
    assert rig.exchange(b"", 0.02) == sent
    assert count(rig, direction, "stalls") == 1
    assert say(rig, sent) == sent


def test_a_stall_that_is_too_long_for_the_hosts_memory_loses_bytes(rig: BoardRig) -> None:
    rig.board.stall_line("from_board", 3600)
    sent = data(HOST_BYTES_MAX + 4)
    rig.port.write(sent[:HOST_BYTES_MAX])
    rig.board.run(0.4)
    rig.port.write(sent[HOST_BYTES_MAX:])
    rig.board.run(0.1)
    assert rig.board.stats()["bytes_lost"] == 4
    rig.board.clean_line("from_board")
    assert rig.port.read() == sent[:HOST_BYTES_MAX]


def test_the_same_seed_gives_the_same_faults(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    kinds: list[LineFault] = ["drop", "double", "insert"]
    for kind in kinds:
        rig.board.disturb_line("from_board", kind, 0.05)
    rig.board.disturb_line("from_board", "bit_errors", 0.01)
    heard = []
    for seed in (7, 7, 8):
        rig.board.seed_line(seed)
        heard.append(say(rig, data(200)))
    assert heard[0] == heard[1]
    assert heard[0] != heard[2]


def test_clean_ends_all_faults_and_keeps_the_counts(rig: BoardRig) -> None:
    rig.board.disturb_line("to_board", "bit_errors", 0.01)
    rig.board.disturb_line("to_board", "drop", 0.5)
    rig.board.burst_line("to_board", 0.01, 20)
    say(rig, data(50))
    dropped = count(rig, "to_board", "drops")
    assert dropped > 0
    rig.board.cut_line("to_board", True)
    rig.board.stall_line("to_board", 100)
    rig.board.clean_line("to_board")
    assert say(rig, data(100)) == data(100)
    assert count(rig, "to_board", "drops") == dropped


@pytest.mark.parametrize(
    "command",
    [
        "line",
        "line sideways drop 0.1",
        "line to_board drop",
        "line to_board drop 1.5",
        "line to_board bit_errors -0.1",
        "line to_board insert nan",
        "line to_board double 0.1 more",
        "line to_board burst 0.1",
        "line to_board burst 0.1 0",
        "line to_board stall soon",
        "line to_board stall 1e9",
        "line to_board cut perhaps",
        "line to_board clean up",
        "line to_board burn 0.1",
        "seed -1",
        "seed 1.5",
        "seed",
    ],
)
def test_invalid_faults_are_refused(rig: BoardRig, command: str) -> None:
    with pytest.raises(BoardError, match=r"^(line|seed) takes "):
        rig.board.command(command)
    assert say(rig, data(20)) == data(20)
